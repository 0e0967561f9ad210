"""Language models: a common protocol, adapters to providers, cache, limits, recording.

Each name is imported on first use, so that commands that only name models start fast.
"""

import importlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:  # Each name is imported when it is first used.
    from beliefnest.llm.asking import (
        Check,
        NoUsableProgramError,
        ProgramAnswer,
        Prompt,
        Round,
        ask_for_program,
    )
    from beliefnest.llm.budget import AnswerLimits, RunLimits, RunSpending
    from beliefnest.llm.cache import CacheMode
    from beliefnest.llm.claim_reader import ClaimsFromModel, claims_from_model
    from beliefnest.llm.clock import Clock, SystemClock
    from beliefnest.llm.messages import Answer, Finish, Message, Model, Sampling, Usage
    from beliefnest.llm.named_models import model_names
    from beliefnest.llm.reading_answers import AnswerReading, read_answer
    from beliefnest.llm.reading_programs import ProgramReading, read_program
    from beliefnest.llm.resolve import Connection, open_model, resolve_model
    from beliefnest.llm.retrying import RetryPolicy

__all__ = [
    "Answer",
    "AnswerLimits",
    "AnswerReading",
    "CacheMode",
    "Check",
    "ClaimsFromModel",
    "Clock",
    "Connection",
    "Finish",
    "Message",
    "Model",
    "NoUsableProgramError",
    "ProgramAnswer",
    "ProgramReading",
    "Prompt",
    "RetryPolicy",
    "Round",
    "RunLimits",
    "RunSpending",
    "Sampling",
    "SystemClock",
    "Usage",
    "ask_for_program",
    "claims_from_model",
    "model_names",
    "open_model",
    "read_answer",
    "read_program",
    "resolve_model",
]

_HOMES = (
    "messages",
    "clock",
    "budget",
    "cache",
    "retrying",
    "named_models",
    "reading_answers",
    "reading_programs",
    "claim_reader",
    "asking",
    "resolve",
)
"""Modules of these names, those that are imported fastest first."""


def __getattr__(name: str) -> object:
    if name not in __all__:
        raise AttributeError(f"beliefnest.llm has no {name!r}; it has {', '.join(__all__)}")
    modules = (importlib.import_module(f"{__name__}.{home}") for home in _HOMES)
    return next(getattr(module, name) for module in modules if hasattr(module, name))
