"""Trials: many policies that play one instance from one and the same beginning."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Self

from beliefnest.episodes.agent_view import AgentView, Policy
from beliefnest.episodes.choosing import chosen
from beliefnest.episodes.decided import Decision
from beliefnest.episodes.episode import Episode
from beliefnest.episodes.record import Budget
from beliefnest.episodes.rounds import Asker, ReplayedPolicy
from beliefnest.episodes.task import Task


class Trials:
    """Instance whose beginning is played once, and from which one policy after the other goes on.

    Use it in a `with` block.

    Args:
        task: The instance.
        seed: Seed of every random number.
    """

    def __init__(self, task: Task, seed: int = 0) -> None:
        self._task = task
        self._episode = Episode(task, seed=seed)
        self._won: dict[tuple[str, ...], bool] = {}
        self._others: dict[str, Decision] = {}

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._episode.close()

    def view(self, agent: str) -> AgentView:
        """Return the view of an agent's policy before the first round."""
        self._episode.play(0)
        return self._episode.view(agent)

    def won(self, policies: Iterable[str | Policy]) -> list[bool]:
        """Return for each policy whether players that all have it reach the goal."""
        tried = [self._chosen(each) for each in policies]
        if not all(map(self._decide_once, tried)):
            return [self._plays(each) for each in tried]
        # Policies that decide alike end alike, so that they are played once.
        decided = [self._decided(each) for each in tried]
        for each in decided:
            programs = _programs(each)
            if programs not in self._won:
                replayed = {name: ReplayedPolicy([choice]) for name, choice in each.items()}
                self._won[programs] = self._plays(replayed)
        return [self._won[_programs(each)] for each in decided]

    def _decide_once(self, policies: Mapping[str, Policy]) -> bool:
        """Return True if all agents decide together and once, each in its own belief."""
        form = self._task.form
        sees_all = any(getattr(each, "sees_all", False) for each in policies.values())
        return form.rounds == 1 and form.play != "turns" and not sees_all

    def _chosen(self, policy: str | Policy) -> Mapping[str, Policy]:
        return chosen(self._task, dict.fromkeys(self._task.players, policy), Budget())[1]

    def _decided(self, policies: Mapping[str, Policy]) -> dict[str, Decision]:
        """Return the decisions of all agents; those that are no players decide but once."""
        asker, players = Asker(policies, None), self._task.players
        if not self._others:
            others = [name for name in policies if name not in players]
            self._others = {name: asker.ask(self.view(name)) for name in others}
        return {**self._others, **{name: asker.ask(self.view(name)) for name in players}}

    def _plays(self, policies: Mapping[str, Policy]) -> bool:
        return self._episode.play(0).at(0).fork(**policies).play().success


def _programs(decided: Mapping[str, Decision]) -> tuple[str, ...]:
    return tuple(decided[name].program for name in sorted(decided))


def wins_of(
    load: Callable[[int], Task], policies: Sequence[str], seeds: Iterable[int]
) -> list[int]:
    """Return for each policy the number of instances in which players with it reach the goal.

    Args:
        load: Function that returns the instance of a seed.
        policies: Names of the policies.
        seeds: Seeds of the instances.
    """
    won = [0] * len(policies)
    for seed in seeds:
        with Trials(load(seed), seed) as trials:
            won = [sum(each) for each in zip(won, trials.won(policies), strict=True)]
    return won
