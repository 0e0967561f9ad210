"""Validation of events that other programs recorded."""

from collections.abc import Collection, Mapping
from types import MappingProxyType
from typing import Any

import msgspec

from beliefnest.errors import InputError
from beliefnest.world.claims import claims_from_plain
from beliefnest.world.values import Event, EventKind, Point, Position

__all__ = ["REQUIRED", "event_from"]

REQUIRED: Mapping[EventKind, tuple[str, ...]] = MappingProxyType(
    {
        EventKind.CHAT: ("text",),
        EventKind.THINK: ("text",),
        EventKind.MOVE_TO: ("destination",),
        EventKind.MINE_BLOCK: ("position",),
        EventKind.PLACE_BLOCK: ("position",),
        EventKind.CRAFT_ITEM: ("items",),
        EventKind.SMELT_ITEM: ("items",),
        EventKind.GET_ITEM_FROM_CHEST: ("position", "items"),
        EventKind.DEPOSIT_ITEM_INTO_CHEST: ("position", "items"),
        EventKind.OPEN_CONTAINER: ("position",),
        EventKind.USE_LEVER: ("position",),
        EventKind.PRESS_BUTTON: ("position",),
        EventKind.USE_DOOR: ("position", "open"),
        EventKind.GIVE_ITEM_TO_OTHER: ("other", "items"),
        EventKind.RECEIVE_ITEM_FROM_OTHER: ("other", "items"),
        EventKind.EMOTE: ("name",),
        EventKind.BLOCK_UPDATE: ("position",),
    }
)
"""Details that an event of each kind must have."""


class _Detail(msgspec.Struct, forbid_unknown_fields=True):
    text: str | msgspec.UnsetType = msgspec.UNSET
    position: Position | msgspec.UnsetType = msgspec.UNSET
    block: str | msgspec.UnsetType = msgspec.UNSET
    items: dict[str, int] | msgspec.UnsetType = msgspec.UNSET
    other: str | msgspec.UnsetType = msgspec.UNSET
    powered: bool | msgspec.UnsetType = msgspec.UNSET
    open: bool | msgspec.UnsetType = msgspec.UNSET
    name: str | msgspec.UnsetType = msgspec.UNSET
    destination: Point | msgspec.UnsetType = msgspec.UNSET
    to: str | msgspec.UnsetType = msgspec.UNSET
    claims: list[dict[str, Any]] | msgspec.UnsetType = msgspec.UNSET
    claims_from: str | msgspec.UnsetType = msgspec.UNSET


def event_from(
    kind: str, actor: str | None, detail: Mapping[str, Any], agents: Collection[str]
) -> Event:
    """Validate plain data and return the event.

    Args:
        kind: A value of `EventKind`.
        actor: Name of the agent that acted; only a block update may have none.
        detail: Details as in `Event.detail`, with lists as sequences.
        agents: Names of all agents.

    Raises:
        InputError: The kind or an agent is unknown, or a detail is missing, unknown or of another
            type.
    """
    if kind not in set(EventKind):
        raise InputError(f"unknown event {kind!r}; events are {', '.join(EventKind)}")
    known = EventKind(kind)
    if actor is None and known is not EventKind.BLOCK_UPDATE:
        raise InputError(f"event {kind!r} has no actor; name the agent who did it")
    try:
        typed = msgspec.convert(detail, _Detail)
    except msgspec.ValidationError as fault:
        raise InputError(f"detail of event {kind!r}: {fault}") from fault
    given = msgspec.structs.asdict(typed)
    values = {name: value for name, value in given.items() if value is not msgspec.UNSET}
    missing = [name for name in REQUIRED[known] if name not in values]
    if missing:
        raise InputError(f"event {kind!r} lacks the detail {', '.join(missing)}")
    if "to" in values and known is not EventKind.CHAT:
        raise InputError(f"event {kind!r} has the detail 'to', which only a whispered chat has")
    if "claims" in values:
        if known is not EventKind.CHAT and not (
            known is EventKind.BLOCK_UPDATE and "text" in values
        ):
            raise InputError(
                f"event {kind!r} has the detail 'claims', which only a chat and a block_update "
                "with the text of a sign have"
            )
        values["claims"] = tuple(claim.plain() for claim in claims_from_plain(values["claims"]))
    elif "claims_from" in values:
        raise InputError(f"event {kind!r} has the detail 'claims_from' without 'claims'")
    for name in (actor, values.get("other"), values.get("to")):
        if name is not None and name not in agents:
            known_agents = ", ".join(sorted(agents))
            raise InputError(
                f"event {kind!r} names an unknown agent {name!r}; agents are {known_agents}"
            )
    return Event(known, actor, values)
