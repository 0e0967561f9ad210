"""Events in words: one table for prompts, explanations, plots, pages and reports."""

from collections.abc import Iterable, Iterator, Mapping
from typing import Any, Protocol

import msgspec
from msgspec.structs import replace

from beliefnest.world.event_kinds import EventKind
from beliefnest.world.registry import Registry, block_name
from beliefnest.world.signs import sign_words
from beliefnest.world.values import Position
from beliefnest.world.words import items_words, point_words, with_the


class _Event(Protocol):
    """Event of any kind of record."""

    @property
    def kind(self) -> EventKind: ...

    @property
    def actor(self) -> str | None: ...

    @property
    def detail(self) -> Mapping[str, Any]: ...


class EventWords(msgspec.Struct, frozen=True):
    """Words for one kind of event.

    Patterns name details: text, to, destination, block, place, items, other, name; for switches
    also power (on, off), opens (opens, shuts) and opened (opened, shut).

    Attributes:
        skill: Name of the skill that causes it, as prompts write it.
        happens: Pattern of a line on the page and in reports, after the actor.
        did: Pattern of an explanation of the container or block concerned, after the actor.
        somehow: Words for an explanation that knows the kind alone.
        place: Label of its position in prompts.
        in_container: Words in a plot of a container.
        of_item: Words in a plot of an item.
        of_block: Pattern of the words in a plot of a block.
        of_agent: Words in a plot of an agent's place.
        switches: Detail that says how a switch is then, and the skills that turn it off and on.
        past: Pattern of a line of a story, after the actor; `thing` is a named block.
    """

    skill: str
    happens: str
    did: str = ""
    somehow: str = ""
    place: str = "position"
    in_container: str = ""
    of_item: str = ""
    of_block: str = ""
    of_agent: str = ""
    switches: tuple[str, str, str] = ("", "", "")
    past: str = ""


EVENT_WORDS: Mapping[EventKind, EventWords] = {
    EventKind.CHAT: EventWords("chat", ": “{text}”", past=" said: “{text}”"),
    EventKind.THINK: EventWords("think", " thinks: {text}", past=" thought: “{text}”"),
    EventKind.MOVE_TO: EventWords(
        "goToPosition", " walks to {destination}", of_agent="arrives", past=" walked {destination}"
    ),
    EventKind.MINE_BLOCK: EventWords(
        "mineBlock", " mines {block} at {place}", of_block="mines it", past=" dug away {thing}"
    ),
    EventKind.PLACE_BLOCK: EventWords(
        "placeItem",
        " places {block} at {place}",
        "made it {block}",
        of_block="places it",
        past=" put down {thing}",
    ),
    EventKind.CRAFT_ITEM: EventWords(
        "craftItem", " crafts {items}", place="crafting_table", past=" made {items}"
    ),
    EventKind.SMELT_ITEM: EventWords(
        "smeltItem", " smelts {items}", place="furnace", past=" smelted {items}"
    ),
    EventKind.GET_ITEM_FROM_CHEST: EventWords(
        "getItemFromChest",
        " takes {items} out of {place}",
        "took {items} out",
        "something was taken out",
        place="chest",
        in_container="takes out",
        of_item="takes",
        past=" took {items} out of {thing}",
    ),
    EventKind.DEPOSIT_ITEM_INTO_CHEST: EventWords(
        "depositItemIntoChest",
        " puts {items} into {place}",
        "put {items} in",
        "something was put in",
        place="chest",
        in_container="puts in",
        of_item="puts away",
        past=" put {items} into {thing}",
    ),
    EventKind.OPEN_CONTAINER: EventWords(
        "openContainer",
        " opens {place}",
        "looked in",
        "somebody looked in",
        place="chest",
        in_container="looks in",
        past=" opened {thing}",
    ),
    EventKind.USE_LEVER: EventWords(
        "useLever",
        " turns the lever at {place} {power}",
        "switched it {power}",
        place="lever",
        of_block="turns it",
        switches=("powered", "turnOffLever", "turnOnLever"),
        past=" turned {thing} {power}",
    ),
    EventKind.PRESS_BUTTON: EventWords(
        "pressButton",
        " presses the button at {place}",
        "pressed it",
        place="button",
        of_block="presses it",
        past=" pressed {thing}",
    ),
    EventKind.USE_DOOR: EventWords(
        "useDoor",
        " {opens} the door at {place}",
        "{opened} it",
        place="door",
        of_block="{opens} it",
        switches=("open", "closeDoor", "openDoor"),
        past=" {opened} {thing}",
    ),
    EventKind.GIVE_ITEM_TO_OTHER: EventWords(
        "giveItemToOther",
        " gives {items} to {other}",
        of_item="gives",
        past=" gave {items} to {other}",
    ),
    EventKind.RECEIVE_ITEM_FROM_OTHER: EventWords(
        "receiveItemFromOther",
        " gets {items} from {other}",
        of_item="gets",
        past=" got {items} from {other}",
    ),
    EventKind.EMOTE: EventWords("emote", " shows {name}", past=" made a gesture: {name}"),
    EventKind.BLOCK_UPDATE: EventWords(
        "blockUpdate", " {block} is now at {place}", "made it {block}", past=" {thing} changed"
    ),
}

