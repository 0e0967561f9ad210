"""Agents that act in a scripted world: their knowledge, walking, and arguments of skills.

Walking takes one tick for each cell.
"""

import itertools
import math
from collections import deque
from collections.abc import Callable, Generator, Mapping, Sequence
from collections.abc import Set as AbstractSet
from typing import Any

import msgspec

from beliefnest.errors import BeliefNestError
from beliefnest.world.doors import is_doorway, is_open, moves_by_hand
from beliefnest.world.event_words import Announcement
from beliefnest.world.registry import AIR, Registry
from beliefnest.world.texts import MOST_UTTERANCES, quoted
from beliefnest.world.values import (
    EYE_HEIGHT,
    AgentState,
    Items,
    Point,
    Position,
    block_at,
    feet_in,
)
from beliefnest.worlds.protocol import NO_WAY
from beliefnest.worlds.scripted.footpaths import Ground, InReach, Near, WalkGoal
from beliefnest.worlds.scripted.world import ScriptedWorld

_SHORTEST_STRIDE = 3
REACH = 4.0
"""Distance, in blocks, between the eyes and the middle of a block to which skills walk."""
_ARM = 6.0
"""Largest distance, in blocks, between the eyes and the middle of a block in use."""
Doing = Generator[int, None, Any]
"""Skill in progress, advanced once in each tick until it returns; it yields ticks to skip, or 0."""


class SkillError(BeliefNestError):
    """Failure of a skill.

    Attributes:
        reason: Reason, as in `Fault`.
    """

    def __init__(self, message: str, reason: str | None = None) -> None:
        super().__init__(message)
        self.reason = reason


def mute_fault(name: str) -> str:
    """Return what an agent is told that tries to speak and may not."""
    return f"{name} may not speak here"


class Hand(msgspec.Struct, frozen=True):
    """Agent that acts in a scripted world.

    Attributes:
        name: Name of the agent.
        world: World in which it acts.
        known: Ground as far as the agent may know it; paths are planned on it.
        others: The agents that it knows to be present.
        signs: Texts of signs that it may know.
        ground: True ground, which carries and stops the body.
        speech_ticks: Ticks per utterance; 0 if it is said in the next tick.
        mute: True if it cannot say or whisper anything.
        mouth: Utterances that it is about to make, in order.
        uttered: Ticks of its latest utterances.
        news: Events of its bot about what it perceived, in the latest tick, but did not see.
        walks: Ticks at which it set out.
        stride: Function that returns the number of ticks, from the current one on, in which nothing
            but this agent acts and nobody watches. Steps of so many ticks are taken at once, and
            the walk then yields the number of ticks to skip.
    """

    name: str
    world: ScriptedWorld
    known: Callable[[], Ground]
    others: Callable[[], Mapping[str, AgentState]]
    signs: Callable[[], Mapping[Position, str]]
    ground: Callable[[], Ground]
    speech_ticks: int = 0
    mute: bool = False
    mouth: list[object] = msgspec.field(default_factory=list)
    uttered: list[int] = msgspec.field(default_factory=list)
    news: list[Announcement] = msgspec.field(default_factory=list)
    walks: list[int] = msgspec.field(default_factory=list)
    stride: Callable[[], int] = lambda: 1

    def reach(self, place: Position, *, beside: bool = False) -> InReach:
        """Return the goal of standing where the agent reaches a block; `beside` as in `InReach`."""
        return InReach(place, REACH, beside)

    def check_touch(self, place: Position, what: str) -> None:
        """Raise SkillError if the body cannot use a block from where it stands."""
        eye, middle = self.eye, tuple(part + 0.5 for part in place)
        far = math.dist(eye, middle)
        if far > _ARM:
            fault = f"it is {far:.1f} blocks away, an arm reaches {_ARM:g}"
        elif not self.ground().can_touch(eye, place):
            fault = "no free line of sight"
        else:
            return
        raise SkillError(f"{what} at {place} cannot be reached from here: {fault}")

    @property
    def inventory(self) -> Items:
        """Items that it carries."""
        return self.world.agent(self.name).inventory

    @property
    def contents(self) -> str:
        """Items that it carries, for messages."""
        return ", ".join(f"{count} {name}" for name, count in self.inventory.items()) or "nothing"

    def lacking(self, called: str, place: Position, advice: str) -> SkillError:
        """Return the error that there is no such block at a place.

        It names the block that is there if the agent may know everything.
        """
        registry, state = Registry.load(), self.world.state_at(place)
        there = f", but {registry.name(state)}" if self.known() is self.ground() else ""
        return SkillError(f"there is no {called} at {place}{there}. {advice}")

    def may_utter(self) -> bool:
        """Count an utterance of this tick; return False if there have been too many.

        As in Minecraft, where the server drops what is too much.
        """
        now = self.world.now
        self.uttered[:] = [tick for tick in self.uttered if tick == now]
        self.uttered.append(now)
        return len(self.uttered) <= MOST_UTTERANCES

    @property
    def feet(self) -> Point:
        """Position of the feet."""
        return self.world.agent(self.name).position

    def can_throw_to(self, other: str) -> bool:
        """Return True if nothing solid lies between the eyes and another agent's body."""
        x, y, z = block_at(self.world.agent(other).position)
        return any(self.ground().can_touch(self.eye, (x, y + up, z)) for up in (0, 1))

    @property
    def eye(self) -> Point:
        """Place of the eyes."""
        x, y, z = self.feet
        return (x, y + EYE_HEIGHT, z)

    @property
    def cell(self) -> Position:
        """Cell in which the agent stands; on a low block, the one above the block."""
        feet = self.feet
        return block_at(feet) if feet[1] == math.floor(feet[1]) else self.ground().cell_of(feet)

    def has_reached(self, goal: WalkGoal) -> bool:
        """Return True if the agent meets a goal; see `footpath_kernels` for feet on low blocks."""
        if self.known().meets(goal, self.cell):
            return True
        return isinstance(goal, Near) and goal.is_met(block_at(self.feet))


