"""Policies that plan nothing: programs written before, and chance."""

import random
from collections.abc import Sequence
from dataclasses import dataclass

from beliefnest.episodes.policies.candidates import calls_of, claims_of_mind, said
from beliefnest.episodes.view import GO_ON, AgentView

__all__ = ["Person", "Program", "Random", "Scripted"]


@dataclass(frozen=True)
class Person:
    """Somebody at a Minecraft client; what they do in a round is their agent's action.

    Attributes:
        is_awaited: Whether a round lasts until they have done or said something.
    """

    is_awaited: bool = False

    def act(self, view: AgentView) -> str:
        """No program: they act themselves."""
        return ""


@dataclass(frozen=True)
class Scripted:
    """Programs written before, one for each round; after the last it does nothing.

    Attributes:
        programs: Their texts.
    """

    programs: Sequence[str]

    def act(self, view: AgentView) -> str:
        """Return the program of the round."""
        return self.programs[view.round] if view.round < len(self.programs) else ""


@dataclass(frozen=True)
class Program:
    """One program, begun when its policy is asked first, which goes on as long as it is cut.

    On a branch that is the round from which on the agent is played so. That is known from what was
    decided before, so that whoever resumes an episode goes on with the program.

    Attributes:
        text: The program.
    """

    text: str

    def act(self, view: AgentView) -> str:
        """Return the program, until it has ended by itself."""
        if next((each for each in reversed(view.before) if each), "") != self.text:
            return self.text
        return GO_ON if view.last.how == "cut" else ""


@dataclass(frozen=True)
class Random:
    """Any deed or true claim that bears on the agent's goals, or nothing, each as likely."""

    def act(self, view: AgentView) -> str:
        """Return a call drawn by the episode's seed, the agent and the round."""
        mind = view.imagine(0)
        goals = list(view.brief.goals.values())
        calls = calls_of(mind, view.agent, goals)
        if view.may_speak:
            calls += [said(claim) for claim in claims_of_mind(mind, goals, lies=False)]
        chance = random.Random(f"{view.brief.seed} {view.agent} {view.round}")
        number = chance.randrange(len(calls) + 1)
        return calls[number].program if number < len(calls) else ""
