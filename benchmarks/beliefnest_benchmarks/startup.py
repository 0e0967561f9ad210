"""Benchmarks of start-up: commands, Python with the embedded world, and its process's memory."""

import os
import resource
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from beliefnest.errors import BodyError
from beliefnest.nest.face.nest import Nest
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
    """Return start-up times of commands, of Python with the world, and the memory of Node.

    Processor time includes that of child processes, such as Node. It depends less on what else
    runs on the machine than the time on the clock.
    """
    _run("-c", "import beliefnest")
    with tempfile.TemporaryDirectory() as folder:
        store = Path(folder) / "run.bn"
        with Nest.open(Scenario.load("sally-anne"), "scripted", store) as nest:
            nest.play()
            nest.states(["/observer/sally"])
        commands = {
            "--help": ["--help"],
            "list": ["list"],
            "new": ["new", "mine"],
            "show --json": ["show", os.fspath(store), "--path", "/observer/sally", "--json"],
            "doctor": ["doctor"],
        }
        measured = [
            Metric(f"processor time of `beliefnest {name}`", _cpu(folder, arguments), "s", limit)
            for (name, arguments), limit in zip(
                commands.items(), (0.4, 0.4, 0.4, None, None), strict=True
            )
        ]
    return [
        *measured,
        Metric("python -c 'import beliefnest'", _median("import beliefnest"), "s"),
        Metric("processor time of `import beliefnest.nest.face.nest`", _import(), "s", 0.5),
        Metric("from start to an open embedded world", _median(_START), "s", 1.0),
        Metric("memory of Node after the script", _memory(), "MB", 300.0),
    ]


def _cpu(folder: str, arguments: Sequence[str]) -> float:
    """Return the median processor time of a command and its children in seconds."""

    def once() -> float:
        Path(folder, "mine.yaml").unlink(missing_ok=True)
        before = _spent()
        _run("-m", "beliefnest", *arguments, folder=folder)
        return _spent() - before

    return statistics.median(once() for _ in range(_RUNS))


def _spent() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _import() -> float:
    def once() -> float:
        before = _spent()
        _run("-c", "import beliefnest.nest.face.nest")
        return _spent() - before

    return statistics.median(once() for _ in range(_RUNS))


def _median(code: str) -> float:
    return median_seconds(lambda: _run("-c", code), _RUNS)


def _run(*arguments: str, folder: str | None = None) -> None:
    ended = subprocess.run(
        [sys.executable, *arguments], cwd=folder, capture_output=True, text=True, check=False
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
