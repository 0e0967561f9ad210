"""Common parts of all tasks: data sets of samples, conversations, scores with explanations."""

from collections.abc import Iterable, Sequence
from typing import Any

from inspect_ai import Task
from inspect_ai.dataset import MemoryDataset, Sample
from inspect_ai.model import (
    ChatMessage,
    ChatMessageAssistant,
    ChatMessageSystem,
    ChatMessageUser,
)
from inspect_ai.scorer import CORRECT, INCORRECT, Metric, Score, Scorer, accuracy, grouped, stderr
from inspect_ai.solver import Solver, generate

from beliefnest.llm.messages import Message

__all__ = ["messages_of", "metrics_by", "score_of", "task_of"]


def task_of(name: str, samples: list[Sample], scorer: Scorer, *before: Solver) -> Task:
    """Return a task that runs some solvers and then asks the model once per sample."""
    return Task(
        dataset=MemoryDataset(samples, name=name), solver=[*before, generate()], scorer=scorer
    )


def metrics_by(key: str) -> list[Metric | dict[str, list[Metric]]]:
    """Return accuracy, its standard error, and accuracy grouped by a key of the samples."""
    return [accuracy(), stderr(), grouped(accuracy(), key, all=False)]


def score_of(
    *,
    ok: bool | None,
    answer: str | None,
    lines: Iterable[str],
    metadata: dict[str, Any] | None = None,
) -> Score:
    """Return a score with explaining lines for the log."""
    return Score(
        value=CORRECT if ok else INCORRECT,
        answer=answer,
        explanation="\n".join(lines),
        metadata=metadata,
    )


def messages_of(messages: Sequence[Message]) -> list[ChatMessage]:
    """Convert a conversation to Inspect's form."""
    forms = {
        "system": ChatMessageSystem,
        "user": ChatMessageUser,
        "assistant": ChatMessageAssistant,
    }
    return [forms[each.role](content=each.text) for each in messages]
