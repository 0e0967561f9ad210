"""Benchmarks of start-up: Python, the embedded world, and the memory of its process."""

import subprocess
import sys
from collections.abc import Sequence

from beliefnest.errors import BodyError
from beliefnest.scenarios.scenario import Scenario
from beliefnest.world.frames import Frame
from beliefnest.worlds.minecraft.embedded import EmbeddedWorld
from beliefnest_benchmarks.figures import Metric, median_seconds

__all__ = ["measure"]

_RUNS = 5
_START = """
import beliefnest
scenario = beliefnest.Scenario.load("sally-anne")
with beliefnest.Nest.open(scenario):
    pass
"""


def measure() -> Sequence[Metric]:
    """Return start-up times of Python alone and with the world, and the memory of Node."""
    _python("import beliefnest")
    return [
        Metric("python -c 'import beliefnest'", _median("import beliefnest"), "s"),
        Metric("from start to an open embedded world", _median(_START), "s", 2.0),
        Metric("memory of Node after the script", _memory(), "MB", 300.0),
    ]


def _median(code: str) -> float:
    return median_seconds(lambda: _python(code), _RUNS)


def _python(code: str) -> None:
    ended = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=False
    )
    if ended.returncode != 0:
        raise BodyError(f"python ended with {ended.returncode}: {ended.stderr}")


def _memory() -> float:
    """Return the resident memory of Node after the script has played, in MB."""
    setting = Scenario.load("sally-anne").setting
    world = EmbeddedWorld(0).start()
    try:
        body = world.open_body("/", "0", setting.snapshot, _ignore)
        for step in setting.script:
            body.run(step.programs, step.timeout_ticks)
        shown = subprocess.run(
            ["ps", "-o", "rss=", "-p", str(world.pid)], capture_output=True, text=True, check=True
        )
        return int(shown.stdout) / 1000
    finally:
        world.close()


def _ignore(frame: Frame) -> None:
    """Ignore a frame: nothing is recorded here."""
