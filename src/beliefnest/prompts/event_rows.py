"""Perceived events as rows of text; actions have the names of their skills."""

from collections.abc import Callable, Mapping
from typing import Any

from beliefnest.belief.grounds import PerceivedEvent
from beliefnest.prompts import text
from beliefnest.world.signs import sign_words
from beliefnest.world.values import EventKind

__all__ = ["ACTION_NAMES", "action_name", "description", "row"]

ACTION_NAMES: Mapping[EventKind, str] = {
    EventKind.CHAT: "chat",
    EventKind.THINK: "think",
    EventKind.MOVE_TO: "goToPosition",
    EventKind.MINE_BLOCK: "mineBlock",
    EventKind.PLACE_BLOCK: "placeItem",
    EventKind.CRAFT_ITEM: "craftItem",
    EventKind.SMELT_ITEM: "smeltItem",
    EventKind.GET_ITEM_FROM_CHEST: "getItemFromChest",
    EventKind.DEPOSIT_ITEM_INTO_CHEST: "depositItemIntoChest",
    EventKind.OPEN_CONTAINER: "openContainer",
    EventKind.USE_LEVER: "useLever",
    EventKind.PRESS_BUTTON: "pressButton",
    EventKind.USE_DOOR: "useDoor",
    EventKind.GIVE_ITEM_TO_OTHER: "giveItemToOther",
    EventKind.RECEIVE_ITEM_FROM_OTHER: "receiveItemFromOther",
    EventKind.EMOTE: "emote",
    EventKind.BLOCK_UPDATE: "blockUpdate",
}
"""Name of the skill that causes each kind of event."""

_POSITION_LABELS: Mapping[EventKind, str] = {
    EventKind.GET_ITEM_FROM_CHEST: "chest",
    EventKind.DEPOSIT_ITEM_INTO_CHEST: "chest",
    EventKind.OPEN_CONTAINER: "chest",
    EventKind.USE_LEVER: "lever",
    EventKind.PRESS_BUTTON: "button",
    EventKind.USE_DOOR: "door",
    EventKind.CRAFT_ITEM: "crafting_table",
    EventKind.SMELT_ITEM: "furnace",
}

_FIELDS: Mapping[str, Callable[[Any], str]] = {
    "block": str,
    "position": text.position,
    "destination": text.point,
    "other": str,
    "to": str,
    "items": text.mapping,
    "name": text.one_line,
    "text": sign_words,
}
"""Formatter of each detail of an event, in output order."""

_NOBODY = "-"


def action_name(event: PerceivedEvent) -> str:
    """Return the published name of the skill that causes an event."""
    if event.kind is EventKind.USE_LEVER and "powered" in event.detail:
        return "turnOnLever" if event.detail["powered"] else "turnOffLever"
    if event.kind is EventKind.USE_DOOR and "open" in event.detail:
        return "openDoor" if event.detail["open"] else "closeDoor"
    if event.kind is EventKind.BLOCK_UPDATE and event.actor and "text" in event.detail:
        return "writeSign"
    return ACTION_NAMES[event.kind]


def description(event: PerceivedEvent) -> str:
    """Return the perceived details, as `chest:(-2, -51, -4) & items:{'diamond': 1}`."""
    parts = []
    for name, write in _FIELDS.items():
        if event.detail.get(name) is not None:
            label = _POSITION_LABELS.get(event.kind, name) if name == "position" else name
            parts.append(f"{label}:{write(event.detail[name])}")
    return " & ".join(parts)


def row(event: PerceivedEvent) -> str:
    """Return an event as `time;action;agent_name;description`."""
    actor = _NOBODY if event.actor is None else event.actor
    return f"{event.tick};{action_name(event)};{actor};{description(event)}"
