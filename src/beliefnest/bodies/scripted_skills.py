"""The skills of the scripted world, each a generator that is advanced once a tick.

Walking takes one tick for each cell; opening, taking, putting, turning to look, speaking, thinking
and handing over take one tick each.
"""

import math
from collections.abc import Callable, Generator, Mapping
from collections.abc import Set as AbstractSet
from dataclasses import dataclass
from typing import Any

from beliefnest.bodies.footpaths import Goal, Ground, InReach, Near, feet_in
from beliefnest.bodies.protocol import NO_WAY
from beliefnest.errors import BeliefNestError, WorldError
from beliefnest.world.claims import claims_from_plain
from beliefnest.world.doors import is_doorway, is_open, moves_by_hand
from beliefnest.world.registry import AIR, Registry
from beliefnest.world.scripted import ScriptedWorld
from beliefnest.world.signs import sign_fault
from beliefnest.world.values import EYE_HEIGHT, AgentState, Point, Position

__all__ = ["CALLS", "REACH", "SKILLS", "Doing", "Hand", "SkillError"]

REACH = 4.0
"""Blocks between the eyes of somebody and the middle of a block that it can use."""
_NEAR = 2.0

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
    """

    name: str
    world: ScriptedWorld
    known: Callable[[], Ground]
    others: Callable[[], Mapping[str, AgentState]]
    signs: Callable[[], Mapping[Position, str]]
    ground: Callable[[], Ground]

    @property
    def feet(self) -> Point:
        """Where it stands."""
        return self.world.agents[self.name].position

    @property
    def cell(self) -> Position:
        """The cell it stands in."""
        return _cell(self.feet)


def _go_to_position(hand: Hand, position: Any, dist: Any = 2, doors: Any = None) -> Doing:
    target = _point("position", position)
    near = _number("dist", dist)
    doors = _doors(doors)
    moved = yield from _walk(hand, target, Near(_cell(target), near), "the position", doors)
    if not moved:
        yield
    hand.world.arrive(hand.name, target)


def _get_item_from_chest(hand: Hand, position: Any, items: Any) -> Doing:
    place, wanted = _block(position), _items(items)
    yield from _open(hand, place)
    yield
    there = hand.world.contents(place)
    moved = {name: min(n, there.get(name, 0)) for name, n in wanted.items() if there.get(name, 0)}
    if moved:
        hand.world.withdraw(hand.name, place, moved)
    missing = [
        f"{n} {name} asked for from the chest at {place}, it holds {there.get(name, 0)}"
        for name, n in wanted.items()
        if there.get(name, 0) < n
    ]
    if missing:
        raise SkillError(f"{'; '.join(missing)}. Ask for what is there, or look elsewhere.")


def _deposit_item_into_chest(hand: Hand, position: Any, items: Any) -> Doing:
    place, wanted = _block(position), _items(items)
    yield from _open(hand, place)
    yield
    hand.world.deposit(hand.name, place, wanted)


def _open_container(hand: Hand, position: Any) -> Doing:
    place = _block(position)
    yield from _open(hand, place, walks=False)
    return dict(hand.world.contents(place))


def _use_door(to_open: bool) -> Callable[..., Doing]:
    def use(hand: Hand, position: Any) -> Doing:
        place = _block(position)
        yield from _walk_to_use(hand, place)
        world = hand.world
        there = int(world.blocks[world.box.index(place)]) if place in world.box else AIR
        if is_open(Registry.load(), there) is to_open:
            return
        yield
        world.use_door(hand.name, place, open=to_open)

    return use


def _write_sign(hand: Hand, position: Any, text: Any) -> Doing:
    place = _block(position)
    if not isinstance(text, str):
        raise SkillError(f"text must be a text; it is {text!r}")
    if fault := sign_fault(text):
        raise SkillError(f"text is {fault}")
    yield from _walk_to_use(hand, place)
    yield
    hand.world.write_sign(hand.name, place, text)


def _look_at(hand: Hand, position: Any) -> Doing:
    target = _point("position", position)
    yield
    x, y, z = hand.feet
    away = (target[0] - x, target[1] - y - EYE_HEIGHT, target[2] - z)
    hand.world.place_agent(
        hand.name,
        hand.feet,
        yaw=math.atan2(-away[0], -away[2]),
        pitch=math.atan2(away[1], math.hypot(away[0], away[2])),
    )


def _read_sign(hand: Hand, position: Any) -> Doing:
    place = _block(position)
    if hand.known().is_sign(place) is False:
        raise SkillError(f"there is no sign at {place}. Give the position of a sign.")
    x, y, z = place
    yield from _look_at(hand, (x + 0.5, y + 0.5, z + 0.5))
    yield
    if not hand.known().is_sign(place):
        raise SkillError(f"no sign is to be seen at {place}. Go nearer, or look somewhere else.")
    return hand.signs().get(place, "")


def _say(hand: Hand, text: Any, claims: Any = ()) -> Doing:
    yield
    hand.world.say(hand.name, _text(text), claims_from_plain(claims or ()))


def _whisper(hand: Hand, other: Any, text: Any, claims: Any = ()) -> Doing:
    yield
    hand.world.whisper(hand.name, _text(other), _text(text), claims_from_plain(claims or ()))


def _think(hand: Hand, text: Any) -> Doing:
    yield
    hand.world.think(hand.name, _text(text))


def _give_item(hand: Hand, other: Any, item: Any, count: Any) -> Doing:
    name = _text(other)
    others = hand.others()
    if name not in others:
        raise SkillError(f"{name!r} is no agent that is known to be here; it is {sorted(others)}")
    where = others[name].position
    yield from _walk(hand, where, Near(_cell(where), _NEAR), name)
    yield
    hand.world.give(hand.name, name, _items({_text(item): count}))


def _wait_ticks(hand: Hand, ticks: Any) -> Doing:
    for _ in range(math.ceil(_number("ticks", ticks))):
        yield


def _do_nothing(hand: Hand) -> Doing:
    yield


SKILLS: Mapping[str, Callable[..., Doing]] = {
    "goToPosition": _go_to_position,
    "getItemFromChest": _get_item_from_chest,
    "depositItemIntoChest": _deposit_item_into_chest,
    "openDoor": _use_door(to_open=True),
    "closeDoor": _use_door(to_open=False),
    "writeSign": _write_sign,
    "readSign": _read_sign,
    "lookAt": _look_at,
    "giveItemToOther": _give_item,
    "say": _say,
    "whisper": _whisper,
    "think": _think,
    "waitTicks": _wait_ticks,
    "doNothing": _do_nothing,
}
"""By name."""

CALLS: Mapping[str, Callable[..., Doing]] = {
    "openContainer": _open_container,
    "bot.chat": _say,
    "bot.whisper": _whisper,
}
"""What a program asks of its bot itself."""


def _open(hand: Hand, place: Position, *, walks: bool = True) -> Doing:
    if walks:
        if not hand.known().may_hold(place):
            raise SkillError(
                f"there is no container at {place}. Give the position of a chest or barrel."
            )
        yield from _walk_to_use(hand, place)
    yield
    _check_container(hand, place)
    if not InReach(place, REACH).is_met(hand.cell):
        raise SkillError(f"the container at {place} is too far away to open it; go nearer")
    hand.world.open(hand.name, place)


def _check_container(hand: Hand, place: Position) -> None:
    try:
        hand.world.contents(place)
    except WorldError as error:
        raise SkillError(f"{error}. Give the position of a chest or barrel.") from None


def _walk_to_use(hand: Hand, place: Position) -> Doing:
    yield from _walk(hand, place, InReach(place, REACH), "the block")


@dataclass(frozen=True, slots=True)
class _Doors:
    """What somebody who walks does with doors and gates that are moved by hand.

    Attributes:
        opens: Whether it opens shut ones where no other way leads.
        closes: Whether it shuts those it went through, also those that stood open.
    """

    opens: bool = True
    closes: bool = False


_ANY_DOOR = _Doors()


def _doors(value: Any) -> _Doors:
    given = {} if value is None else value
    names = ("openDoors", "closeDoors")
    if not isinstance(given, dict) or not all(
        name in names and isinstance(flag, bool) for name, flag in given.items()
    ):
        raise SkillError(
            f"doors may have openDoors and closeDoors, each true or false; it is {value!r}"
        )
    return _Doors(given.get("openDoors", True), given.get("closeDoors", False))


def _way(
    hand: Hand, goal: Goal, doors: _Doors, bumped: AbstractSet[Position]
) -> tuple[Position, ...] | None:
    """A way that opens no door, or one that does; round what the body has bumped into."""
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


def _walk(hand: Hand, target: Point, goal: Goal, what: str, doors: _Doors = _ANY_DOOR) -> Doing:
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


def _point(name: str, value: Any) -> Point:
    if not (isinstance(value, list | tuple) and len(value) == 3 and all(map(_is_number, value))):
        raise SkillError(f"{name} must be a Vec3 of three finite numbers; it is {value!r}")
    return (float(value[0]), float(value[1]), float(value[2]))


def _block(value: Any) -> Position:
    return _cell(_point("position", value))


def _cell(point: Point) -> Position:
    return (math.floor(point[0]), math.floor(point[1]), math.floor(point[2]))


def _items(value: Any) -> dict[str, int]:
    registry = Registry.load()
    if not isinstance(value, dict) or not value:
        raise SkillError(f"items must say how many of which, like {{diamond: 1}}; it is {value!r}")
    for name, count in value.items():
        registry.item_stack(name)
        if not _is_number(count) or count != int(count) or count < 1:
            raise SkillError(f"items.{name} must be a whole number above 0; it is {count!r}")
    return {name: int(count) for name, count in value.items()}


def _text(value: Any) -> str:
    if not isinstance(value, str) or not value.strip():
        raise SkillError(f"a text is wanted that is not empty; it is {value!r}")
    return value


def _number(name: str, value: Any) -> float:
    if not _is_number(value) or value < 0:
        raise SkillError(f"{name} must be a number of at least 0; it is {value!r}")
    return float(value)


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
