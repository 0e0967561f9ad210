"""Internal state of bodies at moments of a timeline.

Frames hold everything that agents can perceive. The rest, for example how far a furnace has got, is
stored when a call ends. At any other moment, and where a belief is forked, a body begins without
internal state.
"""

from beliefnest.timeline.journal import ForkPoint, TimelineKey
from beliefnest.timeline.store import Journal


def present(journal: Journal, key: TimelineKey) -> ForkPoint:
    """Return the moment at the head of a timeline."""
    info = journal.info(key)
    return ForkPoint(key, info.entries, info.head)


def note_internal_state(journal: Journal, moment: ForkPoint, state: bytes) -> None:
    """Store the internal state of the timeline's body at a moment."""
    if state:
        journal.put_body_state(moment.timeline, moment.entries, moment.tick, state)


def internal_state_at(journal: Journal, moment: ForkPoint) -> bytes:
    """Return the internal state stored for a moment; empty bytes if there is none."""
    while True:
        recorded = journal.body_state(moment.timeline, moment.entries, moment.tick)
        if recorded is not None:
            return recorded
        base = journal.info(moment.timeline).base
        begins = base is not None and moment.entries == 0 and moment.tick == base.tick
        if base is None or not begins or base.timeline.path != moment.timeline.path:
            return b""
        moment = base
