"""Conditions: their form in files and in calls, and their meaning."""

from collections.abc import Callable, Collection, Mapping
from functools import partial
from typing import Annotated

import msgspec

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
from beliefnest.errors import InputError
from beliefnest.world.paths import parse_path
from beliefnest.world.registry import Registry
from beliefnest.world.values import Box

__all__ = ["ConditionEntry", "check_condition", "condition_entry", "conditions_of"]

Position = tuple[int, int, int]


def _note(text: str) -> msgspec.Meta:
    return msgspec.Meta(description=text)


class ConditionEntry(msgspec.Struct, frozen=True, forbid_unknown_fields=True, omit_defaults=True):
    """A condition on a container, an agent, agents at levers, or a block."""

    path: Annotated[str, _note("Belief path in which it must hold; / is reality.")] = "/"
    container: Annotated[Position | None, _note("A container that holds `items`.")] = None
    agent: Annotated[str | None, _note("An agent that has `items` or stands `at` a place.")] = None
    items: Annotated[
        dict[str, Annotated[int, msgspec.Meta(ge=1)]] | None,
        _note("Item name to least count; {}: nothing at all."),
    ] = None
    at: Annotated[Position | None, _note("A block position.")] = None
    within: Annotated[float, _note("Greatest distance from `at`, in blocks.")] = 1.0
    block: Annotated[Position | None, _note("A block that has a state.")] = None
    state: Annotated[str | None, _note("name or name[property=value,...].")] = None
    like: Annotated[Position | None, _note("A block that it must equal.")] = None
    agents: Annotated[list[str], _note("Agents that hold levers at once, one each.")] = []
    sites: Annotated[list[list[Position]], _note("Levers of each site; one site is enough.")] = []
    property: Annotated[str, _note("Property to compare with `like`; empty: the state.")] = ""


def condition_entry(given: object, agents: Collection[str], box: Box) -> ConditionEntry:
    """Return a condition that was given as a mapping, checked.

    Raises:
        InputError, PathError, UnknownNameError: As for `check_condition`.
    """
    try:
        entry = msgspec.convert(given, ConditionEntry)
    except msgspec.ValidationError as fault:
        raise InputError(f"the condition {given!r} is malformed: {fault}") from None
    check_condition(entry, agents, box)
    return entry


def check_condition(entry: ConditionEntry, agents: Collection[str], box: Box) -> None:
    """Check that everything that a condition names exists.

    Raises:
        InputError: The condition is not valid, or is about a place outside the box.
        PathError: The belief does not exist.
        UnknownNameError: The item or block does not exist.
    """
    conditions_of(entry, agents)
    registry = Registry.load()
    for name in entry.items or {}:
        registry.item_stack(name)
    if entry.state is not None:
        registry.state_id(entry.state)
    named = (entry.container, entry.at, entry.block, entry.like)
    places = [place for place in named if place is not None]
    for place in (*places, *(lever for site in entry.sites for lever in site)):
        if place not in box:
            raise InputError(
                f"a condition is about {place}, outside the box {box.low} to {box.high}"
            )


def conditions_of(entry: ConditionEntry, agents: Collection[str]) -> list[GoalCondition]:
    """Return the conditions of an entry, one for each fact and belief that it names.

    Raises:
        InputError: The entry is not valid.
        PathError: The belief does not exist.
    """
    path = parse_path(entry.path, agents)
    for name in (*entry.agents, *([] if entry.agent is None else [entry.agent])):
        if name not in agents:
            raise InputError(f"a condition is about {name!r}, who is no agent")
    if any(len(site) != len(entry.agents) for site in entry.sites):
        raise InputError("each site of a condition must have as many levers as there are `agents`")
    facts = _facts(entry)
    if not facts:
        plain = msgspec.to_builtins(entry)
        raise InputError(
            f"the condition {plain} makes no sense; give container and items, agent and items, "
            "agent and at, agents and sites, block and state, or block and like"
        )
    return [GoalCondition(fact, path) for fact in facts]


def _facts(entry: ConditionEntry) -> list[Fact]:
    match entry:
        case ConditionEntry(container=place) if place is not None:
            return _item_facts(entry.items, partial(ItemsIn, place), NothingIn(place))
        case ConditionEntry(agent=agent, at=place) if agent is not None and place is not None:
            return [AgentAt(agent, place, entry.within)]
        case ConditionEntry(agents=[_, *_], sites=[_, *_]):
            sites = tuple(tuple(site) for site in entry.sites)
            return [LeversHeld(tuple(entry.agents), sites)]
        case ConditionEntry(agent=agent) if agent is not None:
            return _item_facts(entry.items, partial(ItemsWith, agent), NothingWith(agent))
    return _block_facts(entry)


def _item_facts(
    items: Mapping[str, int] | None, some: Callable[[str, int], Fact], nothing: Fact
) -> list[Fact]:
    """Return the facts about each item; `nothing` if no item is named, none without `items`."""
    if items is None:
        return []
    return [some(item, count) for item, count in items.items()] or [nothing]


def _block_facts(entry: ConditionEntry) -> list[Fact]:
    if entry.block is None:
        return []
    if entry.state is not None:
        return [BlockIs(entry.block, entry.state)]
    return [] if entry.like is None else [BlocksAlike(entry.block, entry.like, entry.property)]
