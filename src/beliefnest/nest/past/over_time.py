"""States of simulators over time, on every timeline that they have or can follow."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import msgspec

from beliefnest.belief.forest import Forest
from beliefnest.belief.view import State
from beliefnest.errors import InputError
from beliefnest.nest.past.history import StateHistory
from beliefnest.nest.past.recording import Recording
from beliefnest.nest.past.timeline_state import TimelineState
from beliefnest.timeline.journal import Entry, TimelineInfo, TimelineKey
from beliefnest.timeline.store import Journal
from beliefnest.world.paths import BeliefPath, path_text
from beliefnest.world.registry import Registry
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import Box, Position


class Moment(msgspec.Struct, frozen=True):
    """State of a simulator at a tick at which something changed.

    Attributes:
        timeline: The simulator's timeline: its own or that of a simulator it follows.
        tick: Tick of that timeline.
        state: State of the simulator.
        blocks: Blocks that changed since the previous moment on that timeline, with their new
            state, None where unknown. In the first moment all known blocks.
    """

    timeline: TimelineKey
    tick: int
    state: State
    blocks: Mapping[Position, str | None]


_MOST_BLOCKS = 2_000_000
"""Most known blocks at the first tick of a timeline."""


def over_time(recording: Recording, path: BeliefPath) -> Iterator[Moment]:
    """Yield the moments of a simulator: first ticks of timelines, and all ticks with an entry.

    Timelines come in order of creation, each with its own ticks only. Earlier ticks belong to the
    timeline that it was forked from.
    """
    registry = recording.context.registry
    box = recording.box
    for info in recording.journal.timelines():
        if path[: len(info.key.path)] != info.key.path:
            continue
        before = Terrain.full(box.shape, -1)
        for tick, entries in _places(recording.journal, info).items():
            state = recording.history.state(info.key, path, entries, tick)
            if not before.count([number for number in before.states if number >= 0]):
                _check_first(state)
            yield Moment(info.key, tick, state, _changed(before, state.terrain, box, registry))
            before = state.terrain


def _check_first(state: State) -> None:
    """Raise InputError if a state knows too many blocks to list them."""
    terrain = state.blocks.terrain
    count = terrain.count([number for number in terrain.states if number >= 0])
    if count > _MOST_BLOCKS:
        raise InputError(
            f"{path_text(state.path)} knows {count:,} blocks at tick {state.tick}; states over "
            f"time list at most {_MOST_BLOCKS:,}: leave the path out, or read single blocks of "
            "nest.at(tick)[path].state"
        )


StatesAfter = Callable[[], Mapping[BeliefPath, State]]
"""Function that returns states after an entry."""


@dataclass(slots=True)
class TickWalk:
    """Place in a timeline up to which somebody has read the states of the same simulators.

    Attributes:
        key: The timeline; None: nothing was read.
        generation: Counter of `StateHistory` that tells if the forest is still valid.
        forest: Forest of the simulators there.
    """

    key: TimelineKey | None = None
    generation: int = 0
    forest: Forest | None = None

    def begun(self, history: StateHistory, key: TimelineKey, paths: Sequence[BeliefPath]) -> Forest:
        """Return the forest of a timeline: the one read last, else one at its beginning."""
        if self.forest is None or (self.key, self.generation) != (key, history.generation):
            self.forest = history.walk(key, paths)
            # The walk may have found new claims, which make older forests invalid.
            self.key, self.generation = key, history.generation
        return self.forest


def each_entry(
    recording: Recording,
    paths: Sequence[BeliefPath],
    after: int,
    until: int,
    walk: TickWalk | None = None,
) -> Iterator[tuple[Entry, StatesAfter]]:
    """Yield each entry below the real world with a function that returns several states after it.

    Entries whose states nobody asks for are folded together with later ones.

    Args:
        recording: Recording with the real world on the wanted timeline.
        paths: The simulators. Read their states before asking for the next entry.
        after: Last tick to leave out.
        until: Last tick to yield.
        walk: Place up to which the caller has read these simulators already; None: from the
            beginning.
    """
    walk, journal = walk or TickWalk(), recording.journal
    for stretch in recording.stretches(recording.moment(())):
        if stretch.tick <= after:
            continue
        key = stretch.timeline
        first = journal.entries_until(key, after)
        for position, entry in enumerate(journal.entries(key, first, stretch.entries), first + 1):
            if entry.tick > until:
                break
            yield entry, partial(_states_after, recording.history, key, position, paths, walk)


def _states_after(
    history: StateHistory,
    key: TimelineKey,
    position: int,
    paths: Sequence[BeliefPath],
    walk: TickWalk,
) -> Mapping[BeliefPath, State]:
    forest = walk.begun(history, key, paths)
    history.advance(key, forest, position)
    return {path: TimelineState(forest, path, None, key, history) for path in paths}


def _places(journal: Journal, info: TimelineInfo) -> dict[int, int]:
    """Return the number of entries up to a tick, for the first tick and each with an entry."""
    places = {info.start: 0}
    for number, entry in enumerate(journal.entries(info.key, 0, info.entries), start=1):
        places[entry.tick] = number
    return places


def _changed(
    before: Terrain, after: Terrain, box: Box, registry: Registry
) -> dict[Position, str | None]:
    x, y, z = box.low
    changes = ((index, after[index]) for index in map(tuple, after.differing(before).tolist()))
    return {
        (x + i, y + j, z + k): None if state < 0 else registry.text(state)
        for (i, j, k), state in changes
    }
