"""Outlines of the built-in scenarios, read without their documents."""

from collections.abc import Mapping
from importlib.resources import files

import msgspec


class Outline(msgspec.Struct, frozen=True):
    """Description of a scenario.

    Attributes:
        name: Its name.
        description: Its description.
        conditions: Descriptions of its conditions, by number.
    """

    name: str
    description: str
    conditions: Mapping[int, str]


def builtin_outlines() -> tuple[Outline, ...]:
    """Return the outlines of the built-in scenarios, sorted by name.

    `make outlines` writes them from the scenarios. Reading those took half the time of `list`.
    """
    content = (files("beliefnest.scenarios") / "outlines.json").read_bytes()
    return msgspec.json.decode(content, type=tuple[Outline, ...])
