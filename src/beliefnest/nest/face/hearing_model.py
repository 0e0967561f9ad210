"""What reads claims out of text in a nest: a function, or a model whose requests are noted."""

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Protocol, runtime_checkable

from beliefnest.errors import ModelError
from beliefnest.nest.acting.hearsay import ClaimReader
from beliefnest.nest.face.recording_model import RecordingModel
from beliefnest.nest.past.recording import Recording
from beliefnest.world.claims import Claim
from beliefnest.world.nameable import ClaimsFrom, Nameable

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
        """The same, asking its model through what `wrap` puts around it."""


def reader_of(hook: ClaimsFrom | None, recording: Recording) -> ClaimReader | None:
    """What asks a hook in a nest; None for none."""
    if hook is None:
        return None
    given: object = hook
    if isinstance(given, AsksModel):
        return _ModelReader(given, recording)
    return _FunctionReader(hook)


class _FunctionReader:
    """Asks a function; what it raises ends the call in which something was said."""

    def __init__(self, hook: ClaimsFrom) -> None:
        self._hook = hook
        self.name = str(getattr(hook, "__qualname__", type(hook).__qualname__))

    def read(
        self, path: tuple[str, ...], tick: int, text: str, speaker: str, nameable: Nameable
    ) -> Iterable[Claim]:
        return self._hook(text, speaker, nameable)


class _ModelReader:
    """Asks a model; if it fails or answers nonsense, that is noted, and nothing was claimed."""

    def __init__(self, hook: AsksModel, recording: Recording) -> None:
        self._hook = hook
        self._recording = recording
        self.name = hook.name

    def read(
        self, path: tuple[str, ...], tick: int, text: str, speaker: str, nameable: Nameable
    ) -> Iterable[Claim]:
        detail = {"claims_from": text, "speaker": speaker}

        def noting(model: "Model") -> "Model":
            return RecordingModel(model, self._recording, path, detail, tick)

        try:
            return tuple(self._hook.through(noting)(text, speaker, nameable))
        except ModelError:
            return ()
