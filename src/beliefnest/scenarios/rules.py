"""Goals and rules of play: their form in scenario and task files, and their meaning."""

from collections.abc import Collection, Iterator
from typing import Annotated, Literal

import msgspec

from beliefnest.facts.kinds import FactEntry
from beliefnest.facts.reading import FactScene, Where, check_entry, conditions_of
from beliefnest.scenarios.goals import Goal
from beliefnest.world.forms import note
from beliefnest.world.texts import quoted


class _Entry(msgspec.Struct, frozen=True, forbid_unknown_fields=True, omit_defaults=True):
    """Base of all parts; unknown keys are errors."""


class GoalEntry(_Entry, frozen=True):
    """A goal of an agent or of a task."""

    reach: Annotated[list[FactEntry], note("Must hold, all at the same tick.")] = []
    never: Annotated[list[FactEntry], note("Must not hold at any tick until then.")] = []
    messages: Annotated[
        Annotated[int, msgspec.Meta(ge=0)] | None, note("Most utterances of all players.")
    ] = None
    ticks: Annotated[
        Annotated[int, msgspec.Meta(ge=1)] | None,
        note("Most ticks from the first round until all of `reach` holds."),
    ] = None
    helps: Annotated[
        str | None, note("Agent whose goal this agent shares; allows no other key.")
    ] = None


class RewardEntry(_Entry, frozen=True):
    """Rewards of an agent that learns in an environment; costs are below 0."""

    reached: Annotated[float, note("When the agent's goal is reached.")] = 1.0
    violated: Annotated[float, note("When it can no longer be reached.")] = 0.0
    each_round: Annotated[float, note("For each round.")] = 0.0
    message: Annotated[float, note("For each utterance of the agent.")] = 0.0


class EpisodeEntry(_Entry, frozen=True, kw_only=True):
    """Goals of agents, and the rules of play."""

    goal: Annotated[GoalEntry, note("Goal of the players; it decides about success.")] = GoalEntry()
    goals: Annotated[dict[str, GoalEntry], note("Goals of agents that have other goals.")] = {}
    goals_known: Annotated[bool, note("True if every agent knows the goals of the others.")] = True
    possible_goals: Annotated[
        dict[str, dict[str, GoalEntry]],
        note("Goals that an agent may have as far as others know, by agent and name."),
    ] = {}
    order: Annotated[int, msgspec.Meta(ge=0, description="Order of Theory of Mind it needs.")] = 0
    players: Annotated[
        list[str], note("Agents whose policies are tested; empty: all agents not in `policies`.")
    ] = []
    policies: Annotated[dict[str, str], note("Policies of agents that are no players.")] = {}
    talk: Annotated[
        list[str] | None,
        note("Agents that may speak; others cannot. Without it only planners keep silent."),
    ] = None
    play: Annotated[
        Literal["together", "turns"], note("Order in which the programs of a round run.")
    ] = "together"
    rewards: Annotated[
        RewardEntry, note("Rewards in environments; other policies do not know them.")
    ] = RewardEntry()
    rounds: Annotated[int, msgspec.Meta(ge=1, description="Greatest number of rounds.")] = 10
    round_ticks: Annotated[
        int, msgspec.Meta(ge=1, le=12_000, description="Ticks after which programs are cut.")
    ] = 20

    @property
    def speakers(self) -> tuple[str, ...]:
        """Agents that `talk` names."""
        return tuple(self.talk or ())


def goal_of(entry: GoalEntry, agents: Collection[str]) -> Goal:
    """Return the goal of an entry.

    Raises:
        InputError: A condition is not valid.
    """
    return Goal(
        tuple(each for one in entry.reach for each in conditions_of(one, agents)),
        tuple(each for one in entry.never for each in conditions_of(one, agents)),
        entry.messages,
        entry.ticks,
        entry.helps,
    )


def _faults_of_help(
    entry: EpisodeEntry, agents: Collection[str]
) -> Iterator[tuple[tuple[str, ...], str]]:
    if entry.goal.helps is not None:
        yield ("goal", "helps"), "helps an agent; say here what agents are to `reach`"
    for name, goal in entry.goals.items():
        if goal.helps is None:
            continue
        where = ("goals", name, "helps")
        helped = entry.goals.get(goal.helps, entry.goal)
        if goal.reach or goal.never or goal.ticks is not None or goal.messages is not None:
            yield where, "stands beside other keys; remove them: the agent has no other goal"
        elif goal.helps not in agents:
            yield where, f"{quoted(goal.helps)} is none of the agents {_listed(agents)}"
        elif goal.helps == name or helped.helps is not None:
            yield where, f"{quoted(goal.helps)} has no goal of its own; name another agent"
        elif not entry.goals_known and goal.helps not in entry.possible_goals:
            yield where, f"the goal of {quoted(goal.helps)} is unknown; give its `possible_goals`"


def _faults_of_possible_goals(
    entry: EpisodeEntry, agents: Collection[str]
) -> Iterator[tuple[tuple[str, ...], str]]:
    if entry.possible_goals and entry.goals_known:
        yield ("possible_goals",), "is of no use; set `goals_known: false`, or leave it out"
    for name, possible in entry.possible_goals.items():
        where = ("possible_goals", name)
        if name not in agents:
            yield where, f"{quoted(name)} is none of the agents {_listed(agents)}"
        elif not possible:
            yield where, "is empty; name at least one goal"
        elif any(goal.helps is not None for goal in possible.values()):
            yield where, "has a goal that helps an agent; say what is to be reached instead"
        elif entry.goals.get(name, entry.goal) not in possible.values():
            yield where, f"lacks the goal that {name} has; write it among the others, word for word"


def _listed(agents: Collection[str]) -> str:
    return ", ".join(sorted(agents))


def _faults_of_rules(
    entry: EpisodeEntry, agents: Collection[str]
) -> Iterator[tuple[tuple[str, ...], str]]:
    """Yield the faults of rules of play: the keys, and a message."""
    yield from _faults_of_help(entry, agents)
    yield from _faults_of_possible_goals(entry, agents)
    for name in sorted({*entry.players, *entry.goals, *entry.policies, *entry.speakers}):
        if name not in agents:
            yield (), f"{quoted(name)} is none of the agents {_listed(agents)}"
        if name in entry.players and name in entry.policies:
            fault = "is one of `players` and has a policy in `policies`; remove one of the two"
            yield (), f"{name} {fault}"


def check_rules(
    entry: EpisodeEntry, agents: Collection[str], scene: FactScene, top: Where = ()
) -> None:
    """Check goals and rules of play; conditions that name half a container get the whole one.

    Args:
        entry: Goals and rules.
        agents: Names of all agents.
        scene: Checks of what the conditions name.
        top: Place of the entry in a document.

    Raises:
        BeliefNestError: They are not consistent, or name something that does not exist.
    """
    goals: dict[Where, GoalEntry] = {("goal",): entry.goal}
    goals |= {("goals", name): goal for name, goal in entry.goals.items()}
    for agent, possible in entry.possible_goals.items():
        goals |= {("possible_goals", agent, name): goal for name, goal in possible.items()}
    for path, goal in goals.items():
        for key, entries in (("reach", goal.reach), ("never", goal.never)):
            for number, condition in enumerate(entries):
                place = (*top, *path, key, number)
                entries[number] = check_entry(condition, place, scene)
        if goal.ticks is not None and not goal.reach:
            fault = "stands in a goal that has nothing to `reach` within them"
            raise scene.fault((*top, *path, "ticks"), fault)
    for path, fault in _faults_of_rules(entry, agents):
        raise scene.fault((*top, *path), fault)
