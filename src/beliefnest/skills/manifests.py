"""Descriptions of the skills, which are generated from their code."""

from functools import cache
from importlib.resources import files

import msgspec

__all__ = ["Parameter", "Skill", "skills"]


class Parameter(msgspec.Struct, frozen=True):
    """A parameter of a skill.

    Attributes:
        name: Name as in the signature.
        type: Type in TypeScript's notation.
        description: Meaning of the value.
    """

    name: str
    type: str
    description: str


class Skill(msgspec.Struct, frozen=True):
    """A function that programs can call.

    Attributes:
        name: Name of the function.
        signature: Name and parameters, as a model reads them.
        description: Effect of the function.
        parameters: Parameters in order.
        example: Program that calls the function.
    """

    name: str
    signature: str
    description: str
    parameters: tuple[Parameter, ...]
    example: str


@cache
def skills() -> tuple[Skill, ...]:
    """Return all skills in the order of the manifests, which are read once."""
    file = files("beliefnest") / "skills" / "manifests.json"
    return msgspec.json.decode(file.read_bytes(), type=tuple[Skill, ...])
