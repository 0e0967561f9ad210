"""Claims: statements with a structure that an utterance may carry beside its text.

An utterance's event keeps them as plain data under `claims` in its detail, so that whatever
stores, sends or exports events does so with claims as well.
"""

import math
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Any, Literal

import msgspec

from beliefnest.errors import BeliefNestError, InputError
from beliefnest.world.frames import Frame
from beliefnest.world.registry import Registry
from beliefnest.world.values import Box, Event, EventKind, Point, Position, Sign

__all__ = [
    "Claim",
    "ClaimKind",
    "claims_from_plain",
    "claims_of",
    "claims_written",
    "with_claims",
]


class ClaimKind(StrEnum):
    """What a claim is about (semantics, section 8).

    Attributes:
        LOCATED: That a container holds an item.
        ABSENT: That a container does not hold an item.
        POSITION: Where an agent is.
        BLOCK: Which block is at a place, and in which state.
    """

    LOCATED = "located"
    ABSENT = "absent"
    POSITION = "position"
    BLOCK = "block"


@dataclass(frozen=True, slots=True)
class Claim:
    """A statement about the world; made with `located`, `absent`, `position` and `block`.

    Attributes:
        kind: What it states.
        place: The container of `located` and `absent` and the block of `block`, a block
            position; where the agent's feet are for `position`, a point.
        item: The item of `located` and `absent`, without `minecraft:`.
        agent: The agent of `position`.
        state: The block of `block`: its name, and the properties that are stated.
    """

    kind: ClaimKind
    place: Point | Position
    item: str | None = None
    agent: str | None = None
    state: str | None = None

    @staticmethod
    def located(item: str, container: Position) -> "Claim":
        """Say that the diamond is in that container.

        Args:
            item: Name of an item.
            container: Position of the container's block.

        Raises:
            InputError: It is no position.
            UnknownNameError: There is no such item.
        """
        return Claim(ClaimKind.LOCATED, _block_position(container), item=_item(item))

    @staticmethod
    def absent(item: str, container: Position) -> "Claim":
        """Say that it is not in that container; arguments and errors as for `located`."""
        return Claim(ClaimKind.ABSENT, _block_position(container), item=_item(item))

    @staticmethod
    def position(agent: str, place: Point) -> "Claim":
        """Say that the seller is there.

        Args:
            agent: Name of an agent.
            place: Middle of its feet, in blocks.

        Raises:
            InputError: It is no point, or no name.
        """
        if not isinstance(agent, str) or not agent:
            raise InputError(f"a claim about an agent names {agent!r}; give an agent's name")
        return Claim(ClaimKind.POSITION, _point(place), agent=agent)

    @staticmethod
    def block(place: Position, state: str) -> "Claim":
        """Say that the door is open.

        Args:
            place: Position of the block.
            state: A block, `name` or `name[property=value,...]`; properties that are not
                named are not spoken of.

        Raises:
            InputError: It is no position, or no block's text.
            UnknownNameError: There is no such block, property or value.
        """
        if not isinstance(state, str):
            raise InputError(f"a claim about a block says {state!r}; write name[property=value]")
        return Claim(ClaimKind.BLOCK, _block_position(place), state=_stated(state))

    @property
    def cell(self) -> Position:
        """The block position that its place lies in."""
        x, y, z = (math.floor(value) for value in self.place)
        return (x, y, z)

    def plain(self) -> dict[str, Any]:
        """As plain data: `kind`, `place`, and `item`, `agent` or `state`."""
        given = {"item": self.item, "agent": self.agent, "state": self.state}
        stated = {key: value for key, value in given.items() if value is not None}
        return {"kind": self.kind.value, **stated, "place": self.place}

    def check(self, box: Box, agents: Collection[str]) -> None:
        """See that it speaks of what there is.

        Raises:
            InputError: Its place lies outside the box, or its agent is none of `agents`.
        """
        if self.cell not in box:
            raise InputError(
                f"the claim {self} speaks of {self.place}, outside the box {box.low}..{box.high}"
            )
        if self.agent is not None and self.agent not in agents:
            raise InputError(
                f"the claim {self} names no agent of this world; there are {sorted(agents)}"
            )

    def __str__(self) -> str:
        return self.about(f"({', '.join(f'{value:g}' for value in self.place)})")

    def about(self, where: str) -> str:
        """It in words, with a name for its place."""
        match self.kind:
            case ClaimKind.LOCATED:
                return f"{self.item} is in {where}"
            case ClaimKind.ABSENT:
                return f"{self.item} is not in {where}"
            case ClaimKind.POSITION:
                return f"{self.agent} is at {where}"
            case ClaimKind.BLOCK:
                return f"{where} is {self.state}"


