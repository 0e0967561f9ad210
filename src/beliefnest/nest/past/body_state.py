"""The state of a body at a moment of a timeline, its internal state included.

Frames hold what can be perceived. What else goes on in a body is kept at the ends of calls; at
any other moment, and where a belief is forked, nothing is under way.
"""

from beliefnest.timeline.journal import ForkPoint, Journal, TimelineKey

__all__ = ["internal_state_at", "note_internal_state", "present"]


def present(journal: Journal, key: TimelineKey) -> ForkPoint:
    """Return the moment a timeline is at."""
    info = journal.info(key)
    return ForkPoint(key, info.entries, info.head)


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
