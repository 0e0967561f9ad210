"""Language models: a common protocol, adapters to providers, cache, limits, recording."""

from beliefnest.llm.asking import (
    Check,
    NoUsableProgramError,
    ProgramAnswer,
    Prompt,
    Round,
    ask_for_program,
)
from beliefnest.llm.budget import RunLimits, RunSpending
from beliefnest.llm.cache import CacheMode
from beliefnest.llm.claim_reader import ClaimsFromModel, claims_from_model
from beliefnest.llm.clock import Clock, SystemClock
from beliefnest.llm.messages import Answer, Finish, Message, Model, Sampling, Usage
from beliefnest.llm.reading_answers import AnswerReading, read_answer
from beliefnest.llm.reading_programs import ProgramReading, read_program
from beliefnest.llm.remote import AnswerLimits
from beliefnest.llm.resolve import Connection, model_names, open_model, resolve_model
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
