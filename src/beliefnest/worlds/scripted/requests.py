"""Requests of programs of the scripted world, and the errors that answer them."""

from collections.abc import Mapping, Sequence
from typing import Any

import msgspec

from beliefnest.skills.manifests import skills
from beliefnest.world.limits import FARTHEST
from beliefnest.worlds.protocol import Fault


class Request(msgspec.Struct, frozen=True):
    """Call of a program.

    Attributes:
        number: Its number.
        name: What it calls.
        args: Arguments as the program gave them, as plain data.
        checked: Arguments that the skill gets.
        aim: What it aims at, as the desk says.
        error: Error of its arguments, for the program.
    """

    number: int
    name: str
    args: list[Any]
    checked: list[Any]
    aim: Mapping[str, Any] | None = None
    error: Mapping[str, Any] | None = None

    @classmethod
    def admitted(cls, number: int, name: str, admission: Mapping[str, Any]) -> "Request":
        """Return a request as the desk admitted it."""
        own, checked = admission.get("own", []), admission.get("checked", [])
        return cls(number, name, own, checked, admission.get("aim"), admission.get("error"))


def is_near(wires: Sequence[Any]) -> bool:
    """Return True for a place that needs no check by the desk: programs read many blocks."""
    if not wires or not isinstance(wires[0], dict) or wires[0].get("$") != "v":
        return False
    return all(type(part) in (int, float) and abs(part) <= FARTHEST for part in wires[0]["c"])


def at_place(admission: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return the admission of a call for a block, with the block's place as its argument."""
    place = [admission["checked"][0]["position"]]
    return {**admission, "own": place, "checked": place}


def error_of(name: str, error: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return the error of a call for its program.

    Args:
        name: What was called.
        error: Message, and a reason or None; or an error of the desk, which stays as it is.
    """
    if "$" in error:
        return error
    reason = {"reason": error["reason"]} if error["reason"] else {}
    error_fields = {"$": "e", "skill": name, "kind": "skill", **reason}
    # Errors of the bot's own methods do not begin with their names.
    if all(each.name != name for each in skills()):
        return {**error_fields, "message": error["message"], "name": "Error"}
    return {**error_fields, "message": f"{name}: {error['message']}", "name": "SkillError"}


def fault_of(error: Mapping[str, Any]) -> Fault:
    """Return a described error as a fault of the program."""
    keys = ("line", "column", "skill", "reason")
    return Fault(error["message"], error["kind"], **{key: error.get(key) for key in keys})
