"""Distance to a goal: the heuristic by which planners compare imagined states.

Distances have no unit. They count 1 for each act that is still needed at least, plus fractions for
the ways to walk.
"""

import math
from collections.abc import Iterable

from beliefnest.belief.conditions import (
    AgentAt,
    BlockIs,
    BlocksAlike,
    Fact,
    GoalCondition,
    ItemsIn,
    ItemsWith,
    LeversHeld,
    NothingIn,
    NothingWith,
)
from beliefnest.nest.acting.imagination import Imagination
from beliefnest.scenarios.goals import Goal
from beliefnest.world.paths import BeliefPath, normalised
from beliefnest.world.registry import Registry
from beliefnest.world.values import Items, Point, Position

__all__ = ["BeliefFacts", "MindFacts", "distance", "held", "is_visible", "name_of"]

_PER_BLOCK = 0.01
_UNKNOWN = 6.0
_HANDED_OVER = 1.5
"""Cost of handing an item over, if the agent that has it cannot reach where it belongs."""
_FAR = 80.0
_ON_THE_WAY = 0.4


class MindFacts:
    """Facts of an imagination's own reality at its latest tick."""

    def __init__(self, mind: Imagination) -> None:
        self._mind = mind
        self._world = mind.world
        self._agents = mind.world.agents

    def items_in(self, place: Position) -> Items:
        """Return items known to be in a container."""
        return self._world.containers.get(place, {})

    def is_empty(self, place: Position) -> bool:
        """Return True if a container is known to hold nothing."""
        return self._world.containers.get(place) == {}

    def items_of(self, agent: str) -> Items:
        """Return items that an agent is known to have."""
        there = self._agents.get(agent)
        return {} if there is None else there.inventory

    def feet_of(self, agent: str) -> Point | None:
        """Return the position of an agent's feet; None: unknown."""
        there = self._agents.get(agent)
        return None if there is None else there.position

    def block(self, place: Position) -> str | None:
        """Return the block state text."""
        state = int(self._world.blocks[self._world.box.index(place)])
        unknown = state == 0 and self._mind.is_unknown(place)
        return None if unknown else Registry.load().text(state)

    def may_reach(self, agent: str, place: Position) -> bool:
        """Return True if an agent may be able to reach a block."""
        return self._mind.may_reach(agent, place)

    @property
    def containers(self) -> Iterable[Position]:
        """Return the positions of known containers."""
        return self._world.containers

    @property
    def agents(self) -> Iterable[str]:
        """Return the agents whose places are known."""
        return self._agents


class BeliefFacts:
    """Facts of a belief in an imagination at its latest tick.

    Args:
        mind: The imagination.
        path: Path of the belief below the root of the imagination.
    """

    def __init__(self, mind: Imagination, path: BeliefPath) -> None:
        self._mind = mind
        self._view = mind.view(path)

    def items_in(self, place: Position) -> Items:
        """Return items known to be in a container."""
        known = self._view.containers.get(place)
        return {} if known is None else known.items

    def is_empty(self, place: Position) -> bool:
        """Return True if a container is known to hold nothing."""
        known = self._view.containers.get(place)
        return known is not None and known.complete and not known.items

    def items_of(self, agent: str) -> Items:
        """Return items that an agent is known to have."""
        return self._view.agents[agent].inventory

    def feet_of(self, agent: str) -> Point | None:
        """Return the position of an agent's feet; None: unknown."""
        return self._view.agents[agent].position

    def block(self, place: Position) -> str | None:
        """Return the block state text."""
        state = int(self._view.blocks[self._mind.world.box.index(place)])
        return None if state < 0 else Registry.load().text(state)


def is_visible(condition: GoalCondition, mind: Imagination) -> bool:
    """Return True if a mind is deep enough to evaluate a condition."""
    return mind.knows(condition.path)


def held(condition: GoalCondition, mind: Imagination) -> bool:
    """Return True if a condition that is visible holds in a mind."""
    if normalised((*mind.root, *condition.path)) == mind.root:
        return condition.fact.holds(MindFacts(mind))
    return condition.fact.holds(BeliefFacts(mind, condition.path))