def walk_to_use(
    hand: Hand, place: Position, called: str, is_such: Callable[[str], bool], advice: str = ""
) -> Doing:
    """Walk to where a block can be used, as far as the agent knows; fail if its body cannot.

    Args:
        hand: The agent.
        place: Position of the block.
        called: What the block is called.
        is_such: Returns True for names of such blocks. It fails at once if the agent knows that
            another block is there, and on arrival if it turns out so.
        advice: End of the message then.
    """
    advice = advice or f"Give the position of a {called}."
    name = hand.known().name_at(place)
    if name is not None and not is_such(name):
        raise hand.lacking(called, place, advice)
    yield from walk(hand, place, hand.reach(place), "the block")
    hand.check_touch(place, "the block")
    if not is_such(hand.ground().name_at(place) or ""):
        raise hand.lacking(called, place, advice)


class Doors(msgspec.Struct, frozen=True):
    """Treatment of doors and gates that can be moved by hand.

    Attributes:
        opens: True to open shut ones if no other path exists.
        closes: True to shut them afterwards, including those that stood open.
    """

    opens: bool = True
    closes: bool = False


_ANY_DOOR = Doors()


def doors_in(value: Any) -> Doors:
    """Return a program's argument about doors; raises SkillError if it is malformed."""
    flags = {} if value is None else value
    names = ("openDoors", "closeDoors")
    if not isinstance(flags, dict) or not all(
        name in names and isinstance(flag, bool) for name, flag in flags.items()
    ):
        raise SkillError(
            f"doors may have openDoors and closeDoors, each true or false; it is {quoted(value)}"
        )
    return Doors(flags.get("openDoors", True), flags.get("closeDoors", False))


def _way(
    hand: Hand, goal: WalkGoal, doors: Doors, bumped: AbstractSet[Position]
) -> tuple[Position, ...] | None:
    """Return a path through no door, or else one through doors; avoid cells bumped into."""
    grounds = hand.known()
    through = grounds.with_doors_opened if doors.opens else grounds
    way = grounds.without_doors.way(hand.cell, goal, bumped)
    if way is None and through is not grounds.without_doors:
        way = through.way(hand.cell, goal, bumped)
    return way