class _Plain(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A claim as it is written; what its values are `Claim` checks, in words of its own."""

    kind: Literal["located", "absent", "position", "block"]
    place: Any = None
    item: Any = None
    agent: Any = None
    state: Any = None

    def value(self) -> Claim:
        needed = {"position": "agent", "block": "state"}.get(self.kind, "item")
        for name in (needed, "place"):
            if getattr(self, name) is None:
                raise InputError(f"a claim of kind {self.kind!r} lacks {name!r}")
        match self.kind:
            case "located":
                return Claim.located(self.item, self.place)
            case "absent":
                return Claim.absent(self.item, self.place)
            case "position":
                return Claim.position(self.agent, self.place)
            case "block":
                return Claim.block(self.place, self.state)


def claims_from_plain(plain: object) -> tuple[Claim, ...]:
    """Return claims from plain data, a list of what `Claim.plain` gives.

    Raises:
        InputError: It is of another form; the message says which claim and where.
        UnknownNameError: There is no such item or block.
    """
    if not isinstance(plain, list | tuple):
        raise InputError(f"claims are {plain!r}; give a list of claims")
    return tuple(_claim(number, each) for number, each in enumerate(plain, 1))


def _claim(number: int, plain: object) -> Claim:
    if not isinstance(plain, Mapping):
        raise InputError(f"claim {number} is {plain!r}, which is no claim")
    try:
        return msgspec.convert(plain, _Plain).value()
    except msgspec.ValidationError as fault:
        what = str(fault).replace("`", "'").removesuffix(" - at '$.kind'")
        raise InputError(f"claim {number}: {what[:1].lower()}{what[1:]}") from fault
    except BeliefNestError as fault:
        raise type(fault)(f"claim {number}: {fault}") from fault


def claims_of(event: Event) -> tuple[Claim, ...]:
    """Return the claims that an event carries; none for most."""
    plain = event.detail.get("claims")
    return claims_from_plain(plain) if plain else ()


def claims_written(frame: Frame, place: Position) -> tuple[Claim, ...]:
    """What is claimed on a sign that was written on in a frame; nothing on any other block."""
    block = frame.blocks[place]
    if not isinstance(block, Sign):
        return ()
    for event in reversed(frame.events):
        if event.kind is EventKind.BLOCK_UPDATE and event.detail.get("position") == place:
            # A sign that is turned keeps its text.
            is_told = event.detail.get("text", block.text) == block.text
            return claims_of(event) if is_told else ()
    return ()


def with_claims(
    detail: Mapping[str, Any], claims: Iterable[Claim], box: Box, agents: Collection[str]
) -> dict[str, Any]:
    """Return an utterance's detail with claims in it; as it is where there are none.

    Raises:
        InputError: They are no list, one is no claim, or does not fit the world.
    """
    told: object = claims
    if isinstance(told, str) or not isinstance(told, Iterable):
        raise InputError(f"claims are {told!r}; give a list of claims, [] for none")
    given = tuple(told)
    for claim in given:
        if not isinstance(claim, Claim):
            raise InputError(
                f"{claim!r} is no claim; make one with Claim.located, absent, position or block"
            )
        claim.check(box, agents)
    plain = {"claims": tuple(claim.plain() for claim in given)} if given else {}
    return {**detail, **plain}


def _item(name: str) -> str:
    if not isinstance(name, str):
        raise InputError(f"a claim is about the item {name!r}; give an item's name")
    Registry.load().item_stack(name)
    return name.removeprefix("minecraft:")


def _stated(text: str) -> str:
    registry = Registry.load()
    try:
        state = registry.state_id(text)
    except BeliefNestError as fault:
        raise type(fault)(f"a claim about a block: {fault}") from None
    name, _, inner = text.strip().partition("[")
    stated = sorted(part.partition("=")[0].strip() for part in inner.rstrip("]").split(",") if part)
    properties = registry.properties(state)
    written = ",".join(f"{key}={properties[key]}" for key in stated)
    bare = name.removeprefix("minecraft:")
    return f"{bare}[{written}]" if written else bare


def _block_position(place: object) -> Position:
    point = _point(place)
    if any(value != math.floor(value) for value in point):
        raise InputError(f"a claim is about the block at {place!r}; give three whole numbers")
    x, y, z = (int(value) for value in point)
    return (x, y, z)


def _point(place: object) -> Point:
    values = tuple(place) if isinstance(place, Iterable) else ()
    if len(values) != 3 or not all(isinstance(v, int | float) and math.isfinite(v) for v in values):
        raise InputError(f"a claim is about the place {place!r}; give three finite numbers")
    x, y, z = (float(value) for value in values)
    return (x, y, z)
