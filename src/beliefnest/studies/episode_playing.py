"""Playing of one episode of a study."""

from typing import Any

from beliefnest.episodes.agent_view import Policy
from beliefnest.episodes.episode import Episode
from beliefnest.episodes.policies import resolve_policy
from beliefnest.studies.episode_cells import EpisodeCell
from beliefnest.studies.terms import Terms
from beliefnest.worlds.by_name import Worlds


def play_episode(cell: EpisodeCell, terms: Terms, worlds: Worlds) -> dict[str, Any]:
    """Play an episode and return its result as plain values.

    Raises:
        ModelError: A model could not be asked, or the limits of the study are reached. An answer
            without a program is no error: it loses the round.
    """
    key = cell.key
    connection = terms.connection()
    policies: dict[str, Policy] = {}
    names = {**cell.task.form.policies, **key.policies}
    for agent, name in names.items():
        policies[agent] = resolve_policy(name, terms.surroundings, connection)
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
            _raise_first(episode)
        if key.setting.get("help"):
            episode.help()
            _raise_first(episode)
        return {
            "error": None,
            "run": "" if store is None else f"runs/{store.name}",
            "goal": [list(each) for each in episode.conditions],
            "why_not": "" if episode.success else _why_not(episode),
            "measures": episode.measures.row(),
        }


def _raise_first(episode: Episode) -> None:
    for error in episode.model_errors:
        raise error


def _why_not(episode: Episode) -> str:
    """Return the unmet conditions of the goal, in words."""
    goal, conditions = episode.task.goal, episode.conditions
    count = len(goal.reach)
    broken = [f"not to be: {text}" for text, tick in conditions[count:] if tick is not None]
    if goal.messages is not None and episode.messages > goal.messages:
        broken.append(f"{episode.messages} messages; at most {goal.messages}")
    lacking = [f"not reached: {text}" for text, tick in conditions[:count] if tick is None]
    return "; ".join(broken or lacking) or "never all of it at one and the same tick"
