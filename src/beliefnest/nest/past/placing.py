"""Where bodies of impossible beliefs began, as it was recorded.

A fork of a belief whose body had to move somebody begins with a frame of the fork's own tick: the
moved agents where they stand in the body (semantics, section 7). Any other frame lies later.
"""

from collections.abc import Mapping

from beliefnest.nest.past.recording import Recording
from beliefnest.timeline.journal import ForkPoint, Journal, TimelineInfo, TimelineKey
from beliefnest.world.frames import Frame
from beliefnest.world.paths import BeliefPath
from beliefnest.world.values import Point

__all__ = ["fork_of_belief", "placed_in", "placing_frame"]


def fork_of_belief(journal: Journal, key: TimelineKey) -> tuple[TimelineInfo, ForkPoint] | None:
    """The branch on which a simulator left its parent's belief, and where; None: the real world."""
    info = journal.info(key)
    while info.base is not None and info.base.timeline.path == key.path:
        info = journal.info(info.base.timeline)
    return None if info.base is None else (info, info.base)


def placing_frame(journal: Journal, info: TimelineInfo) -> Frame | None:
    """The frame that says who was moved when a timeline began; None if nobody was."""
    if info.base is None or info.entries == 0:
        return None
    first = next(iter(journal.entries(info.key, 0, 1)))
    return first if isinstance(first, Frame) and first.tick == info.start else None


def placed_in(
    recording: Recording, path: BeliefPath, tick: int | None = None
) -> Mapping[str, tuple[Point, Point]]:
    """Whom the body of a simulator had to move when it began: agent to from where, to where.

    Empty in follow mode, in the real world, and at ticks before the fork.
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
    info, base = fork
    frame = placing_frame(journal, info)
    if frame is None:
        return {}
    believed = recording.history.reading(base.timeline, path, base.entries).agents
    moves: dict[str, tuple[Point, Point]] = {}
    for name, agent in sorted(frame.agents.items()):
        start = believed[name].position
        assert agent is not None and start is not None
        moves[name] = (start, agent.position)
    return moves
