"""What the skills say of themselves, as generated beside their code."""

from functools import cache
from importlib.resources import files

import msgspec

__all__ = ["Parameter", "Skill", "skills"]


class Parameter(msgspec.Struct, frozen=True):
    """A parameter of a skill.

    Attributes:
        name: As in the signature.
        type: In TypeScript's notation.
        description: What to pass.
    """

    name: str
    type: str
    description: str


class Skill(msgspec.Struct, frozen=True):
    """A function that programs can call.

    Attributes:
        name: Its name.
        signature: Name and parameters, as a model reads them.
        description: What it does.
        parameters: In order.
        example: A program that calls it.
    """

    name: str
    signature: str
    description: str
    parameters: tuple[Parameter, ...]
    example: str


@cache
def skills() -> tuple[Skill, ...]:
    """Return every skill, in the order of the manifests, which are read once."""
    file = files("beliefnest") / "programs" / "skills" / "manifests.json"
    return msgspec.json.decode(file.read_bytes(), type=tuple[Skill, ...])
