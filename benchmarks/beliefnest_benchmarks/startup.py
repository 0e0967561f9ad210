"""Benchmarks of start-up: commands, Python with the embedded world, and its process's memory."""

import os
import resource
import statistics
import subprocess
import tempfile
from collections.abc import Sequence
from pathlib import Path

from beliefnest.nest.face.nest import Nest
from beliefnest.scenarios.scenario import Scenario
from beliefnest.worlds.minecraft.embedded import EmbeddedWorld
from beliefnest_benchmarks.children import run_python
from beliefnest_benchmarks.figures import Metric, median_seconds

__all__ = ["measure"]

_RUNS = 5
_IMPORT = "import beliefnest.nest.face.nest"
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
    run_python("-c", "import beliefnest")
    with tempfile.TemporaryDirectory() as folder:
        store = Path(folder) / "run.bn"
        with Nest.open(Scenario.load("sally-anne"), "scripted", store) as nest:
            nest.play()
            nest.states(["/observer/sally"])
        show = ("show", os.fspath(store), "--path", "/observer/sally", "--json")
        commands: dict[str, tuple[Sequence[str], float | None]] = {
            "--help": (["--help"], 0.4),
            "list": (["list"], 0.4),
            "new": (["new", "mine"], 0.4),
            "show --json": (show, None),
            "doctor": (["doctor"], None),
        }
        measured = []
        for name, (command, limit) in commands.items():
            spent = _cpu("-m", "beliefnest", *command, folder=folder)
            measured.append(Metric(f"processor time of `beliefnest {name}`", spent, "s", limit))
        imported = _cpu("-c", _IMPORT, folder=folder)
    return [
        *measured,
        Metric("python -c 'import beliefnest'", _median("import beliefnest"), "s"),
        Metric(f"processor time of `{_IMPORT}`", imported, "s", 0.5),
        Metric("from start to an open embedded world", _median(_START), "s", 1.0),
        Metric("memory of Node after the script", _memory(), "MB", 300.0),
    ]


def _cpu(*arguments: str, folder: str) -> float:
    """Return the median processor time of Python and its children in seconds."""

    def once() -> float:
        Path(folder, "mine.yaml").unlink(missing_ok=True)
        before = _spent()
        run_python(*arguments, folder=folder)
        return _spent() - before

    return statistics.median(once() for _ in range(_RUNS))


def _spent() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _median(code: str) -> float:
    return median_seconds(lambda: run_python("-c", code), _RUNS)


def _memory() -> float:
    """Return the resident memory of Node after the script has played, in MB."""
    setting = Scenario.load("sally-anne").setting
    world = EmbeddedWorld(0).start()
    try:
        body = world.open_body("/", "0", setting.snapshot, lambda frame: None)
        for step in setting.script:
            body.run(step.programs, step.timeout_ticks)
        shown = subprocess.run(
            ["ps", "-o", "rss=", "-p", str(world.pid)], capture_output=True, text=True, check=True
        )
        return int(shown.stdout) / 1000
    finally:
        world.close()
