"""Baselines: every task played by every policy over many seeds, and what came of it."""

from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context

from beliefnest.episodes.episode import Episode
from beliefnest.episodes.measures import Measures
from beliefnest.episodes.task import Task
from beliefnest.errors import InputError
from beliefnest.scenarios.scoring import wilson_interval

__all__ = ["BASELINES", "Baseline", "Cell", "play_cells", "summary"]

BASELINES = ("random", "search:0", "search:1", "search:2", "omniscient:search")
"""Policies of players in the table; the others are played as each task says."""


@dataclass(frozen=True, slots=True)
class Cell:
    """One episode.

    Attributes:
        task: Name of a built-in task.
        policy: Who plays its players.
        seed: Which instance, and the episode's seed.
    """

    task: str
    policy: str
    seed: int


@dataclass(frozen=True, slots=True)
class Baseline:
    """What a policy came to in a task.

    Attributes:
        task: Name of the task.
        order: The order that it needs.
        policy: Who played its players.
        episodes: How many were played.
        successes: How many reached the goal.
        low: Lower end of the 95 % interval of Wilson for the rate of success.
        high: Its upper end.
        ticks: Mean ticks of the successes; None: there are none.
        messages: Mean utterances of players in all episodes.
    """

    task: str
    order: int
    policy: str
    episodes: int
    successes: int
    low: float
    high: float
    ticks: float | None
    messages: float


def play_cells(
    cells: Sequence[Cell], jobs: int, told: Callable[[int], None] = lambda _: None
) -> list[Measures]:
    """Play episodes, several at the same time; the measures in order, the same for any `jobs`.

    Args:
        cells: What is played, in the scripted world.
        jobs: How many processes play.
        told: Takes how many are done.

    Raises:
        InputError: `jobs` is below 1.
    """
    if jobs < 1:
        raise InputError(f"jobs is {jobs}; give at least 1")
    found: list[Measures] = []
    if jobs == 1:
        results: Iterable[Measures] = map(_played, cells)
        for each in results:
            found.append(each)
            told(len(found))
        return found
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
        for each in pool.map(_played, cells):
            found.append(each)
            told(len(found))
    return found


def summary(cells: Sequence[Cell], measures: Sequence[Measures]) -> list[Baseline]:
    """Rates of success with intervals, by task and policy, in the order of the cells."""
    groups: dict[tuple[str, str], list[Measures]] = {}
    for cell, each in zip(cells, measures, strict=True):
        groups.setdefault((cell.task, cell.policy), []).append(each)
    return [_summed(task, policy, group) for (task, policy), group in groups.items()]


def _summed(task: str, policy: str, group: Sequence[Measures]) -> Baseline:
    reached = [each.ticks for each in group if each.success]
    low, high = wilson_interval(len(reached), len(group))
    return Baseline(
        task=task,
        order=group[0].order,
        policy=policy,
        episodes=len(group),
        successes=len(reached),
        low=low,
        high=high,
        ticks=sum(reached) / len(reached) if reached else None,
        messages=sum(each.messages for each in group) / len(group),
    )


def _played(cell: Cell) -> Measures:
    task = Task.load(cell.task, cell.seed)
    policies = dict.fromkeys(task.players, cell.policy)
    with Episode(task, policies, seed=cell.seed) as episode:
        return episode.play().measures
