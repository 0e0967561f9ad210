"""Candidate acts of an agent: calls of skills with arguments that it believes to exist."""

import math
from collections.abc import Iterable, Iterator, Sequence

from beliefnest.episodes.imagination import Imagination
from beliefnest.episodes.policies.distance import MindFacts
from beliefnest.facts.kinds import Fact, agrees
from beliefnest.scenarios.goals import Goal
from beliefnest.skills.calls import Call
from beliefnest.world.claims import Claim
from beliefnest.world.doors import is_door, is_open, is_switch
from beliefnest.world.registry import Registry, block_name, parse_state
from beliefnest.world.values import Position, block_at

_MOST_PARTNERS = 3
"""Number of agents to whom items may be handed in a crowd."""


def items_of(goals: Sequence[Goal]) -> list[str]:
    """Return the items in goals, sorted."""
    return sorted({item for fact in _facts(goals) for item in fact.items})


def cells_of(goals: Sequence[Goal], agents: Sequence[str]) -> set[Position]:
    """Return the cells of blocks in goals, and those in which agents are to stand."""
    sought = [fact.pursuit(name, {}) for fact in _facts(goals) for name in agents]
    return {*_block_places(goals), *(cell for each in sought for cell in each.at)}


def _facts(goals: Sequence[Goal]) -> Iterator[Fact]:
    return (condition.fact for goal in goals for condition in goal.conditions)


def calls_of(mind: Imagination, agent: str, goals: Sequence[Goal]) -> list[Call]:
    """Return calls that are relevant to goals, without utterances, in a deterministic order."""
    places = _places(mind, agent, goals)
    blocks = _building(mind, agent, goals)
    by_hand = [*_moving_items(mind, agent, goals), *places, *blocks, *_doors(mind, goals)]
    return [*by_hand, *(each for each in _switches(mind, agent, goals) if each not in by_hand)]


def claims_of_mind(mind: Imagination, goals: Sequence[Goal], *, lies: bool) -> Iterator[Claim]:
    """Yield possible claims about the things in goals.

    Args:
        mind: Belief of the speaker.
        goals: Goals of all agents.
        lies: True to include claims that the speaker does not believe.
    """
    contents = sorted(mind.world.containers.items())
    for item in items_of(goals):
        for place, items in contents:
            if items.get(item, 0):
                yield Claim.located(item, place)
        if lies:
            for place, items in contents:
                if not items.get(item, 0):
                    yield Claim.located(item, place)
    registry = Registry.load()
    for place in _block_places(goals):
        state = mind.world.state_at(place)
        if not mind.is_unknown(place):
            name, properties = registry.name(state), registry.properties(state)
            if is_door(name):
                yield Claim.block(place, f"{name}[open={properties['open']}]")
            elif name != "air":
                yield Claim.block(place, registry.text(state))


def is_news(
    mind: Imagination, claim: Claim, speaker: str, hearers: Iterable[str] | None = None
) -> bool:
    """Return True if the speaker believes that a hearer does not believe a claim yet.

    Args:
        mind: Belief of the speaker.
        claim: The claim.
        speaker: Name of the speaker.
        hearers: Names of agents; None: all whose places the speaker knows.
    """
    registry, box = Registry.load(), mind.world.box
    for other in mind.world.agents if hearers is None else hearers:
        if other == speaker or not mind.knows((other,)):
            continue
        view = mind.view((other,))
        if claim.item is not None:
            content = view.containers.get(claim.cell)
            if content is None or not content.items.get(claim.item, 0):
                return True
        elif claim.state is not None:
            state = view.terrain[box.index(claim.cell)]
            if state < 0 or not agrees(registry.text(state), claim.state):
                return True
    return False


def said(claim: Claim) -> Call:
    """Return the utterance of a claim."""
    x, y, z = claim.cell
    what = claim.item or claim.agent or claim.state or ""
    return Call("say", (f"{claim.kind.value} {what} {x} {y} {z}", [claim.plain()]))


def _moving_items(mind: Imagination, agent: str, goals: Sequence[Goal]) -> Iterator[Call]:
    world = mind.world
    if agent not in world.agents:
        return
    agents = world.agents
    mine, is_crowd = agents[agent].inventory, len(agents) - 1 > _MOST_PARTNERS
    near = [
        (at, stored) for at, stored in sorted(world.containers.items()) if mind.may_reach(agent, at)
    ]
    wanted = {fact.store for fact in _facts(goals)}
    named, facts = [*items_of(goals), *_materials(mind, agent, goals)], MindFacts(mind)
    removed = {item for fact in _facts(goals) for item in fact.removed(agent, facts)}
    for item in [*named, *sorted(removed - {*named})]:
        for place, items in near:
            if items.get(item, 0):
                yield Call("getItemFromChest", (place, {item: 1}))
        if not mine.get(item, 0):
            continue
        # In a crowd, agents hand over only what they cannot bring themselves where it belongs.
        is_bringing = is_crowd and _brings(mind, agent, item, goals)
        takers = [] if is_bringing else _partners(mind, agent, goals)
        for place, _ in near:
            # Put the item where it belongs, or where another agent can take it.
            if place in wanted or any(mind.may_reach(other, place) for other in takers):
                yield Call("depositItemIntoChest", (place, {item: 1}))
        seen = mind.seen_by(agent) if takers else {}
        for other in takers:
            # Only an agent in sight can be given something; go first to where another one may be.
            if other in seen:
                yield Call("giveItemToOther", (other, item, 1))
            else:
                yield Call("goToPosition", (block_at(agents[other].position), 2))


