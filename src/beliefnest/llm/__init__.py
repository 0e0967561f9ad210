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
from beliefnest.llm.extract import NoProgramError, extract_program
from beliefnest.llm.messages import Answer, Finish, Message, Model, Sampling, Usage
from beliefnest.llm.remote import AnswerLimits
from beliefnest.llm.resolve import Connection, model_names, open_model, resolve_model
from beliefnest.llm.retrying import RetryPolicy

__all__ = [
    "Answer",
    "AnswerLimits",
    "CacheMode",
    "Check",
    "ClaimsFromModel",
    "Clock",
    "Connection",
    "Finish",
    "Message",
    "Model",
    "NoProgramError",
    "NoUsableProgramError",
    "ProgramAnswer",
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
    "extract_program",
    "model_names",
    "open_model",
    "resolve_model",
]