def _bring(hand: Hand, cell: Position, *, opens: bool) -> Doing:
    """Open or shut the door in a cell in one tick, if needed and if it moves by hand."""
    world, registry = hand.world, Registry.load()

    def is_to_move() -> bool:
        state = world.state_at(cell)
        name = registry.name(state)
        return is_doorway(name) and moves_by_hand(name) and is_open(registry, state) is not opens

    if is_to_move():
        yield 0
        # Another agent may have moved it in this very tick.
        if is_to_move():
            world.use_door(hand.name, cell, open=opens)


def walk(hand: Hand, target: Point, goal: WalkGoal, what: str, doors: Doors = _ANY_DOOR) -> Doing:
    """Walk until the goal is met, one cell a tick; return True if the agent walked."""
    moved = False
    bumped: set[Position] = set()
    while not hand.has_reached(goal):
        hand.walks.append(hand.world.now)
        way = _way(hand, goal, doors, bumped)
        if way is None:
            far = math.dist(hand.feet, target)
            raise SkillError(
                f"could not reach {what} at {tuple(target)}: there is no way to it on foot; now at "
                f"{hand.feet}, {far:.1f} blocks away. Go somewhere else, or clear the way first.",
                NO_WAY,
            )
        steps = deque(way)
        while steps:
            ground = hand.ground()
            if doors.opens and ground.has_doors:
                yield from _bring(hand, steps[0], opens=True)
            yield 0
            ground = hand.ground()
            if not ground.stands(steps[0]):
                bumped.add(steps[0])
                break
            skipped = _skipped(hand, steps)
            feet, behind = hand.feet, hand.cell
            for _ in range(skipped):
                behind = steps.popleft()
                feet = feet_in(behind)
            moved = True
            _step_to(hand, feet, ground.feet(steps.popleft()))
            if skipped:
                yield skipped
            if doors.closes and ground.has_doors:
                yield from _bring(hand, behind, opens=False)
    return moved


def _skipped(hand: Hand, steps: Sequence[Position]) -> int:
    """Return the number of next steps, but for the last, that can be taken at once."""
    stride = min(hand.stride(), len(steps))
    if stride < _SHORTEST_STRIDE:
        return 0
    world, ground = hand.world, hand.ground()
    free = 0
    # Doors are opened one by one, and an unknown floor may turn out to be none.
    for cell in itertools.islice(steps, stride):
        if cell not in world.box or world.state_at(cell) != AIR or not ground.stands(cell):
            break
        free += 1
    return max(0, free - 1)


def _step_to(hand: Hand, feet: Point, ahead: Point) -> None:
    """Take a step from one place of the feet to another, with the view ahead."""
    yaw = math.atan2(-(ahead[0] - feet[0]), -(ahead[2] - feet[2]))
    hand.world.place_agent(hand.name, ahead, yaw, pitch=0.0)


def point_in(name: str, value: Any) -> Point:
    """Return a program's point; raises SkillError if it is not valid."""
    if not (isinstance(value, list | tuple) and len(value) == 3 and all(map(_is_number, value))):
        raise SkillError(f"{name} must be a Vec3 of three finite numbers; it is {quoted(value)}")
    return (float(value[0]), float(value[1]), float(value[2]))


def block_in(value: Any) -> Position:
    """Return the position of the block that contains a point; raises SkillError if not valid."""
    return block_at(point_in("position", value))


def items_in(value: Any) -> dict[str, int]:
    """Return items and their counts; raises SkillError if they are not valid."""
    registry = Registry.load()
    if not isinstance(value, dict) or not value:
        raise SkillError(
            f"items must say how many of which, like {{diamond: 1}}; it is {quoted(value)}"
        )
    for name, count in value.items():
        registry.item_stack(name)
        if not _is_number(count) or count != int(count) or count < 1:
            raise SkillError(f"items.{name} must be a whole number above 0; it is {quoted(count)}")
    return {name: int(count) for name, count in value.items()}


def text_in(value: Any) -> str:
    """Return a text that is not empty; raises SkillError otherwise."""
    if not isinstance(value, str) or not value.strip():
        raise SkillError(f"a text is wanted that is not empty; it is {quoted(value)}")
    return value


def number_in(name: str, value: Any) -> float:
    """Return a number of at least 0; raises SkillError otherwise."""
    if not _is_number(value) or value < 0:
        raise SkillError(f"{name} must be a number of at least 0; it is {quoted(value)}")
    return float(value)


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
