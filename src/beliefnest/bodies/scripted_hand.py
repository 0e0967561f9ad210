"""Agents that act in a scripted world: what they may know, how they walk, what they are told to do.

Walking takes one tick for each cell.
"""

import math
from collections.abc import Callable, Generator, Mapping
from collections.abc import Set as AbstractSet
from dataclasses import dataclass, field
from typing import Any

from beliefnest.bodies.footpaths import Goal, Ground, InReach, feet_in
from beliefnest.bodies.protocol import NO_WAY, FreeLine
from beliefnest.errors import BeliefNestError
from beliefnest.world.doors import is_doorway, is_open, moves_by_hand
from beliefnest.world.registry import AIR, Registry
from beliefnest.world.scripted import ScriptedWorld
from beliefnest.world.values import AgentState, Point, Position

__all__ = [
    "REACH",
    "Doing",
    "Doors",
    "Hand",
    "SkillError",
    "block_in",
    "cell_of",
    "doors_in",
    "items_in",
    "number_in",
    "point_in",
    "text_in",
    "walk",
    "walk_to_use",
]

REACH = 4.0
"""Blocks between the eyes of somebody and the middle of a block that it can use."""
Doing = Generator[None, None, Any]
"""A skill under way: advanced once in each tick, until it returns."""


class SkillError(BeliefNestError):
    """A skill could not do what it was asked for.

    Attributes:
        reason: As that of `Fault`.
    """

    def __init__(self, message: str, reason: str | None = None) -> None:
        super().__init__(message)
        self.reason = reason


@dataclass(frozen=True)
class Hand:
    """An agent that acts in a scripted world.

    Attributes:
        name: Who it is.
        world: Where it acts.
        known: The ground as far as the agent may know it, which ways are looked for on.
        others: The agents that it knows to be there.
        signs: What it may know to be written on signs.
        ground: The ground as it is, which carries and stops a body.
        speech_ticks: Ticks that it takes it to say something; 0: it is said in the next one.
        mouth: What it is about to say, in order.
        heard: What it heard in the latest tick: speaker, text, and to whom it was whispered.
        has_free_line: Given eyes and a block, whether nothing that the agent knows of lies between;
            None: it reaches through everything.
    """

    name: str
    world: ScriptedWorld
    known: Callable[[], Ground]
    others: Callable[[], Mapping[str, AgentState]]
    signs: Callable[[], Mapping[Position, str]]
    ground: Callable[[], Ground]
    speech_ticks: int = 0
    mouth: list[object] = field(default_factory=list)
    heard: list[tuple[str, str, str | None]] = field(default_factory=list)
    has_free_line: FreeLine | None = None

    def reach(self, place: Position, *, beside: bool = False) -> InReach:
        """Standing where it reaches a block; `beside` as there."""
        return InReach(place, REACH, beside, self.has_free_line)

    @property
    def feet(self) -> Point:
        """Where it stands."""
        return self.world.agent(self.name).position

    @property
    def cell(self) -> Position:
        """The cell it stands in."""
        return cell_of(self.feet)


def walk_to_use(hand: Hand, place: Position) -> Doing:
    """Walk to where a block can be used."""
    yield from walk(hand, place, hand.reach(place), "the block")


@dataclass(frozen=True, slots=True)
class Doors:
    """What somebody who walks does with doors and gates that are moved by hand.

    Attributes:
        opens: Whether it opens shut ones where no other way leads.
        closes: Whether it shuts those it went through, also those that stood open.
    """

    opens: bool = True
    closes: bool = False


_ANY_DOOR = Doors()


def doors_in(value: Any) -> Doors:
    """What a program says about doors; SkillError if that is nothing."""
    given = {} if value is None else value
    names = ("openDoors", "closeDoors")
    if not isinstance(given, dict) or not all(
        name in names and isinstance(flag, bool) for name, flag in given.items()
    ):
        raise SkillError(
            f"doors may have openDoors and closeDoors, each true or false; it is {value!r}"
        )
    return Doors(given.get("openDoors", True), given.get("closeDoors", False))


