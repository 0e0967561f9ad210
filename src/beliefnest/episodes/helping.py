"""Help: who needed it, who got it, what was said or given for nothing.

By what would have been, on branches on which somebody is idle and the others act as they then
would. An agent *needed* help if it does not reach its goal where the other players do nothing, as
in the comparison with a person alone of Puig and others (2021), Watch-And-Help. Something said or
given was *superfluous* if nobody reaches a goal later or not at all without it (but-for test of
causes; Grice 1975, "not more informative than is required"). Where two say the same, each of it is
superfluous, as with every but-for test.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol, Self

from beliefnest.episodes.decided import Decision, Part
from beliefnest.episodes.task import Task
from beliefnest.episodes.view import GO_ON, AgentView, Policy
from beliefnest.nest.face.nest import Nest
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
        worse: Who would have reached its goal later, or not at all, without it.
    """

    agent: str
    first: int
    last: int
    worse: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Help:
    """Help in an episode.

    Attributes:
        needed: Agents who would not have reached their goals had the other players done nothing.
        given: Those of them who reached them.
        acts: What players said or gave, and who would be worse off without it.
    """

    needed: tuple[str, ...]
    given: tuple[str, ...]
    acts: tuple[Act, ...]

    @property
    def superfluous(self) -> tuple[Act, ...]:
        """What nobody would be worse off without."""
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

    def reached_by(self, agent: str) -> float:
        """Ticks after which an agent reached its goal; infinite: it did not."""

    def play(self, rounds: int | None = None) -> Self:
        """Play to the end."""

    def forked(self, round: int, policies: Mapping[str, "str | Policy"]) -> Self:
        """The same from a round on, on a branch of its own, with other policies."""


@dataclass(frozen=True)
class _Without:
    """Does what was decided, but for some rounds.

    Attributes:
        decisions: By round.
        first: The first round that is left out.
        last: The last one.
    """

    decisions: Sequence[Decision]
    first: int
    last: float

    def act(self, view: AgentView) -> str:
        """What was decided for the round, if it is not left out."""
        if self.first <= view.round <= self.last or view.round >= len(self.decisions):
            return ""
        decision = self.decisions[view.round]
        if decision.goes_on:
            return GO_ON if view.last.how == "cut" else ""
        return decision.program


def help_in(episode: Branching, policies: Mapping[str, Policy]) -> Help:
    """Help in an episode that is over.

    Args:
        episode: A copy of it, which gets branches.
        policies: Of all agents; on the branches those who are not left out are asked again.
    """
    task = episode.task
    decided = {
        agent: [part.decisions[agent] for part in episode.parts if agent in part.decisions]
        for agent in task.agents
    }
    idle = {agent: _Without(decided[agent], 0, float("inf")) for agent in task.players}
    needed = []
    for agent in task.agents:
        others = {name: idle[name] for name in task.players if name != agent}
        if not others or not task.goal_of(agent).conditions:
            continue
        alone = episode.forked(0, {**policies, **others}).play()
        if alone.reached_by(agent) == float("inf"):
            needed.append(agent)
    given = [agent for agent in needed if episode.reached_by(agent) < float("inf")]
    acts = [
        _compared(episode, policies, act, decided[agent])
        for agent in task.players
        for act in _acts(episode, agent)
    ]
    return Help(tuple(needed), tuple(given), tuple(acts))


def _compared(
    episode: Branching, policies: Mapping[str, Policy], act: Act, decided: Sequence[Decision]
) -> Act:
    """An act with who would be worse off without it."""
    without = _Without(decided, act.first, act.last)
    branch = episode.forked(act.first, {**policies, act.agent: without}).play()
    worse = [
        name
        for name in episode.task.agents
        if episode.task.goal_of(name).conditions
        and branch.reached_by(name) > episode.reached_by(name)
    ]
    return Act(act.agent, act.first, act.last, tuple(worse))


def _acts(episode: Branching, agent: str) -> list[Act]:
    """Programs of an agent in which it said or gave something."""
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
