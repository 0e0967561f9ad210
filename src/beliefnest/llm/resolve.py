"""From the name of a model to the model, and with it all that a run puts around it."""

import difflib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from beliefnest.errors import InputError, ModelError, UnknownNameError
from beliefnest.llm.budget import MeteredModel, RunSpending
from beliefnest.llm.cache import CachedModel, CacheMode
from beliefnest.llm.clock import Clock, SystemClock
from beliefnest.llm.messages import Answer, Message, Model, Sampling
from beliefnest.llm.offline import OfflineModel
from beliefnest.llm.providers import PROVIDERS, endpoint
from beliefnest.llm.recorded import FileRecordingModel, load_replay, load_script
from beliefnest.llm.remote import AnswerLimits, RemoteModel
from beliefnest.llm.retrying import RetryingModel, RetryPolicy

__all__ = [
    "Connection",
    "check_model",
    "is_of_provider",
    "model_names",
    "open_model",
    "resolve_model",
]


@dataclass(frozen=True)
class Connection:
    """What a run puts around a model.

    Attributes:
        budget: What the run may spend, and has spent.
        answer_limits: What one answer may take.
        retries: How often a request is made again.
        cache: Folder of kept answers; None: none are kept or used.
        cache_mode: How the folder is used.
        record: File to append every exchange to; None: none.
        clock: Time for limits and pauses.
    """

    budget: RunSpending = field(default_factory=RunSpending)
    answer_limits: AnswerLimits = field(default_factory=AnswerLimits)
    retries: RetryPolicy = field(default_factory=RetryPolicy)
    cache: Path | None = None
    cache_mode: CacheMode = "read"
    record: Path | None = None
    clock: Clock = field(default_factory=SystemClock)

    @property
    def holds_answers(self) -> bool:
        """True if any kept answer may be used."""
        if self.cache is None or self.cache_mode != "read":
            return False
        return next(self.cache.glob("*.json"), None) is not None


def model_names() -> tuple[str, ...]:
    """Return the forms of names that `resolve_model` takes."""
    remote = (f"{name}:MODEL" for name in PROVIDERS)
    return ("offline", "replay:FILE", "scripted:FILE", *remote)


def resolve_model(
    name: str,
    environment: Mapping[str, str],
    *,
    limits: AnswerLimits | None = None,
    clock: Clock | None = None,
) -> Model:
    """Return the model of a name: one request an answer, nothing around it.

    Args:
        name: `offline`, `replay:FILE`, `scripted:FILE` or `PROVIDER:MODEL`.
        environment: Holds keys and base URLs; the process's environment, as a rule.
        limits: What one answer of a provider may take.
        clock: Measures the limits.

    Raises:
        UnknownNameError: There is no such kind of model.
        InputError: Nothing stands behind the colon.
        ModelError: A key, a URL or a file is missing.
    """
    if name == "offline":
        return OfflineModel()
    kind, _, rest = name.partition(":")
    if kind not in ("replay", "scripted", *PROVIDERS):
        raise UnknownNameError(f"no model {name!r}{_nearest(kind)}")
    if not rest:
        raise InputError(f"{name!r} is not complete; write {kind}:{_placeholder(kind)}")
    if kind == "replay":
        return load_replay(name, Path(rest))
    if kind == "scripted":
        return load_script(name, Path(rest))
    return RemoteModel(
        endpoint(PROVIDERS[kind], environment),
        rest,
        limits or AnswerLimits(),
        clock or SystemClock(),
    )


@dataclass(frozen=True)
class _Unreachable:
    """A model that lacks a key or an address; kept answers may stand in for all it is asked."""

    name: str
    why: str

    def answer(self, messages: Sequence[Message], sampling: Sampling) -> Answer:
        """Refuse; ModelError says what is missing."""
        raise ModelError(f"no answer of {self.name} to this prompt is kept, and {self.why}")


def check_model(name: str, environment: Mapping[str, str], connection: Connection) -> None:
    """Refuse a model that cannot answer, before anything is played.

    A model without a key or an address passes where answers are kept; see `open_model`.

    Raises:
        BeliefNestError: There is no such model, as `resolve_model` says.
    """
    _resolved(name, environment, connection)


def _resolved(name: str, environment: Mapping[str, str], connection: Connection) -> Model:
    try:
        return resolve_model(
            name, environment, limits=connection.answer_limits, clock=connection.clock
        )
    except ModelError as error:
        if not is_of_provider(name) or not connection.holds_answers:
            raise
        return _Unreachable(name, str(error))


def is_of_provider(name: str) -> bool:
    """Whether a model is a provider's, which may answer the same question in several ways."""
    return name.partition(":")[0] in PROVIDERS


def open_model(name: str, environment: Mapping[str, str], connection: Connection) -> Model:
    """Return the model of a name with retries, limits, cache and recording around it.

    A kept answer costs nothing and is recorded like any other; only models of providers
    are retried, metered and kept. Where answers are kept, a model may lack its key and address:
    it fails only when it is asked what none of them answers.

    Raises:
        BeliefNestError: There is no such model, as `resolve_model` says.
    """
    model = _resolved(name, environment, connection)
    if is_of_provider(name):
        model = RetryingModel(model, connection.retries, connection.clock)
        model = MeteredModel(model, connection.budget)
        if connection.cache is not None and connection.cache_mode != "off":
            model = CachedModel(model, connection.cache, connection.cache_mode)
    if connection.record is not None:
        model = FileRecordingModel(model, connection.record)
    return model


def _placeholder(kind: str) -> str:
    return "FILE" if kind in ("replay", "scripted") else "MODEL"


def _nearest(kind: str) -> str:
    close = difflib.get_close_matches(kind, ["offline", "replay", "scripted", *PROVIDERS], n=1)
    hint = f"; did you mean {close[0]}?" if close else ""
    return f"{hint}; a model is one of {', '.join(model_names())}"
