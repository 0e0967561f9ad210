"""Claims on the page: what was said, whether it was false or a lie, what became of it in nodes."""

from collections.abc import Iterator

from beliefnest.belief.forest import Forest
from beliefnest.belief.node_view import NodeView
from beliefnest.nest.explain.made_claims import says_otherwise
from beliefnest.world.claims import Claim, claims_of
from beliefnest.world.paths import BeliefPath, normalised

__all__ = ["claims_at", "kind_of"]


def claims_at(forest: Forest, first: int) -> Iterator[tuple[int, int, str, Claim]]:
    """Yield the claims of the entry that a forest is at.

    Args:
        forest: At the entry.
        first: Number of the entry's first event on the timeline.

    Yields:
        Number of the event, and of the claim in it; who made it; the claim.
    """
    if not forest.position or not forest.columns.has_claims(forest.position - 1):
        return
    for number in range(first, forest.count_of_events):
        event = forest.columns.event(number)
        for index, claim in enumerate(claims_of(event) if "text" in event.detail else ()):
            yield number, index, str(event.actor), claim


def kind_of(forest: Forest, own: BeliefPath, speaker: str, claim: Claim) -> str:
    """Return True if a claim that was just made is `a lie` or `false`; empty: neither.

    Args:
        forest: At the entry in which it was made.
        own: Path of the simulator in whose world it was made.
        speaker: Who made it; what it believes is in the forest.
        claim: The claim.
    """
    if says_otherwise(NodeView(forest, normalised((*own, speaker))), forest.context, claim):
        return "a lie"
    return "false" if says_otherwise(NodeView(forest, own), forest.context, claim) else ""
