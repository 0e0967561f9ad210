"""What reads claims out of text in a nest: a function, or a model whose requests are noted."""

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

__all__ = ["AsksModel", "reader_of"]


@runtime_checkable
class AsksModel(Protocol):
    """A hook that asks a model, as `claims_from_model` gives."""

    @property
    def name(self) -> str:
        """Name of the model."""

    def through(self, wrap: "Callable[[Model], Model]") -> ClaimsFrom:
        """Return the same, asking its model through what `wrap` makes of it."""


def reader_of(hook: ClaimsFrom | None, recording: Recording) -> ClaimReader | None:
    """What asks a hook in a nest; None for none.

    Raises:
        InputError: It cannot be called with a text, its speaker and what can be named.
    """
    if hook is None:
        return None
    given: object = hook
    if isinstance(given, AsksModel):
        return _ModelReader(given, recording)
    if not _takes_three(given):
        raise InputError(
            f"claims_from is {given!r}; give a function of three arguments: text, speaker, nameable"
        )
    return _FunctionReader(hook)


def _takes_three(hook: object) -> bool:
    """Return True if something can be called with three arguments, as far as is known."""
    if not callable(hook):
        return False
    try:
        inspect.signature(hook).bind("text", "speaker", "nameable")
    except TypeError:
        return False
    except ValueError:
        # Some functions of C do not say.
        return True
    return True


class _FunctionReader:
    """Asks a function; what it raises ends the call in which something was said."""

    def __init__(self, hook: ClaimsFrom) -> None:
        self._hook = hook
        self.name = str(getattr(hook, "__qualname__", type(hook).__qualname__))

    def read(
        self, path: BeliefPath, tick: int, text: str, speaker: str, nameable: Nameable
    ) -> Iterable[Claim]:
        found: object = self._hook(text, speaker, nameable)
        if isinstance(found, str) or not isinstance(found, Iterable):
            raise InputError(
                f"claims_from ({self.name}) gave {found!r} for {text!r}; "
                "it has to give a list of claims, [] for none"
            )
        return found


class _ModelReader:
    """Asks a model; if it fails or answers nonsense, that is noted, and nothing was claimed."""

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
