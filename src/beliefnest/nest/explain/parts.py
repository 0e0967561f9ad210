"""Parts of an explanation: facts, beliefs, sightings and missed changes."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Literal

import msgspec

from beliefnest.belief.grounds import Basis, PerceivedEvent
from beliefnest.world.claims import Claim
from beliefnest.world.paths import BeliefPath
from beliefnest.world.values import Point, Position


@dataclass(frozen=True, slots=True)
class Contents:
    """Known items of a container or an inventory.

    Attributes:
        items: Item name to count.
        complete: True if it is known to hold nothing else.
    """

    items: Mapping[str, int]
    complete: bool


Value = str | Point | Contents | None
"""Text of a block state, feet position of an agent, or contents; None: unknown, or none."""


class Element(msgspec.Struct, frozen=True):
    """Element that is explained.

    Attributes:
        kind: `container`, `agent` or `block`.
        where: Position of the element, or name of the agent.
        label: Name of a container for people; None: it has none.
    """

    kind: Literal["container", "agent", "block"]
    where: Position | str
    label: str | None = None


class View(StrEnum):
    """Result of a look at something."""

    SEEN = "seen"
    BLOCKED = "blocked"
    TOO_FAR = "too far"
    OUTSIDE_VIEW = "outside the field of view"
    PLACE_UNKNOWN = "place unknown"


class Sighting(msgspec.Struct, frozen=True):
    """Look at an agent or a block.

    Attributes:
        target: Agent name or block name.
        at: The agent's feet, or the block's position; None: unknown.
        view: Result of the look.
        distance: Distance from the eye to the block's centre or the agent's body centre, in blocks;
            None if the position is unknown.
        blocker: Position of the first block that the ray enters, if the look is blocked.
        blocker_name: Name of that block.
    """

    target: str
    at: Point | Position | None
    view: View
    distance: float | None = None
    blocker: Position | None = None
    blocker_name: str | None = None


class Absence(msgspec.Struct, frozen=True):
    """Absence of a perceiver: the owner of the parent node did not see it at that tick.

    The parent node then cannot tell what the perceiver saw (semantics, section 5.2).

    Attributes:
        last_seen: Last tick at which the parent node's pose of the perceiver was current; None: it
            has none.
        sighting: The look of the parent node's owner for the perceiver at that tick; None if that
            owner was itself not present one level up.
    """

    last_seen: int | None
    sighting: Sighting | None


class Missed(msgspec.Struct, frozen=True):
    """Change in the parent node that did not reach the belief.

    For an element that was never known there need be no change: `tick` is that of the explanation,
    and `before` equals `after`.

    Attributes:
        tick: Tick of the change.
        before: Value in the parent node before the change.
        after: Value in the parent node after the change.
        acts: Acts on the element at that tick, as perceived in the parent node.
        edited: True if the parent node was changed by hand.
        stood: The perceiver's feet in the parent node; None: unknown.
        absence: The reason, if the perceiver was not present.
        sightings: The looks that would have shown the change, if the perceiver was present.
        saw_acts: True if the perceiver perceived the acts, which did not show the change.
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


class HeardClaim(msgspec.Struct, frozen=True):
    """Claim about an element that a holder believed when it heard or read it.

    Attributes:
        tick: Tick at which the holder perceived the claim.
        speaker: Name of the speaker or writer; None: the writer is unknown.
        claim: The claim.
        sign: Position of the sign with the claim; None: the claim was heard.
        refuted: Tick at which the holder first perceived that the item is not in the claimed
            container; None: it did not.
    """

    tick: int
    speaker: str | None
    claim: Claim
    sign: Position | None = None
    refuted: int | None = None


class SeenElsewhere(msgspec.Struct, frozen=True):
    """Perception or edit of a unique item that made a holder believe that it left a container.

    Attributes:
        tick: Tick of the perception or edit.
        item: Name of the item.
        where: Position of another container, name of the agent that has the item, or point of the
            floor; None: the holder saw the item moved, but not to which place.
        edited: True if the holder's belief was edited by hand so.
    """

    tick: int
    item: str
    where: Position | Point | str | None
    edited: bool = False


class ValueGround(msgspec.Struct, frozen=True):
    """Perception, prior belief or edit by hand on which a value rests, apart from claims.

    Attributes:
        basis: Its source and tick.
        since: Tick at which the holder took it up.
        stood: The holder's feet in the parent node at that tick; None: unknown.
        handed_on: True if the holder perceived a value that was not current in the parent node, and
            took over its basis with it.
        is_change: True if it shows a change of contents and not all of them: somebody else put
            items in or took some out.
        found: Known contents of the container then; None: it is no container, or only a change of
            its contents was perceived.
        acts: Acts on the element at the tick of the basis. If the value was handed on, these are
            acts that a believer further out perceived.
    """

    basis: Basis
    since: int
    stood: Point | None
    handed_on: bool = False
    is_change: bool = False
    found: Contents | None = None
    acts: tuple[PerceivedEvent, ...] = ()

    @property
    def tells_contents(self) -> bool:
        """False if the container was known from outside only."""
        return self.found is None or self.found.complete or bool(self.found.items)


Reason = ValueGround | HeardClaim | SeenElsewhere
"""Reason for a value: a perception, a prior, an edit or a claim."""


class BaseFact(msgspec.Struct, frozen=True):
    """Element in the world of the timeline from which all beliefs follow.

    Attributes:
        path: Belief path of that world, agent names; empty for the real world.
        branch: Name of the branch.
        value: Value of the element.
        block: Name of the block at its position; None for an agent, or if unknown.
        since: Tick of its last change on this branch; None: it has not changed on it.
        acts: Acts on the element at that tick.
        edited: True if the element was changed by hand at that tick.
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


class Level(msgspec.Struct, frozen=True):
    """Belief of one agent along the path about the element, with its ground.

    Attributes:
        path: Belief path, agent names from the outermost believer inwards.
        holder: Name of the agent whose belief it is.
        value: Believed value.
        block: Name of the believed block at the position; None: unknown, or an agent.
        basis: Ground of the value; None if nothing is known.
        current: True if a perception in this tick backs the value.
        since: Tick since which the belief has had this value. It is later than the tick of the
            basis if the holder took over a stale value. None: nothing was ever known.
        stood: The holder's feet in the parent node at tick `since`; None: unknown.
        missed: The first later change that did not reach the belief. For an element that was never
            known, the reason why it is not perceived now. None: there is none.
        weighed: True if hearers weigh claims (`testimony: informed`).
        reasons: Reasons for the value, oldest first; empty if nothing is known.
    """

    path: BeliefPath
    holder: str
    value: Value
    block: str | None
    basis: Basis | None
    current: bool
    since: int | None
    stood: Point | None
    missed: Missed | None
    weighed: bool = False
    reasons: tuple[Reason, ...] = ()
