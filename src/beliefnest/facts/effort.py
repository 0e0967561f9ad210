"""Effort to bring something about: the heuristic by which planners compare imagined states.

Efforts have no unit. They count 1 for each act that is still needed at least, plus fractions for
the ways to walk.
"""

import math

from beliefnest.facts.states import PlanFacts
from beliefnest.world.registry import Registry, block_name
from beliefnest.world.values import Point, Position, feet_in

PER_BLOCK = 0.01
"""Effort of a block of the way."""
FAR = 80.0
"""Length in blocks of a way to or from an unknown place."""
_UNKNOWN = 6.0
_HANDED_OVER = 1.5
"""Effort of handing an item over, if the agent that has it cannot reach where it belongs."""
_ON_THE_WAY = 0.4


def to_block(facts: PlanFacts, place: Position, wanted: str | None) -> float:
    """Return the effort to give a block a state; partial steps count less than the last."""
    if wanted is None:
        return 2.0
    there, name = facts.block(place), block_name(wanted)
    if there is None or block_name(there) == name or not Registry.load().has_item(name):
        return 1.0
    cleared = 0.0 if block_name(there) == "air" else _ON_THE_WAY
    able = [agent for agent in facts.agents if facts.may_reach(agent, place)]
    at_hand = any(facts.items_of(agent).get(name, 0) for agent in able)
    return 1.0 + cleared + (0.0 if at_hand else _ON_THE_WAY)


def to_agent(facts: PlanFacts, agent: str, item: str) -> float:
    """Return the effort to give an agent an item."""
    feet = facts.feet_of(agent)
    ways = [_UNKNOWN]
    for place in facts.containers:
        if facts.items_in(place).get(item, 0):
            handed = 0.0 if facts.may_reach(agent, place) else _HANDED_OVER
            ways.append(2.0 + handed + walk(feet, feet_in(place)))
    for other in facts.agents:
        if other != agent and facts.items_of(other).get(item, 0):
            ways.append(_HANDED_OVER + walk(facts.feet_of(other), feet))
    return min(ways)


def to_container(facts: PlanFacts, goal: Position, item: str) -> float:
    """Return the effort to put one more of an item into a container."""
    ways = [_UNKNOWN]
    able = {agent for agent in facts.agents if facts.may_reach(agent, goal)}
    for agent in facts.agents:
        if facts.items_of(agent).get(item, 0):
            handed = 0.0 if agent in able else _HANDED_OVER
            ways.append(1.0 + handed + walk(facts.feet_of(agent), feet_in(goal)))
    for place in facts.containers:
        if place != goal and facts.items_in(place).get(item, 0):
            direct = any(facts.may_reach(agent, place) for agent in able)
            way = walk(feet_in(goal), feet_in(place))
            ways.append(2.0 + (0.0 if direct else _HANDED_OVER) + way)
    return min(ways)


def walk(one: Point | None, other: Point | None) -> float:
    """Return the effort of the way between two points; None: an unknown one."""
    return PER_BLOCK * (FAR if one is None or other is None else math.dist(one, other))
