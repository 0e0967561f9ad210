"""Goals and rules of play: their form in scenario and task files, and their meaning."""

from collections.abc import Collection
from typing import Annotated, Literal

import msgspec

from beliefnest.belief.condition_form import ConditionEntry, check_condition, conditions_of
from beliefnest.errors import InputError
from beliefnest.scenarios.goals import Goal
from beliefnest.world.values import Box

__all__ = [
    "EpisodeEntry",
    "GoalEntry",
    "check_rules",
    "goal_of",
]


def _note(text: str) -> msgspec.Meta:
    return msgspec.Meta(description=text)


class _Entry(msgspec.Struct, frozen=True, forbid_unknown_fields=True, omit_defaults=True):
    """Base of all parts; unknown keys are errors."""


class GoalEntry(_Entry, frozen=True):
    """A goal of an agent or of a task."""

    reach: Annotated[list[ConditionEntry], _note("Must hold, all at the same tick.")] = []
    never: Annotated[list[ConditionEntry], _note("Must not hold at any tick until then.")] = []
    messages: Annotated[
        Annotated[int, msgspec.Meta(ge=0)] | None, _note("Most utterances of all players.")
    ] = None
    ticks: Annotated[
        Annotated[int, msgspec.Meta(ge=1)] | None,
        _note("Most ticks from the first round until all of `reach` holds."),
    ] = None


class EpisodeEntry(_Entry, frozen=True, kw_only=True):
    """Goals of agents, and the rules of play."""

    goal: Annotated[GoalEntry, _note("Goal of the players; it decides about success.")] = (
        GoalEntry()
    )
    goals: Annotated[dict[str, GoalEntry], _note("Goals of agents that have other goals.")] = {}
    order: Annotated[int, msgspec.Meta(ge=0, description="Order of Theory of Mind it needs.")] = 0
    players: Annotated[
        list[str],
        _note("Agents whose policies are tested; empty: all agents not in `policies`."),
    ] = []
    policies: Annotated[dict[str, str], _note("Policies of agents that are no players.")] = {}
    talk: Annotated[list[str], _note("Agents that may speak.")] = []
    play: Annotated[
        Literal["together", "turns"], _note("Whether programs of a round run together or in turn.")
    ] = "together"
    rounds: Annotated[int, msgspec.Meta(ge=1, description="Greatest number of rounds.")] = 10
    round_ticks: Annotated[
        int, msgspec.Meta(ge=1, le=12_000, description="Ticks after which programs are cut.")
    ] = 20


def goal_of(entry: GoalEntry, agents: Collection[str]) -> Goal:
    """Return the goal of an entry.

    Raises:
        InputError: A condition is not valid.
    """
    if entry.ticks is not None and not entry.reach:
        raise InputError("a goal has `ticks` and nothing to `reach` within them")
    return Goal(
        tuple(each for one in entry.reach for each in conditions_of(one, agents)),
        tuple(each for one in entry.never for each in conditions_of(one, agents)),
        entry.messages,
        entry.ticks,
    )


def check_rules(entry: EpisodeEntry, agents: Collection[str], box: Box) -> None:
    """Check goals and rules of play.

    Raises:
        InputError: They are not consistent.
        PathError: The belief of a condition does not exist.
        UnknownNameError: The item or block of a condition does not exist.
    """
    for name in sorted({*entry.players, *entry.goals, *entry.policies, *entry.talk}):
        if name not in agents:
            raise InputError(f"{name!r} is none of the agents {', '.join(sorted(agents))}")
    for goal in (entry.goal, *entry.goals.values()):
        goal_of(goal, agents)
        for condition in (*goal.reach, *goal.never):
            check_condition(condition, agents, box)
    for name in sorted(agents):
        if entry.players and (name in entry.players) == (name in entry.policies):
            raise InputError(f"{name} must be one of `players` or have a policy in `policies`")
