"""Adaptation of believed states to what a body can hold.

A belief may be physically impossible: items in a block that is unknown or no container, or more
items than fit. The belief stays as it is, and its body differs (semantics, section 7). Every
function here is pure, so that a body that is made again from the same belief is the same.
"""

from collections import Counter
from collections.abc import Iterable, Mapping

import numpy as np
from msgspec.structs import replace

from beliefnest.world.double_chests import (
    container_at,
    halves_in,
    holds_items,
    other_half,
    states_in,
    whole_chests,
)
from beliefnest.world.frames import Snapshot
from beliefnest.world.limits import AGENT_SLOTS, container_slots, items_fault, slots_at
from beliefnest.world.registry import Registry
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import EQUIPMENT_SLOTS, HALF_WIDTH, AgentState, Box, Items, Position

CHEST = "chest"
"""Block that a body puts where items are believed to be and no block can hold them."""

_HANDS = ("main_hand", "off_hand")
_WORN = frozenset(EQUIPMENT_SLOTS) - frozenset(_HANDS)


def chest_places(
    registry: Registry, box: Box, blocks: Terrain, contents: Mapping[Position, Items]
) -> list[Position]:
    """Return the positions where a body has a chest and the belief has none.

    These are the positions of contents whose believed block is unknown or cannot hold them, and of
    the unknown other halves of known halves of double chests.

    Args:
        registry: Registry of blocks.
        box: Box of the blocks.
        blocks: Believed block states, -1 unknown.
        contents: Believed items by position.
    """
    lacking = [
        place
        for place, items in contents.items()
        if not _holds(registry, blocks[box.index(place)], items)
    ]
    # A half with contents of its own becomes a single chest, so that it implies no other half.
    halves = [each for each in halves_in(registry, box, blocks) if each[0] not in lacking]
    others = [other_half(registry, state, at) for at, state in halves]
    implied = {each[0] for each in others if each is not None and each[0] in box}
    unknown = sorted(place for place in implied if blocks[box.index(place)] < 0)
    return list(dict.fromkeys([*lacking, *unknown]))


def with_chests(
    registry: Registry, box: Box, blocks: Terrain, contents: Mapping[Position, Items]
) -> Terrain:
    """Return believed blocks, -1 unknown, with chests at the positions of `chest_places`."""
    return with_chests_at(registry, box, blocks, chest_places(registry, box, blocks, contents))


def with_chests_at(
    registry: Registry, box: Box, blocks: Terrain, places: Iterable[Position]
) -> Terrain:
    """Return believed blocks with chests at some positions; the same terrain if there are none.

    A chest becomes the other half of a half that is known, if there is one beside it. Halves
    without another half become single chests.
    """
    put = list(places)
    if put:
        others = [other_half(registry, state, at) for at, state in halves_in(registry, box, blocks)]
        states = dict(each for each in others if each is not None)
        filled = blocks.draft()
        for place in put:
            filled[box.index(place)] = states.get(place, registry.state_id(CHEST))
        blocks = filled.terrain()
    return whole_chests(registry, box, blocks)


def embodiable(registry: Registry, snapshot: Snapshot, blocks: Terrain) -> Snapshot:
    """Return a believed snapshot changed so that a body can be filled with it.

    Items that do not fit into a chest or an inventory are left out, the last names first. An agent
    outside the box is moved inside.

    Args:
        registry: Registry of blocks and items.
        snapshot: The believed state.
        blocks: Its blocks from `with_chests`, -1 unknown.
    """
    state_at = states_in(snapshot.box, blocks, registry.air)
    contents = {
        place: _fitting(registry, items, slots_at(registry, state_at, place))
        for place, items in snapshot.containers.items()
    }
    for place, _ in halves_in(registry, snapshot.box, blocks):
        contents.setdefault(container_at(registry, state_at, place), {})
    return replace(
        snapshot,
        blocks=blocks.mapped(lambda part: np.maximum(part, 0)),
        containers=contents,
        agents={
            name: _laden(registry, _inside(snapshot.box, agent))
            for name, agent in snapshot.agents.items()
        },
        signs={p: text for p, text in snapshot.signs.items() if p not in contents},
    )


def _holds(registry: Registry, state: int, items: Items) -> bool:
    if state < 0:
        return False
    if not holds_items(registry, state):
        return False
    name = registry.name(state)
    # A chest holds no more than another chest, so putting one would not help.
    slots = container_slots(name)
    return slots == container_slots(CHEST) or items_fault(items, registry, slots, name) is None


def _fitting(registry: Registry, items: Items, slots: int) -> Items:
    """Return as many of the items as fit into a number of slots, in order of names."""
    if items_fault(items, registry, slots, "") is None:
        return items
    fitting: dict[str, int] = {}
    for name, count in sorted(items.items()):
        stack = registry.item_stack(name)
        fits = min(count, slots * stack)
        if fits > 0:
            fitting[name] = fits
            slots -= -(-fits // stack)
    return fitting


def _inside(box: Box, agent: AgentState) -> AgentState:
    (x0, y0, z0), (x1, y1, z1) = box.low, box.high
    x, y, z = agent.position
    # An agent that stands on the topmost blocks has its feet one block above the box.
    if x0 <= x < x1 + 1 and y0 <= y < y1 + 2 and z0 <= z < z1 + 1:
        return agent
    side = HALF_WIDTH
    place = (
        min(max(x, x0 + side), x1 + 1 - side),
        min(max(y, y0), y1 + 1),
        min(max(z, z0 + side), z1 + 1 - side),
    )
    return replace(agent, position=place)


def _laden(registry: Registry, agent: AgentState) -> AgentState:
    """Return the agent with as many items as it can carry. Its equipment comes first."""
    worn = [name for slot, name in agent.equipment.items() if slot in _WORN]
    carried = _without(agent.inventory, worn)
    off_hand = int("off_hand" in agent.equipment)
    if items_fault(carried, registry, AGENT_SLOTS + off_hand, "") is None:
        return agent
    in_hands = [agent.equipment[slot] for slot in _HANDS if slot in agent.equipment]
    rest = _fitting(registry, _without(carried, in_hands), AGENT_SLOTS - len(in_hands))
    return replace(agent, inventory=dict(Counter(rest) + Counter(worn) + Counter(in_hands)))


def _without(items: Items, others: Iterable[str]) -> dict[str, int]:
    left = Counter(items)
    left.subtract(others)
    return {name: count for name, count in left.items() if count > 0}