def distance(goal: Goal, mind: Imagination) -> float:
    """Return the distance to a goal in a mind; 0: reached, as far as the mind can tell."""
    facts = MindFacts(mind)
    return sum(_off(each, mind, facts) for each in goal.reach)


def _off(condition: GoalCondition, mind: Imagination, facts: MindFacts) -> float:
    if condition.path:
        # A mind that is not deep enough cannot tell: count the condition as open in any case.
        return 0.0 if is_visible(condition, mind) and held(condition, mind) else 1.0
    return 0.0 if condition.fact.holds(facts) else _still_to_do(condition.fact, facts)


def _still_to_do(fact: Fact, facts: MindFacts) -> float:
    match fact:
        case ItemsWith(agent=agent, item=item):
            return _to_agent(facts, agent, item)
        case ItemsIn(place=place, item=item, count=count):
            missing = count - facts.items_in(place).get(item, 0)
            return missing * _to_container(facts, place, item)
        case NothingIn() | NothingWith():
            if isinstance(fact, NothingIn):
                held = facts.items_in(fact.place)
            else:
                held = facts.items_of(fact.agent)
            return float(max(1, sum(held.values())))
        case AgentAt(agent=agent):
            feet = facts.feet_of(agent)
            return 1.0 + (_FAR if feet is None else fact.distance(feet)) * _PER_BLOCK
        case LeversHeld():
            left = [fact.missing(facts, site) for site in fact.known(facts)]
            off = [deeds + far * _PER_BLOCK for deeds, far in left]
            return 1.0 + min(off, default=2 * _FAR * _PER_BLOCK)
        case BlocksAlike(place=place) | BlockIs(place=place):
            return _to_block(facts, place, fact.wanted(facts))


def _to_block(facts: MindFacts, place: Position, wanted: str | None) -> float:
    """Return the distance of a block to a wanted state; partial steps count less than the last."""
    if wanted is None:
        return 2.0
    there, name = facts.block(place), name_of(wanted)
    if there is None or name_of(there) == name or not Registry.load().has_item(name):
        return 1.0
    cleared = 0.0 if name_of(there) == "air" else _ON_THE_WAY
    able = [agent for agent in facts.agents if facts.may_reach(agent, place)]
    at_hand = any(facts.items_of(agent).get(name, 0) for agent in able)
    return 1.0 + cleared + (0.0 if at_hand else _ON_THE_WAY)


def name_of(state: str) -> str:
    """Return the name of a block state's block."""
    return state.partition("[")[0]


def _to_agent(facts: MindFacts, agent: str, item: str) -> float:
    feet = facts.feet_of(agent)
    ways = [_UNKNOWN]
    for place in facts.containers:
        if facts.items_in(place).get(item, 0):
            handed = 0.0 if facts.may_reach(agent, place) else _HANDED_OVER
            ways.append(2.0 + handed + _way(feet, place))
    for other in facts.agents:
        if other != agent and facts.items_of(other).get(item, 0):
            ways.append(_HANDED_OVER + _between(facts.feet_of(other), feet))
    return min(ways)


def _to_container(facts: MindFacts, goal: Position, item: str) -> float:
    ways = [_UNKNOWN]
    able = {agent for agent in facts.agents if facts.may_reach(agent, goal)}
    for agent in facts.agents:
        if facts.items_of(agent).get(item, 0):
            handed = 0.0 if agent in able else _HANDED_OVER
            ways.append(1.0 + handed + _way(facts.feet_of(agent), goal))
    middle = (goal[0] + 0.5, float(goal[1]), goal[2] + 0.5)
    for place in facts.containers:
        if place != goal and facts.items_in(place).get(item, 0):
            direct = any(facts.may_reach(agent, place) for agent in able)
            ways.append(2.0 + (0.0 if direct else _HANDED_OVER) + _way(middle, place))
    return min(ways)


def _way(feet: Point | None, place: Position) -> float:
    middle = (place[0] + 0.5, float(place[1]), place[2] + 0.5)
    return _between(feet, middle)


def _between(one: Point | None, other: Point | None) -> float:
    return _PER_BLOCK * (_FAR if one is None or other is None else math.dist(one, other))
