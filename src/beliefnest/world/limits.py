"""Limits of sizes and distances for outside input, set by Minecraft or by memory.

Each `..._fault` function returns a description of the fault, or None. The caller adds the place
in its input.
"""

import math
import re
from collections.abc import Mapping, Sequence

from beliefnest.errors import InputError
from beliefnest.world.double_chests import StateAt, is_double, states_in
from beliefnest.world.frames import Snapshot
from beliefnest.world.memory import MEGABYTE, memory_limit
from beliefnest.world.registry import Registry
from beliefnest.world.signs import written
from beliefnest.world.terrain import DENSE, VOLUME
from beliefnest.world.texts import quoted
from beliefnest.world.values import (
    EQUIPMENT_SLOTS,
    AgentState,
    Block,
    Box,
    DroppedItem,
    Position,
    Sign,
)

FARTHEST = 30_000_000
"""Greatest absolute coordinate in blocks, as in Minecraft."""

LATEST_TICK = 2_000_000_000
"""Latest tick, after three years of the game; beliefs count ticks in 32 bits."""

LARGEST_NUMBER = 2**53
"""Largest number of a dropped item. JavaScript and Python both represent it exactly."""

GREATEST_MEASURE = 1_000_000.0
"""Greatest absolute value of an angle in radians, of health and of food."""

_LARGEST_COUNT = 2**31 - 1
"""Largest count of an item in a place."""

MOST_AGENTS = 200
"""Most agents: that many were tried, with beliefs about beliefs of all of them."""

AGENT_SLOTS = 36
"""Slots of an inventory, without worn items and the off hand."""

WORN_SLOTS = 5
"""Slots of worn items and the off hand."""

_MOST_BLOCKS = 2**30
"""Most blocks of a box: with its margin, numbers of 32 bits count them."""

_LONGEST_SIDE = 4096
_CHUNK_BYTES = 50
"""Bytes that a nest needs at least for each chunk of its box, equal or not."""
_AGENT_NAME = re.compile(r"[A-Za-z0-9_]{1,16}", re.ASCII)
_FURNACES = frozenset({"furnace", "blast_furnace", "smoker"})
_FURNACE_SLOTS = 3
_CHEST_SLOTS = 27


def agent_name_fault(name: object) -> str | None:
    """Return the fault of an agent name, or None."""
    if not isinstance(name, str) or not _AGENT_NAME.fullmatch(name):
        return f"{quoted(name)} is no agent name; use 1 to 16 letters, digits and _"
    if name == "__proto__":
        return (
            f"{quoted(name)} cannot be the name of an agent: it means something else in JavaScript"
        )
    return None


def agents_fault(count: int) -> str | None:
    """Return the fault of a number of agents, or None."""
    if count <= MOST_AGENTS:
        return None
    return (
        f"there are {count:,} agents; at most {MOST_AGENTS} are possible, because time and memory "
        "grow with the square of their number: each has a belief about each other. Take some out"
    )


def box_fault(box: Box) -> str | None:
    """Return the fault of a box, or None."""
    for corner in (box.low, box.high):
        if fault := point_fault(corner):
            return fault
    sides = [int(side) for side in box.shape]
    if min(sides) < 1:
        return f"the box {box.low} to {box.high} is empty; give its lower corner first"
    volume = math.prod(sides)
    if volume > _MOST_BLOCKS:
        return (
            f"the box holds {volume:,} blocks; at most {_MOST_BLOCKS:,} are possible: "
            "make it smaller"
        )
    if max(sides) > _LONGEST_SIDE:
        return (
            f"the box is {max(sides):,} blocks long; at most {_LONGEST_SIDE:,} are possible: "
            "make it smaller"
        )
    return _memory_fault(volume)


