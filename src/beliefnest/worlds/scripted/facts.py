"""Parts of the scripted world: its facts, the changes of a tick, argument checks."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import msgspec

from beliefnest.errors import WorldError
from beliefnest.world.frames import PlainClaims
from beliefnest.world.limits import agent_name_fault, box_fault
from beliefnest.world.terrain import Draft
from beliefnest.world.texts import fault_of, quoted
from beliefnest.world.values import (
    EQUIPMENT_SLOTS,
    AgentState,
    Block,
    Box,
    DroppedItem,
    Event,
    Items,
    Position,
)


@dataclass
class ScriptedFacts:
    """State of a scripted world; it is copied before each tick, to undo a failed one."""

    blocks: Draft
    containers: dict[Position, dict[str, int]]
    agents: dict[str, AgentState]
    items: dict[int, DroppedItem]
    signs: dict[Position, str] = field(default_factory=dict)
    sign_claims: dict[Position, PlainClaims] = field(default_factory=dict)
    due: dict[Position, int] = field(default_factory=dict)
    """Blocks that wait for a tick: buttons, plates and lamps that are on."""
    plates: frozenset[Position] = frozenset()
    """Pressure plates."""

    def copied(self) -> "ScriptedFacts":
        """Return a copy; it shares the draft of blocks."""
        return ScriptedFacts(
            self.blocks,
            dict(self.containers),
            dict(self.agents),
            dict(self.items),
            dict(self.signs),
            dict(self.sign_claims),
            dict(self.due),
            self.plates,
        )

    def under_way(self, tick: int) -> bytes:
        """Encode the internal state at a tick: the ticks left for blocks that wait.

        Nobody can perceive this state. `due_from` decodes it.
        """
        left = [(*place, due - tick) for place, due in self.due.items()]
        return msgspec.msgpack.encode(left) if left else b""


def due_from(state: bytes, tick: int) -> dict[Position, int]:
    """Decode blocks that wait, with the ticks for which they wait."""
    if not state:
        return {}
    left = msgspec.msgpack.decode(state, type=list[tuple[int, int, int, int]])
    return {(x, y, z): tick + ticks for x, y, z, ticks in left}


class Pending:
    """Changes of the current tick.

    Attributes:
        saved: Facts before the tick.
        replaced: Blocks that this tick has replaced, in order: index and state before.
        is_late: True at the end of the tick, when all agents have acted.
    """

    def __init__(self, facts: ScriptedFacts) -> None:
        self.saved = facts.copied()
        self.replaced: list[tuple[tuple[int, int, int], int]] = []
        self.is_late = False
        self.blocks: dict[Position, Block] = {}
        self.containers: set[Position] = set()
        self.agents: set[str] = set()
        self.events: list[Event] = []


def checked_box(box: tuple[Position, Position]) -> Box:
    """Return the box between two corners; WorldError if they are invalid."""
    try:
        low, high = map(whole_position, box)
    except WorldError as wrong:
        raise WorldError(f"{box} is no box: {wrong}") from None
    if any(a > b for a, b in zip(low, high, strict=True)):
        raise WorldError(f"{box} is no box; give its lower corner first")
    made = Box(low, high)
    if fault := box_fault(made):
        raise WorldError(fault)
    return made


def checked_name(name: str) -> str:
    """Return a valid agent name; WorldError if it is invalid."""
    if fault := agent_name_fault(name):
        raise WorldError(fault)
    return name


def checked_utterance(text: str) -> str:
    """Return a text that can be said at once; WorldError if it cannot be said."""
    if fault := fault_of(str(text)):
        raise WorldError(fault)
    return str(text)


def sum_of(items: Items, change: Items) -> dict[str, int]:
    """Add items to items."""
    return {
        name: items.get(name, 0) + change.get(name, 0)
        for name in [*items, *(change.keys() - items.keys())]
    }


def rest_of(items: Items, change: Items, who: str) -> dict[str, int]:
    """Subtract items from items; WorldError if there are too few."""
    for name, count in change.items():
        if items.get(name, 0) < count:
            raise WorldError(f"{who} has {items.get(name, 0)} {name}, not {count}")
    rest = {name: count - change.get(name, 0) for name, count in items.items()}
    return {name: count for name, count in rest.items() if count}


def whole_position(position: Position) -> Position:
    """Return a block position of ints; WorldError if the position is invalid."""
    # Most positions are ints: test the type first, because it is cheaper.
    if len(position) != 3 or any(type(p) is not int and p != math.floor(p) for p in position):
        raise WorldError(f"{quoted(position)} is no block position; give three whole numbers")
    x, y, z = (int(p) for p in position)
    return (x, y, z)


def checked_equipment(worn: Mapping[str, str], check: Callable[[Items], object]) -> dict[str, str]:
    """Return a valid mapping from slots to items.

    Raises:
        WorldError: There is no such slot, or `check` refuses an item.
    """
    for slot, item in worn.items():
        if slot not in EQUIPMENT_SLOTS:
            there = ", ".join(EQUIPMENT_SLOTS)
            raise WorldError(f"unknown slot {quoted(slot)}; slots are {there}")
        check({item: 1})
    return dict(worn)
