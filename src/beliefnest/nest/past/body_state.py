"""The state of a body at a moment of a timeline, its internal state included.

Frames tell what can be perceived. What else goes on in a body is kept at the ends of calls; at
any other moment, and where a belief is forked, nothing is under way.
"""

from dataclasses import replace

from beliefnest.nest.past.history import History
from beliefnest.timeline.journal import ForkPoint, Journal, TimelineKey
from beliefnest.world.frames import Snapshot
from beliefnest.world.paths import BeliefPath

__all__ = ["internal_state_at", "note_internal_state", "present", "snapshot_at"]


def present(journal: Journal, key: TimelineKey) -> ForkPoint:
    """The moment a timeline is at."""
    info = journal.info(key)
    return ForkPoint(key, info.entries, info.head)


def snapshot_at(
    journal: Journal, history: History, path: BeliefPath, moment: ForkPoint
) -> Snapshot:
    """What a body of the node `path`, the timeline's own or one below it, is filled with."""
    reading = history.reading(moment.timeline, path, moment.entries)
    own = path == moment.timeline.path
    return replace(
        reading.snapshot(),
        tick=moment.tick,
        internal_state=internal_state_at(journal, moment) if own else b"",
    )


def note_internal_state(journal: Journal, moment: ForkPoint, state: bytes) -> None:
    """Keep what goes on in the timeline's body at a moment."""
    if state:
        journal.put_body_state(moment.timeline, moment.entries, moment.tick, state)


def internal_state_at(journal: Journal, moment: ForkPoint) -> bytes:
    """What was noted to go on in the timeline's body at a moment; empty if nothing was."""
    found = journal.body_state(moment.timeline, moment.entries, moment.tick)
    if found is not None:
        return found
    base = journal.info(moment.timeline).base
    begins = base is not None and moment.entries == 0 and moment.tick == base.tick
    if base is None or not begins or base.timeline.path != moment.timeline.path:
        return b""
    return internal_state_at(journal, base)
