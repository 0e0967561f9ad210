"""What an explanation consists of: facts, beliefs, sightings and what was missed."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Literal

from beliefnest.belief.entries import Basis, PerceivedEvent
from beliefnest.world.claims import Claim
from beliefnest.world.paths import BeliefPath
from beliefnest.world.values import Point, Position

__all__ = [
    "Absence",
    "Contents",
    "Element",
    "Fact",
    "HeardClaim",
    "Level",
    "Missed",
    "SeenElsewhere",
    "Sighting",
    "Value",
    "View",
]


@dataclass(frozen=True, slots=True)
class Contents:
    """Known items of a container or an inventory.

    Attributes:
        items: Item name to count.
        complete: Whether these are known to be all.
    """

    items: Mapping[str, int]
    complete: bool


Value = str | Point | Contents | None
"""A block state's text, an agent's feet (blocks), contents; None: unknown, or there is none."""


@dataclass(frozen=True, slots=True)
class Element:
    """What is explained.

    Attributes:
        kind: What it is.
        where: Its position, or the agent's name.
    """

    kind: Literal["container", "agent", "block"]
    where: Position | str


class View(StrEnum):
    """How a look at something ends."""

    SEEN = "seen"
    BLOCKED = "blocked"
    TOO_FAR = "too far"
    OUTSIDE_VIEW = "outside the field of view"
    PLACE_UNKNOWN = "place unknown"


@dataclass(frozen=True, slots=True)
class Sighting:
    """A look at an agent or a block.

    Attributes:
        target: Agent name or block name.
        at: The agent's feet, or the block's position; None: unknown.
        view: How it ended.
        distance: From the eye to the block's centre or to the agent's body centre, blocks;
            None where the place is unknown.
        blocker: Position of the first block the ray enters, if it is blocked.
        blocker_name: Name of that block.
    """

    target: str
    at: Point | Position | None
    view: View
    distance: float | None = None
    blocker: Position | None = None
    blocker_name: str | None = None


@dataclass(frozen=True, slots=True)
class Absence:
    """The parent node cannot say what the perceiver saw: it did not see the perceiver itself.

    Attributes:
        last_seen: Tick of the pose that the parent node held; None: it held none.
        sighting: The look of that simulator's owner for the perceiver in that tick; None
            where the owner was itself not present one level up.
    """

    last_seen: int | None
    sighting: Sighting | None


@dataclass(frozen=True, slots=True)
class Missed:
    """A change in the parent node that did not reach the belief.

    Attributes:
        tick: When; for what was never known, the tick of the explanation.
        before: What the parent node held before; equal to `after` for what was never
            known.
        after: What it held then.
        acts: Who did what to it in that tick, as perceived in the parent node.
        edited: Whether the parent node was changed by hand.
        stood: The perceiver's feet in the parent node; None: unknown.
        absence: Set where the perceiver was not present.
        sightings: The looks that would have shown it, where the perceiver was present.
        saw_acts: Whether the perceiver perceived the acts, which did not show the change.
    """

    tick: int
    before: Value
    after: Value
    acts: tuple[PerceivedEvent, ...]
    edited: bool
    stood: Point | None
    absence: Absence | None
    sightings: tuple[Sighting, ...]
    saw_acts: bool


@dataclass(frozen=True, slots=True)
class HeardClaim:
    """A claim by which something went out of a container, as it is believed.

    Attributes:
        tick: When it was made.
        speaker: Who made it; None: nobody is known to have written it.
        claim: What was claimed.
        sign: Position of the sign on which it was read; None: it was heard.
    """

    tick: int
    speaker: str | None
    claim: Claim
    sign: Position | None = None


@dataclass(frozen=True, slots=True)
class SeenElsewhere:
    """A perception of a unique item by which it went out of a container, as it is believed.

    Attributes:
        tick: When.
        item: Name of the item.
        where: Position of another container, name of the agent that has it, feet-high point of the
            floor; None: it was seen to be moved, and not where to.
    """

    tick: int
    item: str
    where: Position | Point | str | None


@dataclass(frozen=True, slots=True)
class Fact:
    """How the element is in the world of the timeline that everything rests on.

    Attributes:
        path: Belief path of that world, agent names; the real one's is empty.
        branch: Its branch.
        value: How it is.
        block: Name of the block at its position; None for an agent, or where unknown.
        since: Tick of its last change on this branch; None: as it was at the start.
        acts: Who did what to it in that tick.
        edited: Whether it was changed by hand.
        forked_at: Tick at which the branch forked from another; None: it did not.
    """

    path: BeliefPath
    branch: str
    value: Value
    block: str | None
    since: int | None
    acts: tuple[PerceivedEvent, ...]
    edited: bool
    forked_at: int | None


@dataclass(frozen=True, slots=True)
class Level:
    """What one belief holds of the element, and what that rests on.

    Attributes:
        path: Belief path, agent names from the outermost believer inwards.
        holder: Whose belief it is.
        value: What it holds.
        block: Name of the block it holds to be at the position; None: unknown, or an agent.
        basis: The perception it rests on; None where nothing is known.
        current: Whether a perception in this tick backs it.
        acts: What was perceived of acts on the element, at the last tick of any up to that of the
            basis.
        since: Tick from which on the belief held this; later than the basis where it was
            handed on stale; None where nothing was ever known.
        stood: The holder's feet in the parent node at tick `since`; None: unknown.
        missed: The first change since that did not reach the belief, or for what was never
            known, why it is not perceived now; None: there is none.
        weighed: Whether hearsay is believed of those alone who may know better.
        told: Claims by which something went out of the container since the basis' tick.
        elsewhere: Perceptions of unique items by which these went out of it since then.
    """

    path: BeliefPath
    holder: str
    value: Value
    block: str | None
    basis: Basis | None
    current: bool
    acts: tuple[PerceivedEvent, ...]
    since: int | None
    stood: Point | None
    missed: Missed | None
    weighed: bool = False
    told: tuple[HeardClaim, ...] = ()
    elsewhere: tuple[SeenElsewhere, ...] = ()
