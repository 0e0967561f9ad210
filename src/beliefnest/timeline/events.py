"""Validation of events that other programs recorded."""

from collections.abc import Collection, Mapping
from typing import Any

import msgspec

from beliefnest.errors import InputError
from beliefnest.world.claims import claims_from_plain
from beliefnest.world.event_kinds import EventDetail, EventKind, Sense
from beliefnest.world.texts import quoted
from beliefnest.world.values import Event


def event_from(
    kind: str, actor: str | None, detail: Mapping[str, Any], agents: Collection[str]
) -> Event:
    """Validate plain data and return the event.

    Args:
        kind: A value of `EventKind`.
        actor: Name of the agent that acted; only one perceived at its place may have none.
        detail: Fields of `EventDetail`, with lists as sequences.
        agents: Names of all agents.

    Raises:
        InputError: The kind or an agent is unknown, or a detail is missing, unknown or of another
            type.
    """
    try:
        event_kind = EventKind(kind)
    except ValueError:
        raise InputError(
            f"unknown event {quoted(kind)}; events are {', '.join(EventKind)}"
        ) from None
    if actor is None and event_kind.traits.sense is not Sense.PLACE:
        raise InputError(f"event {quoted(kind)} has no actor; name the agent who did it")
    try:
        typed = msgspec.convert(detail, EventDetail)
    except msgspec.ValidationError as fault:
        raise InputError(f"detail of event {quoted(kind)}: {fault}") from fault
    fields = msgspec.structs.asdict(typed)
    values = {name: value for name, value in fields.items() if value is not msgspec.UNSET}
    missing = [name for name in event_kind.traits.needs if name not in values]
    if missing:
        raise InputError(f"event {quoted(kind)} lacks the detail {', '.join(missing)}")
    if "to" in values and event_kind is not EventKind.CHAT:
        raise InputError(
            f"event {quoted(kind)} has the detail 'to', which only a whispered chat has"
        )
    if "claims" in values:
        if event_kind is not EventKind.CHAT and not (
            event_kind is EventKind.BLOCK_UPDATE and "text" in values
        ):
            raise InputError(
                f"event {quoted(kind)} has the detail 'claims', which only a chat and a "
                "block_update with the text of a sign have"
            )
        values["claims"] = tuple(claim.plain() for claim in claims_from_plain(values["claims"]))
    elif "claims_from" in values:
        raise InputError(f"event {quoted(kind)} has the detail 'claims_from' without 'claims'")
    for name in (actor, values.get("other"), values.get("to")):
        if name is not None and name not in agents:
            known_agents = ", ".join(sorted(agents))
            raise InputError(
                f"event {quoted(kind)} names an unknown agent {quoted(name)}; agents are "
                f"{known_agents}"
            )
    return Event(event_kind, actor, values)