def _way(
    hand: Hand, goal: Goal, doors: Doors, bumped: AbstractSet[Position]
) -> tuple[Position, ...] | None:
    """Return a way that opens no door, or one that does; round what the body has bumped into."""
    known = hand.known()
    way = known.way(hand.cell, goal, bumped)
    if way is None and doors.opens and known.with_doors_opened.has_doorways:
        way = known.with_doors_opened.way(hand.cell, goal, bumped)
    return way


def _bring(hand: Hand, cell: Position, *, opens: bool) -> Doing:
    """Open or shut the door in a cell that is moved by hand, if it is not so: a tick."""
    world, registry = hand.world, Registry.load()

    def is_to_move() -> bool:
        state = int(world.blocks[world.box.index(cell)]) if cell in world.box else AIR
        name = registry.name(state)
        return is_doorway(name) and moves_by_hand(name) and is_open(registry, state) is not opens

    if is_to_move():
        yield
        # Somebody else may have done it in this very tick.
        if is_to_move():
            world.use_door(hand.name, cell, open=opens)


def walk(hand: Hand, target: Point, goal: Goal, what: str, doors: Doors = _ANY_DOOR) -> Doing:
    """Walk until a cell is reached that is good enough, one cell a tick; whether it walked."""
    moved = False
    bumped: set[Position] = set()
    while not goal.is_met(hand.cell):
        way = _way(hand, goal, doors, bumped)
        if way is None:
            far = math.dist(hand.feet, target)
            raise SkillError(
                f"could not reach {what} at {tuple(target)}: there is no way to it on foot; now at "
                f"{hand.feet}, {far:.1f} blocks away. Go somewhere else, or clear the way first.",
                NO_WAY,
            )
        for cell in way:
            if doors.opens:
                yield from _bring(hand, cell, opens=True)
            yield
            if not hand.ground().stands(cell):
                bumped.add(cell)
                break
            moved, behind = True, hand.cell
            _step_to(hand, cell)
            if doors.closes:
                yield from _bring(hand, behind, opens=False)
    return moved


def _step_to(hand: Hand, cell: Position) -> None:
    """One step, looking ahead."""
    x, _, z = hand.feet
    feet = feet_in(cell)
    yaw = math.atan2(-(feet[0] - x), -(feet[2] - z))
    hand.world.place_agent(hand.name, feet, yaw=yaw, pitch=0.0)


def point_in(name: str, value: Any) -> Point:
    """Return a point that a program gave; SkillError if it is none."""
    if not (isinstance(value, list | tuple) and len(value) == 3 and all(map(_is_number, value))):
        raise SkillError(f"{name} must be a Vec3 of three finite numbers; it is {value!r}")
    return (float(value[0]), float(value[1]), float(value[2]))


def block_in(value: Any) -> Position:
    """Return the block that a point lies in; SkillError if it is none."""
    return cell_of(point_in("position", value))


def cell_of(point: Point) -> Position:
    """Return the cell that a point lies in."""
    return (math.floor(point[0]), math.floor(point[1]), math.floor(point[2]))


def items_in(value: Any) -> dict[str, int]:
    """Return items and how many of each; SkillError if they are none."""
    registry = Registry.load()
    if not isinstance(value, dict) or not value:
        raise SkillError(f"items must say how many of which, like {{diamond: 1}}; it is {value!r}")
    for name, count in value.items():
        registry.item_stack(name)
        if not _is_number(count) or count != int(count) or count < 1:
            raise SkillError(f"items.{name} must be a whole number above 0; it is {count!r}")
    return {name: int(count) for name, count in value.items()}


def text_in(value: Any) -> str:
    """Return a text that is not empty; SkillError if it is none."""
    if not isinstance(value, str) or not value.strip():
        raise SkillError(f"a text is wanted that is not empty; it is {value!r}")
    return value


def number_in(name: str, value: Any) -> float:
    """Return a number of at least 0; SkillError if it is none."""
    if not _is_number(value) or value < 0:
        raise SkillError(f"{name} must be a number of at least 0; it is {value!r}")
    return float(value)


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
