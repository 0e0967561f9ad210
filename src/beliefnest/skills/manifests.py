"""Descriptions of the skills, which are generated from their code."""

from functools import cache
from importlib.resources import files
from typing import Literal

import msgspec

SkillDetail = Literal["none", "names", "signatures", "full"]
"""Detail of a list of skills: `names`, `signatures` with parameters, or `full` with effects."""


class Parameter(msgspec.Struct, frozen=True):
    """A parameter of a skill.

    Attributes:
        name: Name as in the signature.
        type: Type in TypeScript's notation.
        description: Meaning of the value.
        aim: `walks` or `uses` if the value is the target of the call: a position, or an agent's
            name; empty if it is not.
        action: Parts of a structured action that give the value, or its constant value there.
    """

    name: str
    type: str
    description: str
    aim: Literal["walks", "uses", ""] = ""
    action: tuple[str, ...] | int = ()


class Skill(msgspec.Struct, frozen=True):
    """A function that programs can call.

    Attributes:
        name: Name of the function.
        signature: Name and parameters, as a model reads them.
        description: Effect of the function.
        parameters: Parameters in order.
        example: Program that calls the function.
        scripted: True if it works in the scripted world too.
        listed: False if lists for models leave it out.
    """

    name: str
    signature: str
    description: str
    parameters: tuple[Parameter, ...]
    example: str
    scripted: bool = False
    listed: bool = True

    @property
    def arguments(self) -> tuple[Parameter, ...]:
        """Parameters without the bot."""
        return tuple(each for each in self.parameters if each.type != "Bot")

    @property
    def parts(self) -> tuple[str, ...]:
        """Parts that a structured action of the skill has; empty if there is no such action."""
        actions = (each.action for each in self.parameters)
        return tuple(
            dict.fromkeys(part for parts in actions if isinstance(parts, tuple) for part in parts)
        )


@cache
def skills() -> tuple[Skill, ...]:
    """Return all skills in the order of the manifests, which are read once."""
    file = files("beliefnest") / "skills" / "manifests.json"
    return msgspec.json.decode(file.read_bytes(), type=tuple[Skill, ...])


def skills_at(detail: SkillDetail) -> tuple[Skill, ...]:
    """Return the skills for a list in a prompt; it leaves out texts beyond the detail."""
    listed = tuple(each for each in skills() if each.listed)
    match detail:
        case "none":
            return ()
        case "names":
            return tuple(
                msgspec.structs.replace(each, signature=each.name, description="")
                for each in listed
            )
        case "signatures":
            return tuple(msgspec.structs.replace(each, description="") for each in listed)
        case "full":
            return listed
