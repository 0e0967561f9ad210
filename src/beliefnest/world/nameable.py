"""What claims that are read out of free text can speak of, and who reads them."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field

from beliefnest.world.claims import Claim
from beliefnest.world.values import Box, Position

__all__ = ["ClaimsFrom", "Nameable"]


@dataclass(frozen=True, slots=True)
class Nameable:
    """What a speaker may name.

    Attributes:
        box: The part of space there is; no claim speaks of a place outside it.
        agents: All agents, the speaker among them, in order of names.
        items: Items there are, in order of names; lies may be about others as well.
        containers: Their positions, and what people call them, else the block's name.
        doors: Doors, trapdoors, gates, levers and buttons: their positions and block texts.
        places: What people call other places.
        called: What people call items, where that is another name than the item's.
    """

    box: Box
    agents: tuple[str, ...]
    items: tuple[str, ...]
    containers: Mapping[Position, str]
    doors: Mapping[Position, str]
    places: Mapping[str, Position]
    called: Mapping[str, str] = field(default_factory=dict)


ClaimsFrom = Callable[[str, str, Nameable], Iterable[Claim]]
"""Given the text of an utterance, its speaker and what can be named: what the text claims."""
