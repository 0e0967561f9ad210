"""Benchmarks of growth: ticks and memory in large boxes, and with many agents."""

import json
import tempfile
import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path

from beliefnest.nest.face.nest import Nest
from beliefnest_benchmarks.children import printed
from beliefnest_benchmarks.figures import Metric
from beliefnest_benchmarks.memory import megabytes, peak_megabytes
from beliefnest_benchmarks.walkers import Walk, Walkers

__all__ = ["followed", "kept", "measure", "walked"]

_LARGE = Walk((640, 64, 640), 3, 2)
"""Walk in a large box, which is also recorded in a file."""
_FULL, _LONG = 9000, 12_000
"""Ticks after which all caches are full, and ticks of a long walk."""


def measure() -> Sequence[Metric]:
    """Return the figures; each walk is a process of its own."""
    span = f"ticks {_FULL} to {_LONG} of 32 agents"
    small = _child(Walk((40, 64, 40), 3, 2))
    large = _child(_LARGE)
    file = json.loads(printed(__name__, f"kept({json.dumps(asdict(_LARGE))!r})"))
    deep = _child(Walk((160, 64, 160), 8, 3))
    crowd = _child(Walk((40, 20, 40), 32, 2, is_known=True))
    wide = _child(Walk((40, 20, 40), 64, 1, is_known=True))
    hall = _child(Walk((40, 20, 40), 8, 3, is_known=True))
    ticks, memory = large["tick"] / small["tick"], large["memory"] / small["memory"]
    return [
        Metric("tick of 10 nodes, 3 agents, 40 x 64 x 40", small["tick"], "ms"),
        Metric("tick of 10 nodes, 3 agents, 640 x 64 x 640", large["tick"], "ms"),
        Metric("ratio of these ticks", ticks, "", 1.5),
        Metric("peak memory, 40 x 64 x 40", small["memory"], "MB"),
        Metric("peak memory, 640 x 64 x 640", large["memory"], "MB"),
        Metric("ratio of these memories", memory, "", 3.0),
        Metric("first beliefs, 640 x 64 x 640", large["first"], "s"),
        Metric("nest begun in a run file, 640 x 64 x 640", file["begun"], "s"),
        Metric("run file of 160 ticks, 640 x 64 x 640", file["size"], "MB"),
        Metric("this file opened, and 10 states read", file["read"], "s"),
        Metric("tick of 456 nodes, 8 agents, 160 x 64 x 160", deep["tick"], "ms"),
        Metric("peak memory, 456 nodes, 160 x 64 x 160", deep["memory"], "MB", 400.0),
        Metric("tick of 1,024 nodes, 32 agents, depth 2", crowd["tick"], "ms", 25.0),
        Metric("tick of 64 nodes, 64 agents, depth 1", wide["tick"], "ms", 10.0),
        Metric("tick of 456 nodes, 8 agents, depth 3", hall["tick"], "ms"),
        Metric(f"memory grown, {span}, in memory", _grown(in_file=False), "MB", 5.0),
        Metric(f"memory grown, {span}, in a run file", _grown(in_file=True), "MB", 5.0),
    ]


def _child(walk: Walk) -> Mapping[str, float]:
    """Return the figures of a walk in a process of its own."""
    call = f"walked({json.dumps(asdict(walk))!r})"
    figures: Mapping[str, float] = json.loads(printed(__name__, call))
    return figures


def _grown(*, in_file: bool) -> float:
    """Return the MB that a long walk adds once caches are full, recorded in memory or in a file."""
    with tempfile.TemporaryDirectory() as folder:
        store = str(Path(folder) / "run.bn") if in_file else None
        return float(printed(__name__, f"followed({store!r})"))


def followed(store: str | None) -> float:
    """Let 32 agents walk, read 1,024 nodes now and then, and return the MB grown after `_FULL`."""
    walkers = Walkers(Walk((80, 20, 80), 32, 2, is_known=True), store)
    walkers.first_beliefs()
    full = 0.0
    for tick, _ in walkers.long_walk(_LONG):
        if tick == _FULL:
            full = megabytes()
    return megabytes() - full


def kept(text: str) -> str:
    """Record a walk in a run file, and return figures of the file as a JSON object.

    `begun` is the processor time of beginning the nest in s, `size` that of the file in MB, `read`
    the processor time of opening it and reading all states in s.
    """
    given = json.loads(text)
    with tempfile.TemporaryDirectory() as folder:
        store = Path(folder) / "run.bn"
        walkers = Walkers(Walk(tuple(given.pop("shape")), **given), str(store))
        walkers.first_beliefs()
        walkers.median_tick()
        walkers.nest.close()
        started = time.process_time()
        with Nest.read(store) as nest:
            for path in ("/", *walkers.paths):
                nest[path].state.blocks[0, 0, 0]
        read = time.process_time() - started
        size = store.stat().st_size / 1e6
    return json.dumps({"begun": walkers.began, "size": size, "read": read})


def walked(text: str) -> str:
    """Walk as a JSON object says, and return figures as one.

    `tick` is the median processor time of a tick in ms, all nodes read. `first` is the processor
    time of the first beliefs in s, `memory` the greatest memory in MB.
    """
    given = json.loads(text)
    walkers = Walkers(Walk(tuple(given.pop("shape")), **given))
    first, tick = walkers.first_beliefs(), walkers.median_tick()
    return json.dumps({"tick": tick, "first": first, "memory": peak_megabytes()})
