"""Policies that ask a model, with beliefs of others in the prompt as its order allows."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from importlib.resources import files

from beliefnest.episodes.agent_view import AgentView
from beliefnest.episodes.decided import Spent
from beliefnest.llm.asking import ask_for_program
from beliefnest.llm.failures import UnusableAnswerError
from beliefnest.llm.messages import Answer, Message, Model, Sampling, Usage
from beliefnest.prompts import built_in_template
from beliefnest.scenarios.goals import Goal
from beliefnest.skills import skills

__all__ = ["ModelPolicy", "OmniscientModelPolicy"]


@dataclass
class ModelPolicy:
    """Policy that asks a model for the program of each round.

    At order 0 the prompt contains the agent's belief. At order 1 it also contains the beliefs of
    others as the agent believes them. At order 2 it also contains what the agent believes that the
    others believe about its own belief.

    Attributes:
        model: The model.
        order: Order of Theory of Mind.
        attempts: Greatest number of requests in a round; answers without a program are sent back.
        spent: Spending so far.
    """

    model: Model
    order: int
    attempts: int = 2
    spent: Spent = field(default_factory=Spent)

    def act(self, view: AgentView) -> str:
        """Return the program that the model answers with.

        Raises:
            ModelError: The model failed, or gave no program.
            TemplateError: The prompt cannot be rendered.
        """
        prompt = self.prompt(view)
        system = view.render(built_in_template("instructions").text, skills=skills())
        answer = ask_for_program(
            _Counted(view.noting(self.model), self._spend),
            prompt,
            lambda _: None,
            self.attempts,
            system=system,
            sampling=Sampling(seed=view.brief.seed),
        )
        return answer.program

    def prompt(self, view: AgentView) -> str:
        """Return the prompt of a round."""
        others = [name for name in view.brief.agents if name != view.agent]
        return view.render(
            _template(),
            depth=self.order,
            order=self.order,
            others=others,
            instructed=True,
            task=_sentence(view.goal, view.agent),
            tasks={
                name: _sentence(view.brief.goals[name], name)
                if name in view.brief.goals
                else f"See to it: {view.brief.words(name)}."
                for name in others
            },
            places=view.brief.places,
            last_code=view.last.program or None,
            last_error=view.last.message or None,
        )

    def _spend(self, usage: Usage) -> None:
        self.spent += Spent(usage.requests, usage.tokens, usage.cost)


@dataclass(frozen=True)
class _Counted:
    """Model that reports the usage of each answer, even of unusable ones."""

    model: Model
    spend: Callable[[Usage], None]

    @property
    def name(self) -> str:
        """Return the name of the model."""
        return self.model.name

    def answer(self, messages: Sequence[Message], sampling: Sampling) -> Answer:
        """Ask the model.

        Raises:
            ModelError: The model failed, or its answer is not usable.
        """
        try:
            answer = self.model.answer(messages, sampling)
        except UnusableAnswerError as error:
            self.spend(error.usage)
            raise
        self.spend(answer.usage)
        return answer


@dataclass
class OmniscientModelPolicy(ModelPolicy):
    """Policy that gives the model reality and the true beliefs of others: an upper bound."""

    sees_all: bool = True

    def prompt(self, view: AgentView) -> str:
        """Return the prompt of a round, in which `branch` is reality, which no agent owns."""
        return view.render(
            (files(__package__) / "texts" / "omniscient.txt").read_text(encoding="utf-8"),
            depth=1,
            agents=list(view.brief.agents),
            task=_sentence(view.goal, view.agent),
        )


def _template() -> str:
    return (files(__package__) / "texts" / "model.txt").read_text(encoding="utf-8")


def _sentence(goal: Goal, agent: str) -> str:
    """Return a goal as a sentence for the model, with a natural wording of simple goals."""
    facts = [each.fact for each in goal.reach if not each.path]
    task = facts[0].task(agent) if len(facts) == 1 and not goal.never else None
    return task or f"See to it: {goal}."
