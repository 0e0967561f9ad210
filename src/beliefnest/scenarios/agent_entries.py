"""Agents of a scenario: their states from a file's entries, and checks of their places."""

import math
from itertools import combinations

from beliefnest.scenarios.checks import check_items
from beliefnest.scenarios.document import Document
from beliefnest.scenarios.format import AgentEntry, ScenarioFile
from beliefnest.world.limits import AGENT_SLOTS, agent_name_fault, agents_fault
from beliefnest.world.registry import Registry
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import EQUIPMENT_SLOTS, EYE_HEIGHT, AgentState, Box, Point, block_at

_WIDTH = 0.6
_HEIGHT = 1.8
_SLACK = 1e-6
_YAWS = {"north": 0.0, "west": math.pi / 2, "south": math.pi, "east": -math.pi / 2}
_Bounds = tuple[Point, Point]


def build_agents(
    document: Document, file: ScenarioFile, blocks: Terrain, box: Box, registry: Registry
) -> dict[str, AgentState]:
    """Return the agents by name, each at a free place of its own inside the box."""
    agents: dict[str, AgentState] = {}
    if fault := agents_fault(len(file.agents)):
        raise document.fault(("agents",), fault)
    for name, entry in file.agents.items():
        path = ("agents", name)
        if fault := agent_name_fault(name):
            raise document.fault(path, fault)
        agents[name] = _agent(document, name, entry, registry)
        _check_place(document, name, agents[name].position, blocks, box, registry)
    for first, second in combinations(agents, 2):
        if _overlap(_body(agents[first].position), _body(agents[second].position)):
            raise document.fault(
                ("agents", second, "position"),
                f"{list(agents[second].position)} is where {first} stands already",
            )
    return agents


def _agent(document: Document, name: str, entry: AgentEntry, registry: Registry) -> AgentState:
    path = ("agents", name)
    if not all(math.isfinite(value) for value in entry.position):
        raise document.fault((*path, "position"), "must be three finite numbers")
    slots = ((slot, getattr(entry.equipment, slot)) for slot in EQUIPMENT_SLOTS)
    equipment: dict[str, str] = {slot: item for slot, item in slots if item is not None}
    for slot, item in equipment.items():
        check_items(document, (*path, "equipment", slot), {item: 1}, registry, 1, "a slot")
    worn = list(equipment.values())
    room = AGENT_SLOTS + sum(slot != "main_hand" for slot in equipment)
    check_items(document, (*path, "inventory"), entry.inventory, registry, room, "an agent")
    inventory = dict(entry.inventory)
    for item in worn:
        inventory[item] = max(inventory.get(item, 0), worn.count(item))
    yaw, pitch = _gaze(document, name, entry)
    return AgentState(
        position=entry.position,
        yaw=yaw,
        pitch=pitch,
        equipment=equipment,
        inventory=inventory,
        health=entry.health,
        food=entry.food,
    )


def _gaze(document: Document, name: str, entry: AgentEntry) -> tuple[float, float]:
    """Return the yaw and pitch in radians."""
    if entry.facing is None:
        return entry.yaw or 0.0, entry.pitch or 0.0
    if entry.yaw is not None or entry.pitch is not None:
        raise document.fault(("agents", name), "give either 'facing', or 'yaw' and 'pitch'")
    if isinstance(entry.facing, str):
        return _YAWS[entry.facing], 0.0
    x, y, z = (to - at for to, at in zip(entry.facing, entry.position, strict=True))
    return math.atan2(-x, -z), math.atan2(y - EYE_HEIGHT, math.hypot(x, z))


def _body(feet: Point) -> _Bounds:
    x, y, z = feet
    half = _WIDTH / 2
    return (x - half, y, z - half), (x + half, y + _HEIGHT, z + half)


def _overlap(first: _Bounds, second: _Bounds) -> bool:
    return all(
        low < other_high - _SLACK and other_low < high - _SLACK
        for low, high, other_low, other_high in zip(*first, *second, strict=True)
    )


def _check_place(
    document: Document, name: str, feet: Point, blocks: Terrain, box: Box, registry: Registry
) -> None:
    path = ("agents", name, "position")
    body = _body(feet)
    low, high = (tuple(math.floor(value) for value in corner) for corner in body)
    if block_at(feet) not in box:
        raise document.fault(
            path, f"{list(feet)} lies outside the box {list(box.low)} to {list(box.high)}"
        )
    # The shape of a block, such as a fence, may reach into the block above.
    around = Box((low[0], low[1] - 1, low[2]), (high[0], high[1], high[2]))
    for position in around.positions():
        if position not in box:
            continue
        state = blocks[box.index(position)]
        for x0, y0, z0, x1, y1, z1 in registry.boxes(state):
            shape = (
                (position[0] + x0, position[1] + y0, position[2] + z0),
                (position[0] + x1, position[1] + y1, position[2] + z1),
            )
            if _overlap(body, shape):
                raise document.fault(
                    path, f"{list(feet)} is inside the {registry.name(state)} at {list(position)}"
                )
