"""Playing of one episode of a study."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from beliefnest.episodes.agent_view import Policy
from beliefnest.episodes.episode import Episode
from beliefnest.episodes.policies import resolve_policy
from beliefnest.episodes.policies.model import ModelPolicy
from beliefnest.errors import ModelError
from beliefnest.llm.failures import UnusableAnswerError
from beliefnest.llm.messages import Answer, Message, Model, Sampling
from beliefnest.studies.episode_cells import EpisodeCell
from beliefnest.studies.terms import Terms
from beliefnest.worlds.by_name import Worlds

__all__ = ["play_episode"]


def play_episode(cell: EpisodeCell, terms: Terms, worlds: Worlds) -> dict[str, Any]:
    """Play an episode and return its result as plain values.

    Raises:
        ModelError: A model could not be asked, or the limits of the study are reached. An answer
            without a program is no error: it loses the round.
    """
    key = cell.key
    connection = terms.connection()
    failures: list[ModelError] = []
    policies: dict[str, Policy] = {}
    names = {**cell.task.form.policies, **key.policies}
    for agent, name in names.items():
        policy = resolve_policy(name, terms.surroundings, connection)
        if isinstance(policy, ModelPolicy):
            policy.model = _Noting(policy.model, failures)
        policies[agent] = policy
    store = terms.store(key.name)
    with Episode(
        cell.task,
        policies,
        world=key.setting["world"],
        store=store,
        seed=key.seed,
        worlds=worlds,
        names=names,
    ) as episode:
        while not episode.is_over:
            episode.play(1)
            if failures:
                raise failures[0]
        if key.setting.get("help"):
            episode.help()
            if failures:
                raise failures[0]
        return {
            "error": None,
            "run": "" if store is None else f"runs/{store.name}",
            "goal": [list(each) for each in episode.conditions],
            "why_not": "" if episode.success else _why_not(episode),
            "measures": episode.measures.row(),
        }


def _why_not(episode: Episode) -> str:
    """Return the unmet conditions of the goal, in words."""
    goal, conditions = episode.task.goal, episode.conditions
    count = len(goal.reach)
    broken = [f"not to be: {text}" for text, tick in conditions[count:] if tick is not None]
    if goal.messages is not None and episode.messages > goal.messages:
        broken.append(f"{episode.messages} messages; at most {goal.messages}")
    lacking = [f"not reached: {text}" for text, tick in conditions[:count] if tick is None]
    return "; ".join(broken or lacking) or "never all of it at one and the same tick"


@dataclass(frozen=True)
class _Noting:
    """Model that notes failed requests.

    Attributes:
        model: The model to ask.
        failures: Errors of failed requests.
    """

    model: Model
    failures: list[ModelError] = field(default_factory=list)

    @property
    def name(self) -> str:
        """Return the name of the model."""
        return self.model.name

    def answer(self, messages: Sequence[Message], sampling: Sampling) -> Answer:
        """Ask the model.

        Raises:
            ModelError: The request failed.
        """
        try:
            return self.model.answer(messages, sampling)
        except UnusableAnswerError:
            # The model answered, so the outcome is a result.
            raise
        except ModelError as error:
            self.failures.append(error)
            raise
