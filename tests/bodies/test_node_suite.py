"""The JavaScript side's own tests, run by the Node that the package uses."""

import os
import subprocess
from pathlib import Path

import pytest
from tests.profiles import at_night

from beliefnest.bodies.node_files import node_path

NODE_ROOM = Path(__file__).parents[2] / "src" / "beliefnest" / "bodies" / "node"
FILES = sorted(path.relative_to(NODE_ROOM) for path in (NODE_ROOM / "test").rglob("*.test.js"))
SECONDS = at_night(7200, 300)


def test_there_are_javascript_tests() -> None:
    assert FILES
    assert (NODE_ROOM / "node_modules").is_dir(), "install them with `pip install -e '.[dev]'`"


@pytest.mark.parametrize("file", FILES, ids=[path.as_posix() for path in FILES])
def test_javascript(file: Path) -> None:
    ended = subprocess.run(
        [node_path(), "--test", "--test-reporter=spec", file.as_posix()],
        cwd=NODE_ROOM,
        env={**os.environ, "NO_COLOR": "1", "FORCE_COLOR": "0"},
        capture_output=True,
        text=True,
        timeout=SECONDS,
        check=False,
    )
    if ended.returncode != 0:
        pytest.fail(f"{file}:\n{ended.stdout[-8000:]}\n{ended.stderr[-4000:]}", pytrace=False)
