"""Help: who needed it, who got it, what was said or given for nothing.

Measured by what would have been, on branches on which somebody is idle and the others act as they
then would. Goals are divided among the agents who have them (`shares.py`), since a goal that all
share is reached by nobody if one fails. An agent *needed* help if its share would not have come
true had the other players done nothing, as in the comparison with a person alone of Puig and
others (2021), Watch-And-Help. Something said or given *helped* another if the share of that other
would have come true later or not at all without it (but-for test of causes). It was *superfluous*
if nobody's share would have (Grice 1975, "not more informative than is required"). Where two say
the same, each of it is superfluous, as with every but-for test.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Protocol, Self

from beliefnest.episodes.decided import Decision, Part
from beliefnest.episodes.shares import Share, shares_of
from beliefnest.episodes.task import Task
from beliefnest.episodes.view import GO_ON, AgentView, Policy
from beliefnest.nest.face.nest import Nest
from beliefnest.scenarios.goals import Progress
from beliefnest.world.values import EventKind

__all__ = ["Act", "Help", "help_in"]

_GAVE = EventKind.GIVE_ITEM_TO_OTHER


@dataclass(frozen=True, slots=True)
class Act:
    """A program in which a player said or gave something.

    Attributes:
        agent: Whose.
        first: The round in which it began.
        last: The round in which it ended; a program that was cut may go on.
        worse: Agents whose share of their goals would have come true later, or not at all,
            without it; the agent itself may be among them.
    """

    agent: str
    first: int
    last: int
    worse: tuple[str, ...] = ()

    @property
    def helped(self) -> tuple[str, ...]:
        """The other agents among those who would be worse off without it."""
        return tuple(name for name in self.worse if name != self.agent)


@dataclass(frozen=True, slots=True)
class Help:
    """Help in an episode.

    Attributes:
        needed: Agents whose share of their goals would not have come true had the other players
            done nothing.
        given: Those of them whose share came true.
        acts: What players said or gave, and who would be worse off without it.
    """

    needed: tuple[str, ...]
    given: tuple[str, ...]
    acts: tuple[Act, ...]

    @property
    def superfluous(self) -> tuple[Act, ...]:
        """Return what nobody would be worse off without."""
        return tuple(act for act in self.acts if not act.worse)


class Branching(Protocol):
    """An episode with all that is decided in it, of which there are branches."""

    task: Task

    @property
    def nest(self) -> Nest:
        """Where it is played."""

    @property
    def start(self) -> int:
        """The tick at which the first round began."""

    @property
    def beginnings(self) -> Sequence[int]:
        """The ticks at which rounds began."""

    @property
    def parts(self) -> Sequence[Part]:
        """What was decided and how it ended."""

    @property
    def progress(self) -> Mapping[str, Progress]:
        """How far each agent's goal has come."""

    def play(self, rounds: int | None = None) -> Self:
        """Play to the end."""

    def forked(self, round: int, policies: Mapping[str, "str | Policy"]) -> Self:
        """Return the same from a round on, on a branch of its own, with other policies."""


@dataclass(frozen=True)
class _Without:
    """Policy that does what was decided, but for some rounds.

    Attributes:
        decisions: By round.
        first: The first round that is left out.
        last: The last one.
    """

    decisions: Sequence[Decision]
    first: int
    last: float

    def act(self, view: AgentView) -> str:
        """Return what was decided for the round, if it is not left out."""
        if self.first <= view.round <= self.last or view.round >= len(self.decisions):
            return ""
        decision = self.decisions[view.round]
        if decision.goes_on:
            return GO_ON if view.last.how == "cut" else ""
        return decision.program


def help_in(episode: Branching, policies: Mapping[str, Policy]) -> Help:
    """Measure help in an episode that is over.

    Args:
        episode: A copy of it, which gets branches.
        policies: Of all agents; on the branches those who are not left out are asked again.
    """
    task = episode.task
    shares = shares_of(episode.progress, episode.nest["/"].state.events)
    done = _done(episode, shares)
    decided = {
        agent: [part.decisions[agent] for part in episode.parts if agent in part.decisions]
        for agent in task.agents
    }
    idle = {agent: _Without(decided[agent], 0, float("inf")) for agent in task.players}
    needed = []
    for agent in task.agents:
        others = {name: idle[name] for name in task.players if name != agent}
        if others:
            alone = episode.forked(0, {**policies, **others}).play()
            if _done(alone, shares)[agent] == float("inf"):
                needed.append(agent)
    given = [agent for agent in needed if done[agent] < float("inf")]
    acts = []
    for act in [act for agent in task.players for act in _acts(episode, agent)]:
        without = _Without(decided[act.agent], act.first, act.last)
        branch = episode.forked(act.first, {**policies, act.agent: without}).play()
        there = _done(branch, shares)
        acts.append(replace(act, worse=tuple(a for a in task.agents if there[a] > done[a])))
    return Help(tuple(needed), tuple(given), tuple(acts))


def _done(episode: Branching, shares: Mapping[str, Share]) -> dict[str, float]:
    """Return the tick by which each agent's share had come true; infinite: it never had."""
    progress = episode.progress
    return {agent: share.done_at(progress[agent]) for agent, share in shares.items()}


def _acts(episode: Branching, agent: str) -> list[Act]:
    """Return the programs of an agent in which it said or gave something."""
    state = episode.nest["/"].state
    gave = {e.tick for e in state.events if (e.actor, e.kind) == (agent, _GAVE)}
    said = {tick for tick, speaker, _ in state.chat if speaker == agent} | gave
    own = [part for part in episode.parts if agent in part.decisions]
    ends = [*episode.beginnings[1:], episode.nest.tick]
    found: list[Act] = []
    first = 0
    for number, part in enumerate(own):
        first = first if part.decisions[agent].goes_on else number
        if any(episode.beginnings[number] < tick <= ends[number] for tick in said):
            if found and found[-1].first == first:
                found.pop()
            found.append(Act(agent, first, number))
    return found
