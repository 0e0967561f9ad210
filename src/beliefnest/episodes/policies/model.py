"""Policies that ask a model, with beliefs of others in the prompt as its order allows."""

from dataclasses import dataclass, field
from importlib.resources import files

from beliefnest.episodes.agent_view import AgentView
from beliefnest.llm.asking import Round, ask_for_program, asked_again
from beliefnest.llm.messages import Model, Sampling
from beliefnest.llm.model_settings import ModelSettings
from beliefnest.prompts import built_in_template
from beliefnest.scenarios.goals import Goal
from beliefnest.skills import skills_at


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
        settings: Settings of requests.
        asked_again: Number of answers without a program after which the model was asked again.
    """

    model: Model
    order: int
    attempts: int = 2
    settings: ModelSettings = field(default_factory=ModelSettings)
    asked_again: int = 0

    def act(self, view: AgentView) -> str:
        """Return the program that the model answers with.

        Raises:
            ModelError: The model failed, or gave no program.
            TemplateError: The prompt cannot be rendered.
        """
        prompt = self.prompt(view)
        settings = self.settings
        system = settings.system
        if system is None:
            template = built_in_template("instructions").text
            system = view.render(template, skills=skills_at(settings.skills))
        rounds: list[Round] = []
        try:
            return self._ask(view, prompt, system, rounds)
        finally:
            self.asked_again += asked_again(rounds)

    def _ask(self, view: AgentView, prompt: str, system: str, rounds: list[Round]) -> str:
        settings = self.settings
        return ask_for_program(
            view.noting(self.model),
            prompt,
            lambda _: None,
            self.attempts,
            system=system,
            sampling=settings.sampling(Sampling(seed=view.brief.seed)),
            retry_unread=settings.retry_unread,
            on_round=rounds.append,
        ).program

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
