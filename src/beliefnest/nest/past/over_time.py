"""One simulator over time, on every timeline that it has or can follow."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from beliefnest.belief.node_view import NodeView
from beliefnest.belief.view import State
from beliefnest.nest.past.recording import Recording
from beliefnest.timeline.journal import ForkPoint, Journal, TimelineInfo, TimelineKey
from beliefnest.world.frames import BlockGrid
from beliefnest.world.paths import BeliefPath
from beliefnest.world.registry import Registry
from beliefnest.world.values import Box, Position

__all__ = ["Moment", "each_tick", "over_time"]


@dataclass(frozen=True, slots=True)
class Moment:
    """A simulator at a tick at which something changed.

    Attributes:
        timeline: The timeline it is on: its own or that of a simulator it follows.
        tick: Tick of that timeline.
        state: What it holds.
        blocks: What became of blocks since the moment before on that timeline, None where unknown;
            in the first one, all blocks that are known.
    """

    timeline: TimelineKey
    tick: int
    state: State
    blocks: Mapping[Position, str | None]


def over_time(recording: Recording, path: BeliefPath) -> Iterator[Moment]:
    """The first tick of each timeline that a simulator has or can follow, and each with a change.

    Timelines come in order of creation, each with its own ticks: what lies before its first is
    part of the timeline that it goes on from.
    """
    registry = recording.context.registry
    box = recording.box
    for info in recording.journal.timelines():
        if path[: len(info.key.path)] != info.key.path:
            continue
        before = np.full(box.shape, -1, dtype=np.int32)
        for tick, entries in _places(recording.journal, info).items():
            reading = recording.history.reading(info.key, path, entries)
            grid = reading.blocks.copy()
            state = recording.view_of(reading, ForkPoint(info.key, entries, tick))
            yield Moment(info.key, tick, state, _changed(before, grid, box, registry))
            before = grid


def each_tick(
    recording: Recording, paths: Sequence[BeliefPath], after: int, until: int
) -> Iterator[tuple[int, Mapping[BeliefPath, State]]]:
    """Yield several simulators below the real world, at each tick at which something happened.

    Args:
        recording: Where the real world is on the timeline that is looked at.
        paths: The simulators; read their states before asking for the next tick.
        after: Ticks up to this one are passed over.
        until: The last tick.
    """
    for stretch in recording.stretches(recording.moment(())):
        if stretch.tick <= after:
            continue
        key = stretch.timeline
        forest = recording.history.walk(key, paths)
        first = recording.journal.entries_until(key, after)
        if first > forest.position:
            recording.history.advance(key, forest, first)
        for position in range(forest.position + 1, stretch.entries + 1):
            recording.history.advance(key, forest, position)
            if not after < forest.tick <= until:
                continue
            readings = [NodeView(forest, path) for path in paths]
            moment = ForkPoint(key, position, forest.tick)
            views = [recording.view_of(each, moment) for each in readings]
            yield forest.tick, dict(zip(paths, views, strict=True))


def _places(journal: Journal, info: TimelineInfo) -> dict[int, int]:
    """Return the first tick and each with an entry: how many entries lie at it or before."""
    places = {info.start: 0}
    for number, entry in enumerate(journal.entries(info.key, 0, info.entries), start=1):
        places[entry.tick] = number
    return places


def _changed(
    before: BlockGrid, after: BlockGrid, box: Box, registry: Registry
) -> dict[Position, str | None]:
    x, y, z = box.low
    return {
        (x + i, y + j, z + k): None if after[i, j, k] < 0 else registry.text(int(after[i, j, k]))
        for i, j, k in np.argwhere(before != after).tolist()
    }
