"""Opening of nests, for new runs and for recorded ones, and of the readers of claims in them."""

import inspect
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Protocol, runtime_checkable

import msgspec

from beliefnest.errors import InputError, ModelError
from beliefnest.nest.acting.engine import Engine
from beliefnest.nest.acting.hearsay import ClaimReader
from beliefnest.nest.face.recording_model import RecordingModel
from beliefnest.nest.past.recording import Recording, read_recording
from beliefnest.nest.past.setting import Setting
from beliefnest.nest.past.setting_codec import encode_start
from beliefnest.nest.past.versions import own_versions
from beliefnest.prompts import Renderer
from beliefnest.timeline.run_records import RunRecord
from beliefnest.timeline.store import Journal
from beliefnest.world.claims import Claim
from beliefnest.world.nameable import ClaimsFrom, Nameable
from beliefnest.world.paths import BeliefPath
from beliefnest.worlds.by_name import Worlds
from beliefnest.worlds.names import maker_of
from beliefnest.worlds.process_limits import ProcessLimits
from beliefnest.worlds.protocol import World

if TYPE_CHECKING:  # Models take long to import, and few nests have one.
    from beliefnest.llm.messages import Model


class HasSetting(Protocol):
    """Protocol of what a nest can open: a scenario with one chosen condition."""

    @property
    def setting(self) -> Setting:
        """The setting from which the nest starts."""

    @property
    def text(self) -> str:
        """The text of the scenario's file, to be recorded; empty if there is none."""

    @property
    def templates(self) -> Mapping[str, str]:
        """The texts of the prompt templates that the file names, to be recorded."""

    @property
    def condition(self) -> int | None:
        """The number of the chosen condition; None if there are no conditions."""


class BareSetting(msgspec.Struct, frozen=True):
    """Setting without a scenario file. The attributes are those of `HasSetting`."""

    setting: Setting
    text: str = ""
    templates: Mapping[str, str] = msgspec.field(default_factory=dict)
    condition: int | None = None


def as_scenario(scenario: HasSetting | Setting) -> HasSetting:
    """Return a scenario or setting in the form that a nest can open.

    Raises:
        InputError: `given` is a name or something else.
    """
    if isinstance(scenario, Setting):
        return BareSetting(scenario)
    if not hasattr(scenario, "setting"):
        raise InputError(
            f"{scenario!r} is not a scenario; give a loaded one, bn.Scenario.load({scenario!r})"
        )
    return scenario


def begun(
    scenario: HasSetting,
    world: World,
    name: str,
    seed: int,
    store: str | Path | None = None,
    claims_from: ClaimsFrom | None = None,
    renderer: Renderer | None = None,
) -> Engine:
    """Begin a run in a world, recorded in a file or in memory.

    Args:
        scenario: The scenario.
        world: The world.
        name: Name of the world, to be recorded.
        seed: As for `Nest.open`.
        store: As for `Nest.open`.
        claims_from: As for `Nest.open`.
        renderer: As for `Nest.open`.

    Raises:
        StoreError: The file exists already, or cannot be written.
        BodyError: The world could not be started.
        InputError: The scenario has people, and they cannot join this world.
    """
    setting = scenario.setting
    _invite(setting, world)
    journal = Journal() if store is None else Journal.create_file(store)
    try:
        with journal.together():
            # A run in memory is never resumed.
            start = b"" if store is None else encode_start(setting, name)
            journal.records.set_run(_record(scenario, world, seed, start))
            recording = Recording(setting, journal, seed, renderer, name)
            return Engine(recording, world, _reader_of(claims_from, recording)).begin()
    except BaseException:
        journal.close()
        raise


def _record(scenario: HasSetting, world: World, seed: int, start: bytes) -> RunRecord:
    condition = scenario.condition
    return RunRecord(
        scenario=scenario.setting.name,
        text=scenario.text,
        condition="" if condition is None else str(condition),
        seed=seed,
        versions={**own_versions(), **world.versions},
        setting=start,
        templates=scenario.templates,
    )


def resumed(
    store: str | Path,
    limits: ProcessLimits | None,
    worlds: Worlds | None,
    claims_from: ClaimsFrom | None = None,
    renderer: Renderer | None = None,
) -> Engine:
    """Continue a recorded run. The world starts when it is first needed.

    Raises:
        StoreError: There is no such run, it cannot be read or written, or another process writes to
            it.
    """
    journal = Journal.open(store)
    try:
        recording, name = read_recording(journal, renderer)
        if worlds is None:
            world = maker_of(name)(recording.seed, limits)
            if world.realtime is not None and world.realtime.host is not None:
                # People may join before anything else needs the world.
                world.start()
        else:
            world = worlds.lend(name)
        _invite(recording.setting, world)
        journal.records.add_versions(own_versions())
        return Engine(recording, world, _reader_of(claims_from, recording))
    except BaseException:
        journal.close()
        raise


def _invite(setting: Setting, world: World) -> None:
    """Let the people of a setting join. Raise InputError if they cannot join this world."""
    host = world.realtime
    if host is not None:
        host.invite(setting.people)
    elif setting.people:
        raise InputError(
            f"scenario {setting.name!r} has agents of type human "
            f"({', '.join(sorted(setting.people))}), and people cannot join this world; open it "
            "with Nest.open(..., realtime=True, listen=25565), run it with --realtime --listen "
            "25565, or play on a server, minecraft://HOST:PORT"
        )


@runtime_checkable
class _AsksModel(Protocol):
    """Hook that asks a model, as `claims_from_model` returns it."""

    @property
    def name(self) -> str:
        """The name of the model."""

    def through(self, wrap: "Callable[[Model], Model]") -> ClaimsFrom:
        """Return the same hook with its model replaced by `wrap(model)`."""


def _reader_of(hook: ClaimsFrom | None, recording: Recording) -> ClaimReader | None:
    """Return the reader that asks a hook in a nest; None if there is no hook.

    Raises:
        InputError: The hook cannot be called with three arguments: text, speaker, nameable.
    """
    if hook is None:
        return None
    own: object = hook
    if isinstance(own, _AsksModel):
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

    def __init__(self, hook: _AsksModel, recording: Recording) -> None:
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
