"""Readers of claims in text: a function, or a model whose requests are recorded."""

import inspect
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Protocol, runtime_checkable

from beliefnest.errors import InputError, ModelError
from beliefnest.nest.acting.hearsay import ClaimReader
from beliefnest.nest.face.recording_model import RecordingModel
from beliefnest.nest.past.recording import Recording
from beliefnest.world.claims import Claim
from beliefnest.world.nameable import ClaimsFrom, Nameable
from beliefnest.world.paths import BeliefPath

if TYPE_CHECKING:  # Models take long to import, and few nests have one.
    from beliefnest.llm.messages import Model


@runtime_checkable
class AsksModel(Protocol):
    """Hook that asks a model, as `claims_from_model` returns it."""

    @property
    def name(self) -> str:
        """The name of the model."""

    def through(self, wrap: "Callable[[Model], Model]") -> ClaimsFrom:
        """Return the same hook with its model replaced by `wrap(model)`."""


def reader_of(hook: ClaimsFrom | None, recording: Recording) -> ClaimReader | None:
    """Return the reader that asks a hook in a nest; None if there is no hook.

    Raises:
        InputError: The hook cannot be called with three arguments: text, speaker, nameable.
    """
    if hook is None:
        return None
    own: object = hook
    if isinstance(own, AsksModel):
        return _ModelReader(own, recording)
    if not _takes_three(own):
        raise InputError(
            f"claims_from is {own!r}; give a function of three arguments: text, speaker, nameable"
        )
    return _FunctionReader(hook)


def _takes_three(hook: object) -> bool:
    """Return True if an object is callable with three arguments, or has no signature."""
    if not callable(hook):
        return False
    try:
        inspect.signature(hook).bind("text", "speaker", "nameable")
    except TypeError:
        return False
    except ValueError:
        # Some functions written in C have no signature.
        return True
    return True


class _FunctionReader:
    """Reader that asks a function. An exception in it ends the call with the utterance."""

    def __init__(self, hook: ClaimsFrom) -> None:
        self._hook = hook
        self.name = str(getattr(hook, "__qualname__", type(hook).__qualname__))

    def read(
        self, path: BeliefPath, tick: int, text: str, speaker: str, nameable: Nameable
    ) -> Iterable[Claim]:
        items: object = self._hook(text, speaker, nameable)
        if isinstance(items, str) or not isinstance(items, Iterable):
            raise InputError(
                f"claims_from ({self.name}) returned {items!r} for {text!r}; it must return a list "
                "of claims, [] for none"
            )
        return items


class _ModelReader:
    """Reader that asks a model. If it fails or its answer is invalid, that is recorded.

    The utterance then has no claims.
    """

    def __init__(self, hook: AsksModel, recording: Recording) -> None:
        self._hook = hook
        self._recording = recording
        self.name = hook.name

    def read(
        self, path: BeliefPath, tick: int, text: str, speaker: str, nameable: Nameable
    ) -> Iterable[Claim]:
        detail = {"claims_from": text, "speaker": speaker}

        def recorded(model: "Model") -> "Model":
            return RecordingModel(model, self._recording, path, detail, tick)

        try:
            return tuple(self._hook.through(recorded)(text, speaker, nameable))
        except ModelError:
            return ()
