"""Claims: structured statements that an utterance may carry beside its text.

The event of an utterance holds them as plain data under `claims` in its detail. They are
therefore stored, sent and exported together with the event.
"""

import math
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Any

import msgspec

from beliefnest.errors import BeliefNestError, InputError
from beliefnest.world.event_kinds import EventKind
from beliefnest.world.frames import Frame
from beliefnest.world.registry import Registry, parse_state
from beliefnest.world.texts import quoted
from beliefnest.world.values import Box, Event, Point, Position, Sign, block_at


class ClaimKind(StrEnum):
    """Kinds of claims (semantics, section 8).

    Attributes:
        LOCATED: A container holds an item.
        ABSENT: A container does not hold an item.
        POSITION: An agent is at a place.
        BLOCK: A block of a given state is at a place.
    """

    LOCATED = "located"
    ABSENT = "absent"
    POSITION = "position"
    BLOCK = "block"


@dataclass(frozen=True, slots=True)
class Claim:
    """A statement about the world, created with `located`, `absent`, `position` or `block`.

    Attributes:
        kind: Kind of statement.
        place: Block position of the container (`located`, `absent`) or of the block (`block`);
            position of the agent's feet, a point (`position`).
        item: Item of `located` and `absent`, without `minecraft:`.
        agent: Agent of `position`.
        state: Block of `block`: its name and the stated properties.
    """

    kind: ClaimKind
    place: Point | Position
    item: str | None = None
    agent: str | None = None
    state: str | None = None

    def of_whole(self, whole: Callable[[Position], Position]) -> "Claim":
        """Return the claim about the container to which the block at its place belongs.

        A claim is recorded as it was made. Whether its place is half of a double chest depends on
        who hears it. Claims that are about no container stay as they are.
        """
        if self.kind not in (ClaimKind.LOCATED, ClaimKind.ABSENT):
            return self
        return replace(self, place=whole(self.cell))

    @staticmethod
    def located(item: str, container: Position) -> "Claim":
        """Claim that an item is in a container.

        Args:
            item: Name of an item.
            container: Position of the container's block.

        Raises:
            InputError: The position is invalid.
            UnknownNameError: There is no such item.
        """
        return Claim(ClaimKind.LOCATED, _block_position(container), item=_item(item))

    @staticmethod
    def absent(item: str, container: Position) -> "Claim":
        """Claim that an item is not in a container; arguments and errors as for `located`."""
        return Claim(ClaimKind.ABSENT, _block_position(container), item=_item(item))

    @staticmethod
    def position(agent: str, place: Point) -> "Claim":
        """Claim that an agent is at a place.

        Args:
            agent: Name of an agent.
            place: Middle of its feet, in blocks.

        Raises:
            InputError: The place is not a point, or the name is empty.
        """
        if not isinstance(agent, str) or not agent:
            raise InputError(f"a claim about an agent names {quoted(agent)}; give an agent's name")
        return Claim(ClaimKind.POSITION, _point(place), agent=agent)

    @staticmethod
    def block(place: Position, state: str) -> "Claim":
        """Claim that a block has a state, such as an open door.

        Args:
            place: Position of the block.
            state: A block, `name` or `name[property=value,...]`; the claim says nothing about
                the other properties.

        Raises:
            InputError: The position or the text of the block is invalid.
            UnknownNameError: There is no such block, property or value.
        """
        if not isinstance(state, str):
            raise InputError(
                f"a claim about a block says {quoted(state)}; write name[property=value]"
            )
        return Claim(ClaimKind.BLOCK, _block_position(place), state=_stated(state))

    @property
    def cell(self) -> Position:
        """Position of the block that contains the claim's place."""
        return block_at(self.place)

    def plain(self) -> dict[str, Any]:
        """Return plain data: `kind`, `place`, and `item`, `agent` or `state`."""
        parts = {"item": self.item, "agent": self.agent, "state": self.state}
        stated = {key: value for key, value in parts.items() if value is not None}
        return {"kind": self.kind.value, **stated, "place": self.place}

    def check(self, box: Box, agents: Collection[str]) -> None:
        """Check that the claim is about this world.

        Raises:
            InputError: The place is outside the box, or the agent is not in `agents`.
        """
        if self.cell not in box:
            raise InputError(
                f"the claim '{self}' is about {self.place}, outside the box {box.low}..{box.high}"
            )
        if self.agent is not None and self.agent not in agents:
            raise InputError(
                f"the claim '{self}' names an unknown agent; agents are {sorted(agents)}"
            )

    def __str__(self) -> str:
        return self.about(f"({', '.join(f'{value:g}' for value in self.place)})")

    def about(self, where: str) -> str:
        """Return the claim in words, with the given name for its place."""
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
    """A claim as plain data; `Claim` checks the values, for clearer messages."""

    kind: Any = None
    place: Any = None
    item: Any = None
    agent: Any = None
    state: Any = None

    def value(self) -> Claim:
        if self.kind not in [*ClaimKind]:
            raise InputError(f"{quoted(self.kind)} is no kind; kinds are {', '.join(ClaimKind)}")
        needed = {"position": "agent", "block": "state"}.get(self.kind, "item")
        for name in (needed, "place"):
            if getattr(self, name) is None:
                raise InputError(f"a claim of kind {quoted(self.kind)} lacks {quoted(name)}")
        match self.kind:
            case "located":
                return Claim.located(self.item, self.place)
            case "absent":
                return Claim.absent(self.item, self.place)
            case "position":
                return Claim.position(self.agent, self.place)
            case _:
                return Claim.block(self.place, self.state)