_WHISPERS = EventWords("chat", " whispers to {to}: “{text}”", past=" whispered to {to}: “{text}”")
_WRITES = EventWords(
    "writeSign",
    " writes “{text}” on the sign at {place}",
    'wrote "{text}" on it',
    of_block="writes on it",
    past=" wrote on {thing}: “{text}”",
)
_WIPES = replace(_WRITES, did="wiped what was written on it", past=" wiped {thing} clean")
_SAYS = EventWords(
    "blockUpdate", " the sign at {place} says “{text}”", past=" {thing} now said: “{text}”"
)

_MISSING = {"destination": "somewhere", "block": "a block", "other": "somebody", "power": "off"}
"""Words of lines on the page for details that are missing."""


def words_of(event: _Event) -> EventWords:
    """Return the words for an event; changes of a sign's text and whispers have their own."""
    text = event.detail.get("text")
    if event.kind is EventKind.BLOCK_UPDATE and text is not None:
        words = _WRITES if text else _WIPES
        return words if event.actor else replace(_SAYS, did=words.did)
    return _WHISPERS if event.detail.get("to") else EVENT_WORDS[event.kind]


def skill_of(event: _Event) -> str:
    """Return the name of the skill that causes an event, as prompts write it."""
    words = words_of(event)
    detail, off, on = words.switches
    if detail in event.detail:
        return on if event.detail[detail] else off
    return words.skill


def happens(event: _Event, labels: Mapping[Position, str]) -> str:
    """Return an event as one line for the page and for reports.

    Args:
        event: The event.
        labels: Names of places.
    """
    words = {**_MISSING, "place": place_name(event.detail.get("position"), labels)}
    items = items_words(event.detail.get("items", {}), " and ")
    words |= {**_told(event), "items": items or "something"}
    return f"{event.actor or ''}{words_of(event).happens.format_map(words)}".strip()


def happened(event: _Event, actor: str, more: Mapping[str, str]) -> str:
    """Return an event as a sentence in the past tense, without its full stop.

    Args:
        event: The event.
        actor: Its actor in words; empty: nobody.
        more: Words for `thing`, `destination`, `items`, `to` and `other`, as far as it has them.
    """
    words = {**_MISSING, **_told(event), "thing": "something", **more}
    return f"{actor}{words_of(event).past.format_map(words)}".strip()


def did(act: _Event) -> str:
    """Return what was done to the container or block that an explanation is about."""
    pattern, words = words_of(act).did, _told(act)
    words["items"] = items_words(act.detail.get("items", {}), " and ", ids=True)
    try:
        return pattern.format_map(words) if pattern else f"did {_plain(act.kind)}"
    except KeyError:  # The witness did not perceive the detail.
        return f"did {_plain(act.kind)}"


def did_to_block(act: _Event) -> str:
    """Return what was done to the block that a plot is about; empty: nothing of note."""
    return words_of(act).of_block.format_map(_told(act))


def kind_words(kind: EventKind | None) -> str:
    """Return words for an act if only its kind is known, or not even its kind (None)."""
    return "an act" if kind is None else EVENT_WORDS[kind].somehow or _plain(kind)


def is_lid(event: _Event) -> bool:
    """Return True if an event is a barrel's moving lid, which repeats the event of its opening."""
    if event.kind is not EventKind.BLOCK_UPDATE or event.actor is not None:
        return False
    return Registry.load().is_container(block_name(str(event.detail.get("block", ""))))


def place_name(place: Any, labels: Mapping[Position, str]) -> str:
    """Return the name of a block's place."""
    if place is None:
        return "somewhere"
    label = labels.get(tuple(place))
    return point_words(place) if label is None else with_the(label)


def _told(event: _Event) -> dict[str, Any]:
    """Return the details of an event in words; those that are missing are left out."""
    detail = event.detail
    gaps = {key: detail[key] for key in ("to", "block", "other") if key in detail}
    text = detail.get("text", "")
    gaps["text"] = sign_words(text) if event.kind is EventKind.BLOCK_UPDATE else text
    gaps["name"] = detail.get("name", "")
    gaps["opens"], gaps["opened"] = ("opens", "opened") if detail.get("open") else ("shuts", "shut")
    if detail.get("destination") is not None:
        gaps["destination"] = point_words(detail["destination"])
    if "powered" in detail:
        gaps["power"] = "on" if detail["powered"] else "off"
    return gaps


def _plain(kind: EventKind) -> str:
    return kind.value.replace("_", " ")


Announcement = tuple[str, ...]
"""Name and values of an event of a bot."""


def announced(events: Iterable[_Event], me: str) -> tuple[Announcement, ...]:
    """Return the events of its bot by which an agent's program learns what the agent perceived.

    Speech has those of Mineflayer; an event of another kind has its name, its actor and its words.
    """
    return tuple(
        announcement
        for event in events
        if event.kind.traits.sense.is_announced
        for announcement in _announced(event, me)
    )


def _announced(event: _Event, me: str) -> Iterator[Announcement]:
    actor, text, to = event.actor or "", str(event.detail.get("text", "")), event.detail.get("to")
    if event.kind is not EventKind.CHAT:
        yield (event.kind.value, actor, happens(event, {}))
    elif to is None:
        yield from (("chat", actor, text), ("messagestr", f"<{actor}> {text}"))
    elif to == me:
        yield from (("whisper", actor, text), ("messagestr", f"{actor} whispers to you: {text}"))
    else:
        yield ("messagestr", f"You whisper to {to}: {text}")
