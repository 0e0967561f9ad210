"""Perceived events as rows of text."""

from collections.abc import Callable, Mapping
from typing import Any

from beliefnest.belief.grounds import PerceivedEvent
from beliefnest.prompts import text
from beliefnest.world.event_words import EVENT_WORDS, skill_of
from beliefnest.world.signs import sign_words
from beliefnest.world.texts import on_one_line

_FIELDS: Mapping[str, Callable[[Any], str]] = {
    "block": str,
    "position": text.position,
    "destination": text.point,
    "other": str,
    "to": str,
    "items": text.mapping,
    "name": on_one_line,
    "text": sign_words,
}
"""Formatter of each detail of an event, in output order."""

_NOBODY = "-"


def description(event: PerceivedEvent) -> str:
    """Return the perceived details, as `chest:(-2, -51, -4) & items:{'diamond': 1}`."""
    parts = []
    for name, write in _FIELDS.items():
        if event.detail.get(name) is not None:
            label = EVENT_WORDS[event.kind].place if name == "position" else name
            parts.append(f"{label}:{write(event.detail[name])}")
    return " & ".join(parts)


def row(event: PerceivedEvent) -> str:
    """Return an event as `time;action;agent_name;description`."""
    actor = _NOBODY if event.actor is None else event.actor
    return f"{event.tick};{skill_of(event)};{actor};{description(event)}"
