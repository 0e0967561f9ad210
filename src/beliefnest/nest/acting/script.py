"""How far a script has been played on a timeline."""

from collections.abc import Iterable

from beliefnest.timeline.journal import Journal, TimelineKey, lineage
from beliefnest.timeline.records import ProgramRecord

__all__ = ["STEP", "UNDONE", "steps_played"]

STEP = "step"
"""The detail of a noted program that says which step of the script it is, from 0."""


UNDONE = "undone"
"""The detail of a noted program of which nothing was kept, and why."""


def steps_played(journal: Journal, key: TimelineKey, programs: Iterable[ProgramRecord]) -> int:
    """How many steps of the script lie in the past of a timeline's head.

    A step whose program failed counts: it has happened. One of which nothing was kept does not.
    """
    noted = [p for p in programs if STEP in p.detail and UNDONE not in p.detail]
    played = 0
    for place, until in lineage(journal, key):
        here = [p for p in noted if (p.path, p.branch) == (place.path, place.branch)]
        ended = [int(p.detail[STEP]) + 1 for p in here if p.tick + p.ticks <= until]
        played = max([played, *ended])
    return played
