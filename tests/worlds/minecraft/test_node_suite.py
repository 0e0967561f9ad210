"""The JavaScript side's own tests, run by the Node that the package uses."""

import os
import subprocess
from pathlib import Path

import pytest
from tests.profiles import NIGHTLY, at_night

from beliefnest.worlds.minecraft.node_files import node_path

NODE_ROOM = Path(__file__).parents[3] / "src" / "beliefnest" / "worlds" / "minecraft" / "node"
AT_NIGHT = ("determinism.test.js", "doors.test.js", "resuming.test.js")
"""Files that start Node often for what Python's tests of seeds, doors and resumed runs hold too."""
FILES = sorted(
    path.relative_to(NODE_ROOM)
    for path in (NODE_ROOM / "test").rglob("*.test.js")
    if NIGHTLY or path.name not in AT_NIGHT
)
TOGETHER = () if NIGHTLY else ("parts", "places", "plugins", "sandbox", "skills")
"""Folders whose files run in one process by day: most of what a file takes is Node's beginning."""

LONG = ("fuzz", "long", "people", "tcp", "process.test.js", "rest.test.js", *AT_NIGHT)
"""Folders and files whose tests wait for real time, vary at random what the others try, or start
Node often for what Python's tests of channels and rest hold as well."""


def runs() -> dict[str, list[Path]]:
    """Name of each run of Node to the files in it."""
    found: dict[str, list[Path]] = {}
    for path in FILES:
        name = path.parent.as_posix() if path.parent.name in TOGETHER else path.as_posix()
        found.setdefault(name, []).append(path)
    return found


def is_long(name: str) -> bool:
    """Return whether a run has the mark `long`."""
    return name.split("/")[1] in LONG


SECONDS = at_night(7200, 300)


def test_there_are_javascript_tests() -> None:
    assert FILES
    assert (NODE_ROOM / "node_modules").is_dir(), "install them with `pip install -e '.[dev]'`"


@pytest.mark.parametrize(
    ("name", "files"),
    [
        pytest.param(name, files, id=name, marks=pytest.mark.long if is_long(name) else ())
        for name, files in runs().items()
    ],
)
def test_javascript(name: str, files: list[Path]) -> None:
    apart = "none" if len(files) > 1 else "process"
    ended = subprocess.run(
        [
            node_path(),
            "--test",
            f"--test-isolation={apart}",
            "--test-reporter=spec",
            *(file.as_posix() for file in files),
        ],
        cwd=NODE_ROOM,
        env={**os.environ, "NO_COLOR": "1", "FORCE_COLOR": "0"},
        capture_output=True,
        text=True,
        timeout=SECONDS,
        check=False,
    )
    if ended.returncode != 0:
        pytest.fail(f"{name}:\n{ended.stdout[-8000:]}\n{ended.stderr[-4000:]}", pytrace=False)
