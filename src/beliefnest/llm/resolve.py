"""Lookup of models by name, with retries, limits, cache and recording around them."""

import difflib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import msgspec

from beliefnest.errors import InputError, ModelError, UnknownNameError
from beliefnest.llm.budget import AnswerLimits, MeteredModel, RunSpending
from beliefnest.llm.cache import CachedModel, CacheMode
from beliefnest.llm.clock import Clock, SystemClock
from beliefnest.llm.messages import Answer, Message, Model, Sampling
from beliefnest.llm.named_models import model_names
from beliefnest.llm.offline import OfflineModel
from beliefnest.llm.option_models import OPTION_MODELS
from beliefnest.llm.own_models import installed_models, names_own_model, own_model
from beliefnest.llm.providers import PROVIDERS, endpoint
from beliefnest.llm.recorded_models import FileRecordingModel, load_replay, load_script
from beliefnest.llm.retrying import RetryingModel, RetryPolicy, TellWait, tell_on_stderr
from beliefnest.world.texts import quoted

_KINDS = ("replay", "scripted", *PROVIDERS)
"""Words before the colon that are no names of modules."""


@dataclass(frozen=True)
class Connection:
    """Settings for the wrappers around a model.

    Attributes:
        budget: Limits of the run and its usage so far.
        answer_limits: Limits on one answer.
        retries: Policy for repeated requests.
        cache: Folder of the cache; None for no cache.
        cache_mode: Mode of the cache.
        record: File to which every exchange is appended; None for no recording.
        clock: Clock for pauses.
        tell: Function that receives a line about each wait that a provider asks for.
    """

    budget: RunSpending = field(default_factory=RunSpending)
    answer_limits: AnswerLimits = field(default_factory=AnswerLimits)
    retries: RetryPolicy = field(default_factory=RetryPolicy)
    cache: Path | None = None
    cache_mode: CacheMode = "read"
    record: Path | None = None
    clock: Clock = field(default_factory=SystemClock)
    tell: TellWait = tell_on_stderr

    @property
    def holds_answers(self) -> bool:
        """True if the cache is readable and has any answer."""
        if self.cache is None or self.cache_mode != "read":
            return False
        return next(self.cache.glob("*.json"), None) is not None


def resolve_model(
    name: str, environment: Mapping[str, str], *, limits: AnswerLimits | None = None
) -> Model:
    """Return the bare model of a name; each answer takes one request.

    Args:
        name: `offline`, `chance`, `first-option`, `replay:FILE`, `scripted:FILE`,
            `PROVIDER:MODEL`, or a model of the user's own: `MODULE:CLASS`, `FILE.py:CLASS`, or the
            name of an entry point of the group `beliefnest.models`.
        environment: Variables with keys and base URLs, usually those of the process.
        limits: Limits on one answer of a provider.

    Raises:
        UnknownNameError: There is no such kind of model.
        InputError: The part after the colon is missing, or a file of answers is damaged.
        ModelError: A key, a URL or a file is missing.
    """
    if name == "offline":
        return OfflineModel()
    if name in OPTION_MODELS:
        return OPTION_MODELS[name]
    kind, _, rest = name.partition(":")
    if is_own(name):
        return own_model(name)
    if kind not in _KINDS:
        raise UnknownNameError(f"no model {quoted(name)}{_nearest(kind)}")
    if not rest:
        what = "FILE" if kind in ("replay", "scripted") else "MODEL"
        raise InputError(f"{quoted(name)} is incomplete; write {kind}:{what}")
    if kind == "replay":
        return load_replay(name, Path(rest))
    if kind == "scripted":
        return load_script(name, Path(rest))
    # Its ways to servers take long to import.
    from beliefnest.llm.remote import RemoteModel

    return RemoteModel(endpoint(PROVIDERS[kind], environment), rest, limits or AnswerLimits())


class _Unreachable(msgspec.Struct, frozen=True):
    """Model without key or address, which fails when a request is not in the cache."""

    name: str
    why: str

    def answer(self, messages: Sequence[Message], sampling: Sampling) -> Answer:
        """Raise ModelError with the missing key or address."""
        raise ModelError(f"the cache has no answer of {self.name} to this prompt, and {self.why}")


def check_model(name: str, environment: Mapping[str, str], connection: Connection) -> None:
    """Refuse a model that cannot answer, before a run begins.

    A model without key, address or server is accepted if the cache has answers; see `open_model`.

    Raises:
        BeliefNestError: As of `resolve_model`.
        UnavailableModelError: Nothing listens at the address of its server.
    """
    model = _resolved(name, environment, connection)
    if not is_of_provider(name) or connection.holds_answers:
        return
    from beliefnest.llm.remote import RemoteModel

    if isinstance(model, RemoteModel):
        model.check_server()


def _resolved(name: str, environment: Mapping[str, str], connection: Connection) -> Model:
    if can_vary(name) and connection.cache_mode == "only":
        return _Unreachable(name, "no model is asked here")
    try:
        return resolve_model(name, environment, limits=connection.answer_limits)
    except ModelError as error:
        if not is_of_provider(name) or not connection.holds_answers:
            raise
        return _Unreachable(name, str(error))


def check_structured(name: str) -> None:
    """Refuse a model that is known to have no structured form of answers.

    Others are refused at their first answer: a provider's model may lack the form, and a recording
    may hold free text.

    Raises:
        InputError: The model answers in free text only.
    """
    if name in ("offline", *OPTION_MODELS):
        raise InputError(
            f"the model {name} has no structured form of answers; leave out `answer: structured`, "
            "or name a model of a provider"
        )


def is_of_provider(name: str) -> bool:
    """Return True if a model is a provider's."""
    return name.partition(":")[0] in PROVIDERS


def is_own(name: str) -> bool:
    """Return True if a model is the user's own, in a file, a module or an installed package."""
    if name in ("offline", *OPTION_MODELS) or name.partition(":")[0] in _KINDS:
        return False
    return name in installed_models() or names_own_model(name)


def can_vary(name: str) -> bool:
    """Return True if the answers of a model can vary: of a provider's, or of the user's own."""
    return is_of_provider(name) or is_own(name)


def is_free(name: str, environment: Mapping[str, str]) -> bool:
    """Return True if a model is known to cost nothing, such as one on the user's own server."""
    if not is_of_provider(name):
        return not is_own(name)
    try:
        return endpoint(PROVIDERS[name.partition(":")[0]], environment).cost(None) == 0.0
    except ModelError:
        return False


def open_model(name: str, environment: Mapping[str, str], connection: Connection) -> Model:
    """Return the model of a name with retries, limits, cache and recording around it.

    A cached answer costs nothing and is recorded like any other. Models of providers and the
    user's own are metered and cached; those of providers are retried. If the cache has answers, a
    model may lack its key and address; it then fails only when a request is not in the cache.

    Raises:
        BeliefNestError: As of `resolve_model`.
    """
    model = _resolved(name, environment, connection)
    if is_of_provider(name):
        model = RetryingModel(model, connection.retries, connection.clock, connection.tell)
    if can_vary(name):
        model = MeteredModel(model, connection.budget, is_free(name, environment))
        if connection.cache is not None and connection.cache_mode != "off":
            model = CachedModel(model, connection.cache, connection.cache_mode)
    if connection.record is not None:
        model = FileRecordingModel(model, connection.record)
    return model


def _nearest(kind: str) -> str:
    close = difflib.get_close_matches(
        kind, ["offline", *OPTION_MODELS, *installed_models(), *_KINDS], n=1
    )
    hint = f"; did you mean {close[0]}?" if close else ""
    return f"{hint}; a model is one of {', '.join(model_names())}"
