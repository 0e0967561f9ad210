"""Table of the kinds of events: details, perception, effects and skill of each kind.

All that depends on the kind of an event alone is declared here and nowhere else.
"""

from enum import IntEnum, StrEnum
from typing import Any, Self

import msgspec


class Sense(IntEnum):
    """Senses by which agents perceive the events of others; an actor perceives its own.

    The belief kernel uses the numbers.
    """

    HEARING = 0
    """Hearing of the actor, as the options of perception say."""
    NONE = 1
    """No sense: nobody but the actor perceives the event."""
    PLACE = 2
    """Sight of the event's position; such an event may have no known actor."""
    ACTOR = 3
    """Sight of the actor."""

    @property
    def is_announced(self) -> bool:
        """True if programs are told of its events; they see others, in the state of the world."""
        return self not in (Sense.NONE, Sense.PLACE, Sense.ACTOR)


class EventDetail(msgspec.Struct, forbid_unknown_fields=True):
    """Details of events: the part that witnesses perceive.

    Attributes:
        text: Words of speech or thought; new text of a sign.
        position: Position of a block. For a door it is the lower half.
        block: Block state text.
        items: Item name to count.
        other: An agent.
        powered: New state of a lever.
        open: New state of a door, trapdoor or gate.
        name: Name of a gesture.
        destination: Point that an agent walked to.
        to: Addressee of whispered speech; absent if it is said aloud.
        claims: Claims that go with speech or a sign, as plain data (`world.claims`).
        claims_from: Reader that extracted the claims from the text; absent if the speaker gave
            them.
    """

    text: str | msgspec.UnsetType = msgspec.UNSET
    position: tuple[int, int, int] | msgspec.UnsetType = msgspec.UNSET
    block: str | msgspec.UnsetType = msgspec.UNSET
    items: dict[str, int] | msgspec.UnsetType = msgspec.UNSET
    other: str | msgspec.UnsetType = msgspec.UNSET
    powered: bool | msgspec.UnsetType = msgspec.UNSET
    open: bool | msgspec.UnsetType = msgspec.UNSET
    name: str | msgspec.UnsetType = msgspec.UNSET
    destination: tuple[float, float, float] | msgspec.UnsetType = msgspec.UNSET
    to: str | msgspec.UnsetType = msgspec.UNSET
    claims: list[dict[str, Any]] | msgspec.UnsetType = msgspec.UNSET
    claims_from: str | msgspec.UnsetType = msgspec.UNSET


class Traits(msgspec.Struct, frozen=True):
    """Facts about a kind of events.

    Attributes:
        needs: Details that an event of this kind must have, fields of `EventDetail`.
        sense: Sense by which others perceive it.
        stores: 1 if it moves items into a container, -1 out of it, 0 if it shows the actor what a
            container holds; None if it does not happen at a container.
        gains: 1 if the actor gets its items, -1 if the actor gives them away, else 0.
        is_deed: False for walks and changes of blocks, which only accompany deeds.
    """

    needs: tuple[str, ...] = ()
    sense: Sense = Sense.ACTOR
    stores: int | None = None
    gains: int = 0
    is_deed: bool = True


_PLAIN = Traits()


class EventKind(StrEnum):
    """Kinds of events (semantics, section 1), each with its traits."""

    _value_: str
    traits: Traits

    def __new__(cls, name: str, traits: Traits = _PLAIN) -> Self:
        """Return a member with its traits."""
        kind = str.__new__(cls, name)
        kind._value_, kind.traits = name, traits
        return kind

    CHAT = "chat", Traits(("text",), Sense.HEARING)
    THINK = "think", Traits(("text",), Sense.NONE)
    MOVE_TO = "move_to", Traits(("destination",), is_deed=False)
    MINE_BLOCK = "mine_block", Traits(("position",))
    PLACE_BLOCK = "place_block", Traits(("position",))
    CRAFT_ITEM = "craft_item", Traits(("items",), gains=1)
    # The result of smelting is counted when the agent takes it out of the furnace.
    SMELT_ITEM = "smelt_item", Traits(("items",))
    GET_ITEM_FROM_CHEST = "get_item_from_chest", Traits(("position", "items"), stores=-1, gains=1)
    DEPOSIT_ITEM_INTO_CHEST = (
        "deposit_item_into_chest",
        Traits(("position", "items"), stores=1, gains=-1),
    )
    OPEN_CONTAINER = "open_container", Traits(("position",), stores=0)
    USE_LEVER = "use_lever", Traits(("position",))
    PRESS_BUTTON = "press_button", Traits(("position",))
    USE_DOOR = "use_door", Traits(("position", "open"))
    GIVE_ITEM_TO_OTHER = "give_item_to_other", Traits(("other", "items"), gains=-1)
    RECEIVE_ITEM_FROM_OTHER = "receive_item_from_other", Traits(("other", "items"), gains=1)
    EMOTE = "emote", Traits(("name",))
    BLOCK_UPDATE = "block_update", Traits(("position",), Sense.PLACE, is_deed=False)

    @property
    def is_act(self) -> bool:
        """True for acts, which an agent does with its body."""
        return not self.is_speech and self.traits.sense is not Sense.PLACE

    @property
    def is_speech(self) -> bool:
        """True for speech and thought."""
        return self.traits.sense in (Sense.HEARING, Sense.NONE)

    @property
    def is_public_deed(self) -> bool:
        """True for deeds that others can perceive."""
        return self.traits.is_deed and self.traits.sense is not Sense.NONE


AT_CONTAINERS = frozenset(kind for kind in EventKind if kind.traits.stores is not None)
"""Kinds of acts that happen at a container and show the actor what it holds."""