def claims_from_plain(plain: object) -> tuple[Claim, ...]:
    """Convert a list of plain data, as of `Claim.plain`, to claims.

    Raises:
        InputError: The data have another form; the message names the claim and the fault.
        UnknownNameError: There is no such item or block.
    """
    if not isinstance(plain, list | tuple):
        raise InputError(f"claims are {quoted(plain)}; give a list of claims")
    return tuple(_claim(number, each) for number, each in enumerate(plain, 1))


def _claim(number: int, plain: object) -> Claim:
    if not isinstance(plain, Mapping):
        raise InputError(f"claim {number} is {quoted(plain)}, which is no claim")
    try:
        return msgspec.convert(plain, _Plain).value()
    except msgspec.ValidationError as fault:
        what = str(fault).replace("`", "'")
        raise InputError(f"claim {number}: {what[:1].lower()}{what[1:]}") from fault
    except BeliefNestError as fault:
        raise type(fault)(f"claim {number}: {fault}") from fault


def claims_of(event: Event) -> tuple[Claim, ...]:
    """Return the claims of an event; most events have none."""
    plain = event.detail.get("claims")
    return claims_from_plain(plain) if plain else ()


def claims_written(frame: Frame, place: Position) -> tuple[Claim, ...]:
    """Return the claims on a sign that was written in a frame; none for other blocks."""
    block = frame.blocks[place]
    if not isinstance(block, Sign):
        return ()
    for event in reversed(frame.events):
        if event.kind is EventKind.BLOCK_UPDATE and event.detail.get("position") == place:
            # Turning a sign also updates its block but keeps its text. The event's claims count
            # only if they come with the text that is there now.
            is_told = event.detail.get("text", block.text) == block.text
            return claims_of(event) if is_told else ()
    return ()


def with_claims(
    detail: Mapping[str, Any],
    claims: Iterable[Claim],
    box: Box,
    agents: Collection[str],
) -> dict[str, Any]:
    """Return an event's detail with claims added, if there are any.

    Args:
        detail: Detail of the event.
        claims: Claims of its text.
        box: Box of the world.
        agents: Names of all agents.

    Raises:
        InputError: `claims` is not a list of claims, or a claim is not about this world.
    """
    listed: object = claims
    if isinstance(listed, str) or not isinstance(listed, Iterable):
        raise InputError(f"claims are {quoted(listed)}; give a list of claims, [] for none")
    all_claims = tuple(listed)
    for claim in all_claims:
        if not isinstance(claim, Claim):
            raise InputError(
                f"{quoted(claim)} is no claim; make one with Claim.located, absent, position or "
                "block"
            )
        claim.check(box, agents)
    plain = {"claims": tuple(claim.plain() for claim in all_claims)} if all_claims else {}
    return {**detail, **plain}


def _item(name: str) -> str:
    if not isinstance(name, str):
        raise InputError(f"a claim is about the item {quoted(name)}; give an item's name")
    Registry.load().item_stack(name)
    return name.removeprefix("minecraft:")


def _stated(text: str) -> str:
    registry = Registry.load()
    try:
        state = registry.state_id(text)
    except BeliefNestError as fault:
        raise type(fault)(f"a claim about a block: {fault}") from None
    # Keep only the properties that the text names, in sorted order; a claim is silent on others.
    _, stated = parse_state(text)
    written = ",".join(f"{key}={value}" for key, value in sorted(stated.items()))
    name = registry.name(state)
    return f"{name}[{written}]" if written else name


def _block_position(place: object) -> Position:
    point = _point(place)
    if any(value != math.floor(value) for value in point):
        raise InputError(f"a claim is about the block at {quoted(place)}; give three whole numbers")
    x, y, z = (int(value) for value in point)
    return (x, y, z)


def _point(place: object) -> Point:
    values = tuple(place) if isinstance(place, Iterable) else ()
    if len(values) != 3 or not all(isinstance(v, int | float) and math.isfinite(v) for v in values):
        raise InputError(f"a claim is about the place {quoted(place)}; give three finite numbers")
    x, y, z = (float(value) for value in values)
    return (x, y, z)
