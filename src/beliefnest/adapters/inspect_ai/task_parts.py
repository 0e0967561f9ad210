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
    ModelOutput,
)
from inspect_ai.scorer import CORRECT, INCORRECT, Score, Scorer
from inspect_ai.solver import Solver, generate

from beliefnest.errors import InputError
from beliefnest.llm.messages import Finish, Message

__all__ = ["finish_of", "messages_of", "score_of", "several_files", "task_of"]


def task_of(name: str, samples: list[Sample], scorer: Scorer, *before: Solver) -> Task:
    """Return a task that runs some solvers and then asks the model once per sample."""
    return Task(
        dataset=MemoryDataset(samples, name=name), solver=[*before, generate()], scorer=scorer
    )


def several_files(names: str | list[str]) -> list[str]:
    """Return one or several names of files as a list.

    Raises:
        InputError: There is none, or one is named twice.
    """
    found = [names] if isinstance(names, str) else [str(each) for each in names]
    if not found:
        raise InputError("file is empty; give at least one file")
    twice = [each for each in found if found.count(each) > 1]
    if twice:
        raise InputError(f"file names {twice[0]} twice; name it once")
    return found


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


def finish_of(output: ModelOutput) -> Finish:
    """Return the reason for the end of an answer."""
    match output.stop_reason:
        case "max_tokens" | "model_length":
            return "length"
        case "content_filter":
            return "content_filter"
        case _:
            return "stop"


def messages_of(messages: Sequence[Message]) -> list[ChatMessage]:
    """Convert a conversation to Inspect's form."""
    forms = {
        "system": ChatMessageSystem,
        "user": ChatMessageUser,
        "assistant": ChatMessageAssistant,
    }
    return [forms[each.role](content=each.text) for each in messages]
