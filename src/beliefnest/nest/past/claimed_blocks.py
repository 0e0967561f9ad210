"""Cells of blocks that claims are about, which have to be tracked from the beginning.

A hearer takes a claim up depending on when it last saw the place (semantics, section 8). Nodes
remember this for tracked cells only. Containers, doors and switches are tracked from the start. Any
other block is tracked from the first claim about it on, and timelines are then folded again from
the beginning, so that the result does not depend on when the claim was met.
"""

from beliefnest.belief.columns import cell_of
from beliefnest.belief.context import BeliefContext
from beliefnest.timeline.journal import EntryFilter, TimelineKey
from beliefnest.timeline.store import Journal
from beliefnest.world.claims import ClaimKind, claims_from_plain, claims_of
from beliefnest.world.doors import is_door, is_switch
from beliefnest.world.frames import Frame, Snapshot
from beliefnest.world.signs import is_sign


class ClaimedBlocks:
    """Cells that have to be tracked from the beginning of every timeline.

    Attributes:
        cells: The cells found so far. The context tracks them.
    """

    def __init__(self, journal: Journal, context: BeliefContext, snapshot: Snapshot) -> None:
        self._journal = journal
        self._context = context
        self._weighs = context.options.testimony == "informed"
        self._read: dict[TimelineKey, int] = {}
        cells = [*_switches(context, snapshot), *_claimed_at_first(context, snapshot)]
        self.cells = frozenset(cells if self._weighs else ())
        context.track(sorted(self.cells))

    def read(self, key: TimelineKey) -> bool:
        """Read the entries added to a timeline, and return True if they claim new cells."""
        if not self._weighs:
            return False
        count, first = self._journal.info(key).entries, self._read.get(key, 0)
        if count == first:
            return False
        self._read[key] = count
        cells = {
            cell_of(self._context.box, claim.cell)
            for _, entry in self._journal.filtered(key, first, count, EntryFilter.EVENTS)
            if isinstance(entry, Frame)
            for event in entry.events
            for claim in claims_of(event)
            if claim.kind is ClaimKind.BLOCK
        }
        new = cells - self.cells
        self.cells |= new
        self._context.track(sorted(new))
        return bool(new)

    def forget(self, key: TimelineKey) -> None:
        """Read a timeline again from its start, after it was deleted or renamed."""
        self._read.pop(key, None)

    def forget_all(self) -> None:
        """Read all timelines again from their starts."""
        self._read.clear()


def _claimed_at_first(context: BeliefContext, snapshot: Snapshot) -> list[int]:
    """Return cells of blocks that claims on signs are about at the start."""
    written = snapshot.sign_claims.values()
    claims = [claim for plain in written for claim in claims_from_plain(plain)]
    return [cell_of(context.box, c.cell) for c in claims if c.kind is ClaimKind.BLOCK]


def _switches(context: BeliefContext, snapshot: Snapshot) -> list[int]:
    """Return cells of doors, gates, levers, buttons, signs and containers at the start."""
    states = snapshot.blocks.states
    registry = context.registry
    names = {state: registry.name(state) for state in states if state >= 0}
    wanted = [
        state
        for state, name in names.items()
        if is_door(name) or is_switch(name) or is_sign(name) or registry.is_container(name)
    ]
    return [cell_of(context.box, place) for place in snapshot.places(wanted)]