def _brings(mind: Imagination, agent: str, item: str, goals: Sequence[Goal]) -> bool:
    """Return True if goals want an item only where an agent may bring it, or with that agent."""
    facts = [fact for fact in _facts(goals) if item in fact.items]
    return bool(facts) and all(
        fact.holder == agent if fact.store is None else mind.may_reach(agent, fact.store)
        for fact in facts
    )


def _partners(mind: Imagination, agent: str, goals: Sequence[Goal]) -> list[str]:
    """Return agents to hand items to: all, or of many those named in goals and the nearest."""
    agents = mind.world.agents
    others = [name for name in sorted(agents) if name != agent]
    if len(others) <= _MOST_PARTNERS:
        return others
    named = {fact.holder for fact in _facts(goals)}
    here = agents[agent].position
    others.sort(key=lambda name: (name not in named, math.dist(agents[name].position, here), name))
    return sorted(others[:_MOST_PARTNERS])


def _places(mind: Imagination, agent: str, goals: Sequence[Goal]) -> Iterator[Call]:
    facts = MindFacts(mind)
    for place in sorted({at for fact in _facts(goals) for at in fact.pursuit(agent, {}).at}):
        yield Call("goToPosition", (place, 0))
    for place in sorted({at for fact in _facts(goals) for at in fact.levers(agent, facts)}):
        yield Call("turnOnLever", (place,))


def _sought(mind: Imagination, goals: Sequence[Goal]) -> Iterator[tuple[Position, str | None]]:
    """Yield places of blocks in a wrong state, with the wanted block state; None: unknown."""
    facts = MindFacts(mind)
    for fact in _facts(goals):
        wanted = fact.sought(facts)
        if wanted is None or fact.holds(facts):
            continue
        place = fact.blocks[0]
        if facts.block(place) is not None:
            yield place, block_name(wanted) or None


def _materials(mind: Imagination, agent: str, goals: Sequence[Goal]) -> list[str]:
    """Return blocks that an agent may need; all blocks if it does not know which."""
    world, registry = mind.world, Registry.load()
    sought = {name for _, name in _sought(mind, goals)}
    there = {item for items in world.containers.values() for item in items}
    if agent in world.agents:
        there |= world.agents[agent].inventory.keys()
    blocks = {item for item in there if registry.has_block(item)}
    return sorted(blocks if None in sought else blocks & {n for n in sought if n is not None})


def _building(mind: Imagination, agent: str, goals: Sequence[Goal]) -> Iterator[Call]:
    """Yield calls that put wanted blocks, and that break other blocks in their places."""
    if agent not in mind.world.agents:
        return
    facts, mine = MindFacts(mind), mind.world.agents[agent].inventory
    for place, wanted in sorted(_sought(mind, goals), key=lambda each: each[0]):
        there = facts.block(place)
        if there is None or is_door(block_name(there)) or not mind.may_reach(agent, place):
            continue
        if block_name(there) != "air":
            yield Call("mineBlock", (place, block_name(there)))
        for item in _materials(mind, agent, goals):
            if mine.get(item, 0) and wanted in (None, item) and block_name(there) == "air":
                yield Call("placeItem", (item, place))


def _doors(mind: Imagination, goals: Sequence[Goal]) -> Iterator[Call]:
    registry = Registry.load()
    for place in _block_places(goals):
        state = mind.world.state_at(place)
        if is_door(registry.name(state)):
            skill = "closeDoor" if is_open(registry, state) else "openDoor"
            yield Call(skill, (place,))


def _switches(mind: Imagination, agent: str, goals: Sequence[Goal]) -> Iterator[Call]:
    """Yield calls that give power to doors or to blocks in goals, or take it from them."""
    world, wanted = mind.world, set(_block_places(goals))
    for place in mind.switches:
        if not mind.may_reach(agent, place):
            continue
        moved = mind.moved_by(place)
        if any(is_door(Registry.load().name(state)) for state in moved.values()) or (
            wanted & moved.keys()
        ):
            yield _used(world.block_text(place), place)


def _used(switch: str, place: Position) -> Call:
    """Return the call that uses a lever, button or pressure plate."""
    name, properties = parse_state(switch)
    if name == "lever":
        is_on = properties["powered"] == "true"
        return Call("turnOffLever" if is_on else "turnOnLever", (place,))
    return Call("pressButton", (place,)) if is_switch(name) else Call("goToPosition", (place, 0))


def _block_places(goals: Sequence[Goal]) -> list[Position]:
    return sorted({place for fact in _facts(goals) for place in fact.blocks})
