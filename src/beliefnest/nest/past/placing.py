"""Differences between an impossible belief and its body (semantics, section 7).

If the body had to move agents, the fork of the belief begins with a frame that has the tick of the
fork: it holds the moved agents where they stand in the body. All other frames have later ticks.
Chests that the body puts are not recorded, because they follow from the state.
"""

from beliefnest.nest.past.embodiable import CHEST, chest_places
from beliefnest.nest.past.recording import Recording
from beliefnest.timeline.journal import ForkPoint, TimelineInfo, TimelineKey
from beliefnest.timeline.store import Journal
from beliefnest.world.frames import Frame
from beliefnest.world.paths import BeliefPath
from beliefnest.world.values import Placements, Point, Position


def fork_of_belief(journal: Journal, key: TimelineKey) -> tuple[TimelineInfo, ForkPoint] | None:
    """Return the branch on which a simulator left its parent's belief, and the fork point.

    None: the simulator is the real world.
    """
    info = journal.info(key)
    while info.base is not None and info.base.timeline.path == key.path:
        info = journal.info(info.base.timeline)
    return None if info.base is None else (info, info.base)


def placing_frame(journal: Journal, info: TimelineInfo) -> Frame | None:
    """Return the frame of agents that were moved when a timeline began; None if there is none."""
    if info.base is None or info.entries == 0:
        return None
    first = next(iter(journal.entries(info.key, 0, 1)))
    return first if isinstance(first, Frame) and first.tick == info.start else None


def placed_in(recording: Recording, path: BeliefPath, tick: int | None = None) -> Placements:
    """Return the differences between a simulator's belief and its body.

    Returns:
        By agent name, the believed position and the one at which the body began. By position of a
        chest that the body put, the believed block (None: unknown) and "chest". Empty in follow
        mode, in the real world, and at ticks before the fork.
    """
    if not path:
        return {}
    journal = recording.journal
    key = recording.controller(path)
    if tick is not None:
        key, _ = recording.place_of(key, tick)
    fork = fork_of_belief(journal, key) if key.path == path else None
    if fork is None:
        return {}
    return {**_moves(recording, path, *fork), **_chests(recording, path, tick)}


def _moves(
    recording: Recording, path: BeliefPath, info: TimelineInfo, base: ForkPoint
) -> Placements:
    frame = placing_frame(recording.journal, info)
    if frame is None:
        return {}
    believed = recording.history.state(base.timeline, path, base.entries).agents
    moves: dict[str | Position, tuple[Point, Point]] = {}
    for name, agent in sorted(frame.agents.items()):
        start = believed[name].position
        assert agent is not None and start is not None
        moves[name] = (start, agent.position)
    return moves


def _chests(recording: Recording, path: BeliefPath, tick: int | None) -> Placements:
    reading, box = recording.state(path, tick), recording.box
    registry = recording.context.registry
    contents = {place: content.items for place, content in reading.containers.items()}
    chests: dict[str | Position, tuple[str | None, str]] = {}
    for place in chest_places(registry, box, reading.terrain, contents):
        state = reading.terrain[box.index(place)]
        chests[place] = (None if state < 0 else registry.text(state), CHEST)
    return chests
