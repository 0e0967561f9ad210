"""The form of a task: what may be written where, in a file or by a generator."""

from collections.abc import Mapping
from typing import Annotated, Any, Literal

import msgspec

from beliefnest.episodes.goals import (
    AgentAt,
    BlockIs,
    BlocksAlike,
    Condition,
    Fact,
    Goal,
    ItemsIn,
    ItemsWith,
)
from beliefnest.errors import ScenarioError
from beliefnest.world.paths import parse_path

__all__ = ["ConditionEntry", "GoalEntry", "TaskForm", "goal_of"]

Position = tuple[int, int, int]


def _note(text: str) -> msgspec.Meta:
    return msgspec.Meta(description=text)


class _Entry(msgspec.Struct, frozen=True, forbid_unknown_fields=True, omit_defaults=True):
    """Base of all parts: a key that is not listed is an error."""


class ConditionEntry(_Entry, frozen=True):
    """A condition: `container` or `agent` with `items`, `agent` with `at`, or `block`."""

    path: Annotated[str, _note("Where it is to be the case; / is reality.")] = "/"
    container: Annotated[Position | None, _note("A container that holds `items`.")] = None
    agent: Annotated[str | None, _note("An agent that has `items` or stands `at` a place.")] = None
    items: Annotated[dict[str, int], _note("Item name to least count.")] = {}
    at: Annotated[Position | None, _note("A block position.")] = None
    within: Annotated[float, _note("Greatest distance from there, in blocks.")] = 1.0
    block: Annotated[Position | None, _note("A block that is in a state.")] = None
    state: Annotated[str | None, _note("name or name[property=value,...].")] = None
    like: Annotated[Position | None, _note("A block that it is to be like.")] = None
    property: Annotated[str, _note("The property in which these are to agree.")] = "open"


class GoalEntry(_Entry, frozen=True):
    """What somebody is after."""

    reach: Annotated[list[ConditionEntry], _note("True at one and the same tick.")] = []
    never: Annotated[list[ConditionEntry], _note("True at no tick until then.")] = []
    messages: Annotated[int | None, _note("Most utterances of all players.")] = None


class TaskForm(_Entry, frozen=True):
    """A task: a scenario, what its agents are after, and the rules of play."""

    name: Annotated[str, _note("Short name, for tables and folders.")]
    scenario: Annotated[dict[str, Any], _note("As in a scenario file.")]
    goal: Annotated[GoalEntry, _note("What makes the episode a success; the players' goal.")]
    order: Annotated[int, msgspec.Meta(ge=0, description="Order of Theory of Mind it needs.")] = 0
    description: Annotated[str, _note("What it is about, for people and models.")] = ""
    players: Annotated[list[str], _note("Whose policies are put to the test; empty: all.")] = []
    goals: Annotated[dict[str, GoalEntry], _note("Of agents who are after something else.")] = {}
    policies: Annotated[dict[str, str], _note("Policies of agents who are no players.")] = {}
    talk: Annotated[list[str], _note("Who may speak.")] = []
    play: Annotated[Literal["together", "turns"], _note("How programs of a round run.")] = (
        "together"
    )
    rounds: Annotated[int, msgspec.Meta(ge=1, description="Rounds until it is over.")] = 10
    round_ticks: Annotated[
        int, msgspec.Meta(ge=1, le=12_000, description="Ticks after which programs are cut.")
    ] = 20


def goal_of(entry: GoalEntry, agents: Mapping[str, Any]) -> Goal:
    """The goal that an entry describes.

    Raises:
        ScenarioError: A condition makes no sense.
    """
    return Goal(
        tuple(each for one in entry.reach for each in _conditions(one, agents)),
        tuple(each for one in entry.never for each in _conditions(one, agents)),
        entry.messages,
    )


def _conditions(entry: ConditionEntry, agents: Mapping[str, Any]) -> list[Condition]:
    path = parse_path(entry.path, agents)
    if entry.agent is not None and entry.agent not in agents:
        raise ScenarioError(f"a condition is about {entry.agent!r}, who is no agent")
    facts = _facts(entry)
    if not facts:
        plain = msgspec.to_builtins(entry)
        raise ScenarioError(
            f"the condition {plain} makes no sense; give container and items, agent and items, "
            "agent and at, block and state, or block and like"
        )
    return [Condition(fact, path) for fact in facts]


def _facts(entry: ConditionEntry) -> list[Fact]:
    match entry:
        case ConditionEntry(container=place) if place is not None:
            return [ItemsIn(place, item, count) for item, count in entry.items.items()]
        case ConditionEntry(agent=agent, at=place) if agent is not None and place is not None:
            return [AgentAt(agent, place, entry.within)]
        case ConditionEntry(agent=agent) if agent is not None:
            return [ItemsWith(agent, item, count) for item, count in entry.items.items()]
        case ConditionEntry(block=place, state=state) if place is not None and state is not None:
            return [BlockIs(place, state)]
        case ConditionEntry(block=place, like=model) if place is not None and model is not None:
            return [BlocksAlike(place, model, entry.property)]
    return []
