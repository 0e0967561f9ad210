"""Help in an episode: needed, given and superfluous.

Help is measured counterfactually, on branches of the episode on which an agent is idle and the
other agents react to that. Goals are divided among the agents that have them (`shares.py`), since
a common goal is reached by no agent if one agent fails.

An agent *needed* help if its share does not come true on a branch where the other players do
nothing, as in the comparison with a single person by Puig and others (2021), Watch-And-Help. An
utterance or gift *helped* another agent if the other agent's share would have come true later or
not at all without it (but-for test of causes). It was *superfluous* if this holds for no agent
(Grice 1975, "not more informative than is required"). If two agents say the same, both utterances
are superfluous, as in every but-for test.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import msgspec
from msgspec.structs import replace

from beliefnest.episodes.agent_view import GO_ON, AgentView, Policy
from beliefnest.episodes.decided import Decision
from beliefnest.episodes.shares import Share, shares_of
from beliefnest.world.event_kinds import EventKind

if TYPE_CHECKING:
    from beliefnest.episodes.episode import Episode

_GAVE = EventKind.GIVE_ITEM_TO_OTHER


class HelpingAct(msgspec.Struct, frozen=True):
    """Program in which a player said or gave something.

    Attributes:
        agent: Name of the player.
        first: Round in which the program began.
        last: Round in which it ended; a program that was cut may go on in later rounds.
        worse: Agents whose share would have come true later, or not at all, without it; may
            include the player itself.
    """

    agent: str
    first: int
    last: int
    worse: tuple[str, ...] = ()

    @property
    def helped(self) -> tuple[str, ...]:
        """Return the other agents that would be worse off without it."""
        return tuple(name for name in self.worse if name != self.agent)


@dataclass(frozen=True, slots=True)
class Help:
    """Help in an episode.

    Attributes:
        needed: Agents whose share of their goals would not have come true if the other players
            had done nothing.
        given: Agents in `needed` whose share came true.
        acts: Programs in which players said or gave something.
    """

    needed: tuple[str, ...]
    given: tuple[str, ...]
    acts: tuple[HelpingAct, ...]

    @property
    def superfluous(self) -> tuple[HelpingAct, ...]:
        """Return the acts without which no agent would be worse off."""
        return tuple(act for act in self.acts if not act.worse)


class _Without(msgspec.Struct, frozen=True):
    """Policy that repeats earlier decisions, except in some rounds.

    Attributes:
        decisions: Decisions by round.
        first: First round that is left out.
        last: Last round that is left out.
    """

    decisions: Sequence[Decision]
    first: int
    last: float

    def act(self, view: AgentView) -> str:
        """Return the decision of the round, or nothing if the round is left out."""
        if self.first <= view.round <= self.last or view.round >= len(self.decisions):
            return ""
        decision = self.decisions[view.round]
        if decision.goes_on:
            return GO_ON if view.last.how == "cut" else ""
        return decision.program


def help_in(episode: "Episode", policies: Mapping[str, Policy]) -> Help:
    """Measure help in an episode that has ended.

    Args:
        episode: Copy of the episode; branches are added to it.
        policies: Policies of all agents; on branches, policies of active agents are asked again.
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
    helpers = [agent for agent in needed if done[agent] < float("inf")]
    acts = []
    for act in [act for agent in task.players for act in _acts(episode, agent)]:
        without = _Without(decided[act.agent], act.first, act.last)
        branch = episode.forked(act.first, {**policies, act.agent: without}).play()
        there = _done(branch, shares)
        acts.append(replace(act, worse=tuple(a for a in task.agents if there[a] > done[a])))
    return Help(tuple(needed), tuple(helpers), tuple(acts))


def _done(episode: "Episode", shares: Mapping[str, Share]) -> dict[str, float]:
    """Return the tick by which each agent's share had come true; infinite: it never did."""
    progress = episode.progress
    return {agent: share.done_at(progress[agent]) for agent, share in shares.items()}


def _acts(episode: "Episode", agent: str) -> list[HelpingAct]:
    """Return the programs of an agent in which it said or gave something."""
    state = episode.nest["/"].state
    gave = {e.tick for e in state.events if (e.actor, e.kind) == (agent, _GAVE)}
    said = {tick for tick, speaker, _ in state.chat if speaker == agent} | gave
    own = [part for part in episode.parts if agent in part.decisions]
    ends = [*episode.beginnings[1:], episode.nest.tick]
    acts: list[HelpingAct] = []
    first = 0
    for number, part in enumerate(own):
        first = first if part.decisions[agent].goes_on else number
        if any(episode.beginnings[number] < tick <= ends[number] for tick in said):
            if acts and acts[-1].first == first:
                acts.pop()
            acts.append(HelpingAct(agent, first, number))
    return acts
