"""Claims on the page: what was said, whether it was false or a lie, what became of it in nodes."""

from collections.abc import Iterator

from beliefnest.belief.forest import Forest
from beliefnest.belief.node_view import NodeView
from beliefnest.nest.explain.told import says_otherwise
from beliefnest.world.claims import Claim, claims_of
from beliefnest.world.paths import BeliefPath
from beliefnest.world.values import Position

__all__ = ["claims_at", "kind_of"]


def claims_at(forest: Forest, first: int) -> Iterator[tuple[int, int, str, Claim]]:
    """The claims of the entry that a forest is at.

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
        for index, claim in enumerate(claims_of(event)):
            yield number, index, str(event.actor), claim


def kind_of(forest: Forest, own: BeliefPath, speaker: str, claim: Claim) -> str:
    """Whether a claim that was just made is `a lie` or `false`; empty: neither.

    Args:
        forest: At the entry in which it was made.
        own: Path of the simulator in whose world it was made.
        speaker: Who made it; what it believes is in the forest.
        claim: The claim.
    """
    mind = own if own[-1:] == (speaker,) else (*own, speaker)
    if says_otherwise(_Held(forest, mind), claim):
        return "a lie"
    return "false" if says_otherwise(_Held(forest, own), claim) else ""


class _Blocks:
    def __init__(self, forest: Forest, reading: NodeView) -> None:
        self._context, self._numbers = forest.context, reading.numbers

    def __getitem__(self, position: Position) -> str | None:
        return self._context.block_text(int(self._numbers[self._context.box.index(position)]))


class _Held:
    """A node of a forest as claims are compared with it."""

    def __init__(self, forest: Forest, path: BeliefPath) -> None:
        reading = NodeView(forest, path)
        self.agents, self.containers = reading.agents, reading.containers
        self.blocks = _Blocks(forest, reading)
