"""Messages about errors in the form of a story, in the words of the format."""

import re
from collections.abc import Sequence
from typing import Any, get_args

import msgspec

from beliefnest.world.texts import quoted
from beliefnest.world.words import nearest_or_all

_FAULT = re.compile(r"(?P<what>.*?)(?: - at `\$\.?(?P<path>.*)`)?", re.DOTALL)
_EVENT = re.compile(r"events\[(\d+)\]\.?")
_UNKNOWN = re.compile(r"Object contains unknown field `(?P<name>.*)`", re.DOTALL)


def form_fault(fault: msgspec.DecodeError, story: type[Any], event: Any) -> str:
    """Return a message that says where a story has a wrong form, and what is allowed there.

    Args:
        fault: Error of the decoder.
        story: Type of a story.
        event: Union of the types of events.
    """
    match = _FAULT.fullmatch(str(fault))
    if match is None:
        return str(fault)
    what, path = match["what"], match["path"] or ""
    words = what[:1].lower() + what[1:].replace("`", "'")
    if unknown := _UNKNOWN.fullmatch(what):
        words = (
            f"unknown key {quoted(unknown['name'])}{_nearest(unknown['name'], _keys(story, path))}"
        )
    if what.startswith("Invalid value") and path.endswith(".event"):
        kinds = [str(kind.__struct_config__.tag) for kind in get_args(event)]
        words += _nearest(what.split("'")[1], kinds)
    choices = {field.name: get_args(field.type) for field in msgspec.structs.fields(story)}
    if what.startswith("Invalid enum value"):
        words += f"; allowed are {', '.join(map(str, choices.get(path, ())))}"
    where = _EVENT.sub(lambda found: f"event {int(found[1]) + 1}: ", path).removesuffix(": ")
    return f"{where}: {words}" if where else words


def _keys(story: type[Any], path: str) -> Sequence[str]:
    """Return the keys of a story if the path is the story itself, else none."""
    return [] if path else [field.name for field in msgspec.structs.fields(story)]


def _nearest(name: str, known: Sequence[str]) -> str:
    return nearest_or_all(name, known) if known else ""
