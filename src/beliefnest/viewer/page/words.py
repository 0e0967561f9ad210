"""Events in words: one line for each event, on the page as in reports."""

from collections.abc import Mapping
from typing import Any

from beliefnest.world.registry import Registry
from beliefnest.world.signs import sign_words
from beliefnest.world.values import Event, EventKind, Position

__all__ = ["event_text", "is_lid", "place_name"]

_DEEDS = {
    EventKind.THINK: "thinks: {text}",
    EventKind.MOVE_TO: "walks to {destination}",
    EventKind.MINE_BLOCK: "mines {block} at {place}",
    EventKind.PLACE_BLOCK: "places {block} at {place}",
    EventKind.CRAFT_ITEM: "crafts {items}",
    EventKind.SMELT_ITEM: "smelts {items}",
    EventKind.GET_ITEM_FROM_CHEST: "takes {items} out of {place}",
    EventKind.DEPOSIT_ITEM_INTO_CHEST: "puts {items} into {place}",
    EventKind.OPEN_CONTAINER: "opens {place}",
    EventKind.USE_LEVER: "turns the lever at {place} {power}",
    EventKind.PRESS_BUTTON: "presses the button at {place}",
    EventKind.USE_DOOR: "{opens} the door at {place}",
    EventKind.GIVE_ITEM_TO_OTHER: "gives {items} to {other}",
    EventKind.RECEIVE_ITEM_FROM_OTHER: "gets {items} from {other}",
    EventKind.EMOTE: "shows {name}",
    EventKind.BLOCK_UPDATE: "{block} is now at {place}",
}
_WRITES = "writes “{text}” on the sign at {place}"
_SAYS = "the sign at {place} says “{text}”"


def event_text(event: Event, labels: Mapping[Position, str]) -> str:
    """Return an event as one line.

    Args:
        event: The event.
        labels: Names of places.
    """
    detail = event.detail
    actor = event.actor or ""
    if event.kind is EventKind.CHAT:
        to = f" whispers to {detail['to']}" if detail.get("to") else ""
        return f"{actor}{to}: “{detail.get('text', '')}”"
    pattern = _DEEDS.get(event.kind)
    text = detail.get("text", "")
    if event.kind is EventKind.BLOCK_UPDATE and "text" in detail:
        pattern, text = _WRITES if actor else _SAYS, sign_words(text)
    if pattern is None:
        return f"{actor} does {event.kind.value.replace('_', ' ')}".strip()
    words = pattern.format(
        text=text,
        destination=_point(detail.get("destination")),
        block=str(detail.get("block", "a block")),
        place=place_name(detail.get("position"), labels),
        items=_items(detail.get("items", {})),
        other=detail.get("other", "somebody"),
        power="on" if detail.get("powered") else "off",
        opens="opens" if detail.get("open") else "shuts",
        name=detail.get("name", ""),
    )
    return f"{actor} {words}".strip()


def is_lid(event: Event) -> bool:
    """Return True if an event is a barrel's moving lid, which repeats the event of its opening."""
    if event.kind is not EventKind.BLOCK_UPDATE or event.actor is not None:
        return False
    name = str(event.detail.get("block", "")).partition("[")[0]
    return Registry.load().is_container(name)


def place_name(place: Any, labels: Mapping[Position, str]) -> str:
    """Return the name of a block's place."""
    if place is None:
        return "somewhere"
    x, y, z = place
    label = labels.get((x, y, z))
    return f"({x}, {y}, {z})" if label is None else f"the {label}"


def _point(point: Any) -> str:
    if point is None:
        return "somewhere"
    return "(" + ", ".join(f"{float(value):.1f}".removesuffix(".0") for value in point) + ")"


def _items(items: Mapping[str, int]) -> str:
    told = [f"{count} {name.replace('_', ' ')}" for name, count in sorted(items.items())]
    return " and ".join(told) or "something"
