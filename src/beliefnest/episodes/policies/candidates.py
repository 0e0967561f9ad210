"""What an agent could do next: calls of skills with arguments from what it believes to exist."""

from collections.abc import Iterator, Sequence

from beliefnest.episodes.policies.distance import MindFacts
from beliefnest.nest.acting.imagination import Imagination
from beliefnest.programs.calls import Call
from beliefnest.scenarios.goals import (
    AgentAt,
    AgentsAt,
    BlockIs,
    BlocksAlike,
    Goal,
    ItemsIn,
    ItemsWith,
)
from beliefnest.world.claims import Claim
from beliefnest.world.doors import is_door, is_open
from beliefnest.world.registry import Registry
from beliefnest.world.values import Position

__all__ = ["calls_of", "claims_of_mind", "is_news", "items_of", "said"]


def items_of(goals: Sequence[Goal]) -> list[str]:
    """Items that goals are about, sorted."""
    facts = [condition.fact for goal in goals for condition in goal.conditions]
    return sorted({each.item for each in facts if isinstance(each, ItemsIn | ItemsWith)})


def calls_of(mind: Imagination, agent: str, goals: Sequence[Goal]) -> list[Call]:
    """Deeds that bear on goals, in an order that depends on nothing else; none is an utterance."""
    places = _places(mind, agent, goals)
    return [*_moving_items(mind, agent, goals), *places, *_doors(mind, goals)]


def claims_of_mind(mind: Imagination, goals: Sequence[Goal], *, lies: bool) -> Iterator[Claim]:
    """What could be claimed about things that goals are about.

    Args:
        mind: What the speaker believes.
        goals: Of everybody.
        lies: Whether claims that the speaker does not believe are among them.
    """
    held = sorted(mind.world.containers.items())
    for item in items_of(goals):
        for place, items in held:
            if items.get(item, 0):
                yield Claim.located(item, place)
        if lies:
            for place, items in held:
                if not items.get(item, 0):
                    yield Claim.located(item, place)
    registry, box = Registry.load(), mind.world.box
    for place in _block_places(goals):
        state = int(mind.world.blocks[box.index(place)])
        if not mind.is_unknown(place):
            name, properties = registry.name(state), registry.properties(state)
            if "open" in properties:
                yield Claim.block(place, f"{name}[open={properties['open']}]")


def is_news(mind: Imagination, claim: Claim, speaker: str) -> bool:
    """Whether somebody else is not believed to believe a claim already."""
    registry, box = Registry.load(), mind.world.box
    for other in mind.world.agents:
        if other == speaker or not mind.knows((other,)):
            continue
        view = mind.view((other,))
        if claim.item is not None:
            known = view.containers.get(claim.cell)
            if known is None or not known.items.get(claim.item, 0):
                return True
        elif claim.state is not None:
            state = int(view.blocks[box.index(claim.cell)])
            if state < 0 or f"open={registry.properties(state).get('open')}" not in claim.state:
                return True
    return False


def said(claim: Claim) -> Call:
    """The utterance of a claim."""
    x, y, z = claim.cell
    what = claim.item or claim.agent or claim.state or ""
    return Call("say", (f"{claim.kind.value} {what} {x} {y} {z}", [claim.plain()]))


def _moving_items(mind: Imagination, agent: str, goals: Sequence[Goal]) -> Iterator[Call]:
    world = mind.world
    if agent not in world.agents:
        return
    mine, others = world.agents[agent].inventory, [n for n in sorted(world.agents) if n != agent]
    near = [
        (at, held) for at, held in sorted(world.containers.items()) if mind.may_reach(agent, at)
    ]
    wanted = {c.fact.place for g in goals for c in g.conditions if isinstance(c.fact, ItemsIn)}
    for item in items_of(goals):
        for place, items in near:
            if items.get(item, 0):
                yield Call("getItemFromChest", (place, {item: 1}))
        if not mine.get(item, 0):
            continue
        for place, _ in near:
            # It is of use where it belongs, or where somebody else can take it.
            if place in wanted or any(mind.may_reach(other, place) for other in others):
                yield Call("depositItemIntoChest", (place, {item: 1}))
        for other in others:
            yield Call("giveItemToOther", (other, item, 1))


def _places(mind: Imagination, agent: str, goals: Sequence[Goal]) -> Iterator[Call]:
    facts = MindFacts(mind)
    places: set[Position] = set()
    for fact in (condition.fact for goal in goals for condition in goal.conditions):
        if isinstance(fact, AgentAt) and fact.agent == agent:
            places.add(fact.place)
        elif isinstance(fact, AgentsAt) and agent in fact.agents:
            places |= {place for site in fact.known(facts) for place in site}
    for place in sorted(places):
        yield Call("goToPosition", (place, 0))


def _doors(mind: Imagination, goals: Sequence[Goal]) -> Iterator[Call]:
    registry, box = Registry.load(), mind.world.box
    for place in _block_places(goals):
        state = int(mind.world.blocks[box.index(place)])
        if is_door(registry.name(state)):
            skill = "closeDoor" if is_open(registry, state) else "openDoor"
            yield Call(skill, (place,))


def _block_places(goals: Sequence[Goal]) -> list[Position]:
    places = set()
    for goal in goals:
        for condition in goal.conditions:
            match condition.fact:
                case BlockIs(place=place):
                    places.add(place)
                case BlocksAlike(place=place, model=model):
                    places |= {place, model}
    return sorted(places)
