"""Common parts of all tasks: data sets of samples, conversations, scores with explanations."""

from collections.abc import Awaitable, Callable, Iterable, Sequence
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
from inspect_ai.scorer import CORRECT, INCORRECT, Score, Scorer, Target
from inspect_ai.solver import Generate, Solver, TaskState, solver

from beliefnest.errors import InputError, ModelError
from beliefnest.llm.failures import NOT_ASKED
from beliefnest.llm.messages import Finish, Message

_NO_ANSWER = "no_answer"
"""Outcome, and key of a sample's metadata with the reason."""


def task_of(name: str, samples: list[Sample], scorer: Scorer, *before: Solver) -> Task:
    """Return a task that runs some solvers and then asks the model once per sample."""
    return Task(
        dataset=MemoryDataset(samples, name=name), solver=[*before, ask_once()], scorer=scorer
    )


@solver
def ask_once() -> Solver:
    """Ask the model. A request without an answer is scored, and not left out of the metrics.

    Errors of Inspect's own providers are left to Inspect, and so is a model that is not there.
    """

    async def solve(state: TaskState, generate: Generate) -> TaskState:
        try:
            return await generate(state)
        except Exception as error:
            reason = _unanswered(error)
            if reason is None:
                raise
            state.metadata[_NO_ANSWER] = reason
            return state

    return solve


def _unanswered(error: BaseException | None) -> str | None:
    """Return why our model gave no answer; None: the error is another one."""
    while error is not None and not isinstance(error, ModelError):
        error = error.__cause__ or error.__context__
    return None if error is None or isinstance(error, NOT_ASKED) else str(error)


def answer_scorer(scored: Callable[[TaskState, str, Finish], Awaitable[Score]]) -> Scorer:
    """Return a scorer of samples, of which those without an answer are wrong.

    Args:
        scored: Function that scores an answer, given with the reason for its end.
    """

    async def score(state: TaskState, target: Target) -> Score:
        reason = state.metadata.get(_NO_ANSWER)
        if reason is None:
            return await scored(state, state.output.completion, finish_of(state.output))
        lines = [f"{_NO_ANSWER}: {reason}"]
        return score_of(ok=False, answer=None, lines=lines, metadata={"outcome": _NO_ANSWER})

    return score


def several_files(names: str | list[str]) -> list[str]:
    """Return one or several names of files as a list.

    Raises:
        InputError: There is none, or one is named twice.
    """
    files = [names] if isinstance(names, str) else [str(each) for each in names]
    if not files:
        raise InputError("file is empty; give at least one file")
    twice = [each for each in files if files.count(each) > 1]
    if twice:
        raise InputError(f"file names {twice[0]} twice; name it once")
    return files


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
    # Inspect notes there that a provider moderated the answer away.
    if output.error:
        return "content_filter"
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