def _memory_fault(volume: int) -> str | None:
    if volume <= DENSE:
        return None
    needed, limit = _CHUNK_BYTES * -(-volume // VOLUME), memory_limit()
    if limit is None or needed <= limit.bytes:
        return None
    return (
        f"the box holds {volume:,} blocks, which need at least {_megabytes(needed):,} MB; this "
        f"process may use {_megabytes(limit.bytes):,} MB, {limit.source}: make the box smaller"
    )


def _megabytes(size: int) -> int:
    return -(-size // MEGABYTE)


def point_fault(point: Sequence[float]) -> str | None:
    """Return the fault of a point or a block position, or None."""
    if not all(math.isfinite(value) and abs(value) <= FARTHEST for value in point):
        return (
            f"{quoted(tuple(point))} is no position; coordinates go from -{FARTHEST} to {FARTHEST}"
        )
    return None


def container_slots(name: str) -> int:
    """Return the number of slots of a container block; those of a half, for a double chest."""
    return _FURNACE_SLOTS if name in _FURNACES else _CHEST_SLOTS


def slots_at(registry: Registry, state_at: StateAt, place: Position) -> int:
    """Return the number of slots of the container to which the block at a place belongs.

    Args:
        registry: Names and properties of states.
        state_at: Function that returns the block state at a position; an unknown one is a chest.
        place: Position of a container.
    """
    state = state_at(place)
    slots = container_slots(registry.name(state) if state >= 0 else "chest")
    return 2 * slots if is_double(registry, state_at, place) else slots


def items_fault(
    items: Mapping[str, int], registry: Registry, slots: int, holder: str
) -> str | None:
    """Return the fault of the items in an inventory or a container, or None.

    Args:
        items: Known item names to counts.
        registry: Stack sizes of the items.
        slots: Number of slots of the holder.
        holder: Name of the holder for the message.
    """
    needed = 0
    for name, count in items.items():
        if not isinstance(count, int) or isinstance(count, bool) or count < 1:
            return (
                f"the count of {quoted(name)} is {quoted(count)}; it must be a whole number above 0"
            )
        needed += -(-count // registry.item_stack(name))
    if needed > slots:
        return f"the items need {quoted(needed)} slots; {holder} has {slots}"
    return None


def divided(
    items: Mapping[str, int], registry: Registry, slots: int
) -> tuple[dict[str, int], dict[str, int]]:
    """Divide items into those that the first slots hold, filled in order, and the rest."""
    first: dict[str, int] = {}
    rest: dict[str, int] = {}
    for name, count in items.items():
        stack = registry.item_stack(name)
        fits = min(count, slots * stack)
        slots -= -(-fits // stack)
        first |= {name: fits} if fits else {}
        rest |= {name: count - fits} if count > fits else {}
    return first, rest


def tick_fault(tick: int) -> str | None:
    """Return the fault of a tick, or None."""
    if 0 <= tick <= LATEST_TICK:
        return None
    return f"tick {quoted(tick)} is out of range; ticks go from 0 to {LATEST_TICK}"


def block_fault(block: Block, registry: Registry) -> str | None:
    """Return the fault of a block, -1 for unknown, or of a sign with its text; or None."""
    low, state = (0, block.state) if isinstance(block, Sign) else (-1, block)
    if low <= state < registry.states:
        return None
    return f"block state {quoted(state)} is not one of {low} to {registry.states - 1}"


def held_fault(items: Mapping[str, int], registry: Registry) -> str | None:
    """Return the fault of items that somebody reported, whatever slots they need, or None."""
    for name, count in items.items():
        if not registry.has_item(name):
            return f"there is no item {quoted(name)}"
        if not 0 < count <= _LARGEST_COUNT:
            return f"the count of {quoted(name)} is {quoted(count)}"
    return None


def agent_fault(agent: AgentState, registry: Registry) -> str | None:
    """Return the fault of the pose and the possessions of an agent, or None."""
    x, y, z = agent.position
    if not (abs(x) <= FARTHEST and abs(y) <= FARTHEST and abs(z) <= FARTHEST):
        return point_fault(agent.position)
    most = GREATEST_MEASURE
    # A comparison with NaN is false.
    if not (
        abs(agent.yaw) <= most
        and abs(agent.pitch) <= most
        and abs(agent.health) <= most
        and abs(agent.food) <= most
    ):
        numbers = (agent.yaw, agent.pitch, agent.health, agent.food)
        return f"yaw, pitch, health and food are {numbers}; they go up to {most:.0f}"
    if agent.inventory and (fault := held_fault(agent.inventory, registry)):
        return fault
    for slot, name in agent.equipment.items():
        if slot not in EQUIPMENT_SLOTS:
            return f"there is no slot {quoted(slot)}; slots are {', '.join(EQUIPMENT_SLOTS)}"
        if not registry.has_item(name):
            return f"there is no item {quoted(name)}"
    return None


def dropped_fault(number: int, item: DroppedItem | None, registry: Registry) -> str | None:
    """Return the fault of a dropped item and of its number, or None."""
    if not 0 <= number <= LARGEST_NUMBER:
        return f"item number {quoted(number)} is out of range; they go from 0 to {LARGEST_NUMBER}"
    if item is None:
        return None
    return held_fault({item.name: item.count}, registry) or point_fault(item.position)


def snapshot_fault(snapshot: Snapshot, registry: Registry) -> str | None:
    """Return the first fault of a snapshot, or None."""
    faults = [
        box_fault(snapshot.box),
        tick_fault(snapshot.tick),
        agents_fault(len(snapshot.agents)),
    ]
    if snapshot.blocks.shape != snapshot.box.shape:
        faults.append(f"blocks of shape {snapshot.blocks.shape} do not fill {snapshot.box.shape}")
    elif not (snapshot.blocks.span[0] >= -1 and snapshot.blocks.span[1] < registry.states):
        faults.append(f"a block has a state that is not from -1 to {registry.states - 1}")
    for name, agent in snapshot.agents.items():
        faults.append(agent_name_fault(name))
        if fault := agent_fault(agent, registry):
            faults.append(f"agent {name}: {fault}")
        faults.append(
            items_fault(agent.inventory, registry, AGENT_SLOTS + WORN_SLOTS, f"agent {name}")
        )
    for number, item in snapshot.items.items():
        faults.append(dropped_fault(number, item, registry))
    for place, text in snapshot.signs.items():
        faults.append(_sign_fault(snapshot, place, text, registry))
    state_at = states_in(snapshot.box, snapshot.blocks, registry.air)
    for place, items in snapshot.containers.items():
        if place not in snapshot.box:
            faults.append(f"the container at {place} lies outside the box")
        else:
            state = snapshot.blocks[snapshot.box.index(place)]
            name = registry.name(state) if state >= 0 else "chest"
            slots = slots_at(registry, state_at, place)
            faults.append(items_fault(items, registry, slots, f"the {name} at {place}"))
    return next((fault for fault in faults if fault), None)


def _sign_fault(snapshot: Snapshot, place: Position, text: str, registry: Registry) -> str | None:
    if place not in snapshot.box:
        return f"the sign at {place} lies outside the box"
    try:
        written(registry, snapshot.blocks[snapshot.box.index(place)], text)
    except InputError as fault:
        return f"the sign at {place}: {fault}"
    return None
