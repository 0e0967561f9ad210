"""Input of readers that extract claims from free text."""

from collections.abc import Callable, Iterable, Mapping

import msgspec

from beliefnest.world.claims import Claim
from beliefnest.world.values import Box, Position


class Nameable(msgspec.Struct, frozen=True):
    """Things that a speaker can name: those of its belief just before it speaks.

    Attributes:
        box: Region of the scenario; claims outside it are invalid.
        agents: All agents, including the speaker, in order of names.
        items: Items that the speaker believes in or has come across, in order of names; lies may
            name others as well.
        containers: Names of the containers that the speaker believes in, by position: the label,
            if the speaker knows it, else the block's name.
        doors: Block state texts of doors, trapdoors, gates, levers and buttons by position, as
            the speaker believes them to be.
        places: Positions of other named places that the speaker knows.
        called: Names that people use for items, if they differ from the item's name.
    """

    box: Box
    agents: tuple[str, ...]
    items: tuple[str, ...]
    containers: Mapping[Position, str]
    doors: Mapping[Position, str]
    places: Mapping[str, Position]
    called: Mapping[str, str] = msgspec.field(default_factory=dict)


ClaimsFrom = Callable[[str, str, Nameable], Iterable[Claim]]
"""Function that extracts claims from an utterance. Arguments: its text, its speaker, and the
things that the speaker can name."""
