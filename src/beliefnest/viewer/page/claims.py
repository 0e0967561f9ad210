"""Claims on the page: their content, whether they were false or lies, and their outcome."""

from collections.abc import Iterator

from beliefnest.belief.forest import Forest
from beliefnest.belief.node_view import NodeView
from beliefnest.nest.explain.made_claims import says_otherwise
from beliefnest.world.claims import Claim, claims_of
from beliefnest.world.paths import BeliefPath, normalised


def claims_at(forest: Forest, first: int) -> Iterator[tuple[int, int, str, Claim]]:
    """Yield the claims of the forest's present entry.

    Args:
        forest: Forest at the entry.
        first: Number of the entry's first event on the timeline.

    Yields:
        Number of the event, number of the claim in it, speaker, and claim.
    """
    if not forest.position or not forest.columns.has_claims(forest.position - 1):
        return
    for number in range(first, forest.count_of_events):
        event = forest.columns.event(number)
        for index, claim in enumerate(claims_of(event) if "text" in event.detail else ()):
            yield number, index, str(event.actor), claim


def kind_of(forest: Forest, own: BeliefPath, speaker: str, claim: Claim) -> str:
    """Return `a lie` or `false` for a claim that was just made; empty if it is neither.

    Args:
        forest: Forest at the entry of the claim.
        own: Path of the simulator in whose world it was made.
        speaker: Agent that made it; the forest contains its beliefs.
        claim: The claim.
    """
    if says_otherwise(NodeView(forest, normalised((*own, speaker))), forest.context, claim):
        return "a lie"
    return "false" if says_otherwise(NodeView(forest, own), forest.context, claim) else ""
