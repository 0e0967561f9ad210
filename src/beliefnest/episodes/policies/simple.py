"""Policies without planning: people, given programs, and random choice."""

from collections.abc import Sequence
from dataclasses import dataclass

from beliefnest.episodes.agent_view import GO_ON, AgentView
from beliefnest.episodes.policies.candidates import calls_of, claims_of_mind, said


@dataclass(frozen=True)
class Person:
    """Person at a Minecraft client, who acts for the agent in a round.

    Attributes:
        is_awaited: True if a round lasts until the person has done or said something.
    """

    is_awaited: bool = False

    def act(self, view: AgentView) -> str:
        """Return no program: the person acts."""
        return ""


@dataclass(frozen=True)
class Scripted:
    """Policy with given programs, one for each round; after the last one it does nothing.

    Attributes:
        programs: Texts of the programs.
    """

    programs: Sequence[str]

    def act(self, view: AgentView) -> str:
        """Return the program of the round."""
        return self.programs[view.round] if view.round < len(self.programs) else ""


@dataclass(frozen=True)
class Program:
    """Policy with one program, which starts at the policy's first round and continues when cut.

    On a branch, the first round is the one from which the policy plays. The policy recognizes it
    from earlier decisions, so that a resumed episode continues the program.

    Attributes:
        text: Text of the program.
    """

    text: str

    def act(self, view: AgentView) -> str:
        """Return the program, until it has ended by itself."""
        if next((each for each in reversed(view.before) if each), "") != self.text:
            return self.text
        return GO_ON if view.last.how == "cut" else ""


@dataclass(frozen=True)
class Random:
    """Policy that draws a relevant act, a relevant true claim, or nothing, each equally likely."""

    def act(self, view: AgentView) -> str:
        """Return a call drawn by the episode's seed, the agent and the round."""
        mind = view.imagine(0)
        goals = list(view.brief.considered)
        calls = calls_of(mind, view.agent, goals)
        if view.may_speak:
            calls += [said(claim) for claim in claims_of_mind(mind, goals, lies=False)]
        number = view.random.randrange(len(calls) + 1)
        return calls[number].program if number < len(calls) else ""
