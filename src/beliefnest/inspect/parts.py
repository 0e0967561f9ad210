"""What all tasks have alike: a data set of samples, and scores that say why."""

from collections.abc import Iterable
from typing import Any

from inspect_ai import Task
from inspect_ai.dataset import MemoryDataset, Sample
from inspect_ai.scorer import CORRECT, INCORRECT, Metric, Score, Scorer, accuracy, grouped, stderr
from inspect_ai.solver import Solver, generate

__all__ = ["metrics_by", "score_of", "task_of"]


def task_of(name: str, samples: list[Sample], scorer: Scorer, *before: Solver) -> Task:
    """Return a task whose samples a model answers once, after some solvers."""
    return Task(
        dataset=MemoryDataset(samples, name=name), solver=[*before, generate()], scorer=scorer
    )


def metrics_by(key: str) -> list[Metric | dict[str, list[Metric]]]:
    """Accuracy, its standard error, and accuracy for each value that samples have under a key."""
    return [accuracy(), stderr(), grouped(accuracy(), key, all=False)]


def score_of(
    *,
    ok: bool | None,
    answer: str | None,
    lines: Iterable[str],
    metadata: dict[str, Any] | None = None,
) -> Score:
    """Return a score, with the lines that explain it in the log."""
    return Score(
        value=CORRECT if ok else INCORRECT,
        answer=answer,
        explanation="\n".join(lines),
        metadata=metadata,
    )
