"""How a nest is opened, in a new run or in one that was recorded."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol, Self

from beliefnest.bodies.address import is_server
from beliefnest.bodies.limits import ProcessLimits
from beliefnest.bodies.listening import is_hosted
from beliefnest.bodies.protocol import World
from beliefnest.bodies.worlds import LazyWorld, Worlds, joined_of, open_world
from beliefnest.errors import InputError
from beliefnest.nest.acting.engine import Engine
from beliefnest.nest.face.hearing_model import reader_of
from beliefnest.nest.past.recording import Recording, read_recording
from beliefnest.nest.past.setting import Setting
from beliefnest.nest.past.setting_codec import encode_start
from beliefnest.nest.past.versions import own_versions
from beliefnest.prompts import Renderer
from beliefnest.timeline.memory import MemoryJournal
from beliefnest.timeline.records import RunJournal, RunRecord
from beliefnest.timeline.store import SqliteJournal
from beliefnest.world.nameable import ClaimsFrom

__all__ = ["HasSetting", "RunStart", "begun", "resumed"]


class HasSetting(Protocol):
    """Something a nest can open: a scenario with its condition chosen."""

    @property
    def setting(self) -> Setting:
        """What the nest starts from."""

    @property
    def text(self) -> str:
        """The text of the scenario's file, for the record; empty if there is none."""

    @property
    def templates(self) -> Mapping[str, str]:
        """Texts of the prompt templates that the file names, for the record."""

    @property
    def condition(self) -> int | None:
        """Number of the chosen condition; None if there is none."""


@dataclass(frozen=True, slots=True)
class RunStart:
    """What a run is started with.

    Attributes:
        setting: What the nest starts from.
        world: Name of the world.
        seed: Drives every random number.
        text: The text of the scenario's file.
        templates: Texts of the prompt templates that it names.
        condition: Number of its chosen condition.
    """

    setting: Setting
    world: str
    seed: int
    text: str = ""
    templates: Mapping[str, str] = field(default_factory=dict)
    condition: int | None = None

    @classmethod
    def of(cls, scenario: HasSetting | Setting, world: str, seed: int) -> Self:
        """What a run of a scenario is started with.

        Raises:
            InputError: It is a name, or something else.
        """
        if isinstance(scenario, Setting):
            return cls(scenario, world, seed)
        if not hasattr(scenario, "setting"):
            raise InputError(
                f"{scenario!r} is no scenario; give a loaded one: bn.Scenario.load({scenario!r})"
            )
        return cls(
            scenario.setting, world, seed, scenario.text, scenario.templates, scenario.condition
        )

    def record(self, world: World) -> RunRecord:
        """What the run file keeps of it."""
        return RunRecord(
            scenario=self.setting.name,
            text=self.text,
            condition="" if self.condition is None else str(self.condition),
            seed=self.seed,
            versions={**own_versions(), **world.versions},
            setting=encode_start(self.setting, self.world),
            templates=self.templates,
        )


def begun(
    start: RunStart,
    world: World,
    store: str | Path | None,
    claims_from: ClaimsFrom | None = None,
    renderer: Renderer | None = None,
) -> Engine:
    """Begin a run in a world, in a file or in memory; `claims_from` reads what is said in it.

    Prompts are filled by `renderer`; None: by one of its own.

    Raises:
        StoreError: The file exists already, or cannot be written.
        BodyError: The world could not be started.
        InputError: People are to be in it, and cannot join this world.
    """
    _invite(start.setting, world)
    journal: RunJournal = MemoryJournal() if store is None else SqliteJournal.create_file(store)
    try:
        with journal.together():
            journal.records.set_run(start.record(world))
            recording = Recording(start.setting, journal, start.seed, renderer)
            return Engine(recording, world, reader_of(claims_from, recording)).begin()
    except BaseException:
        journal.close()
        raise


def resumed(
    store: str | Path,
    limits: ProcessLimits | None,
    worlds: Worlds | None,
    claims_from: ClaimsFrom | None = None,
) -> Engine:
    """Go on with a recorded run; the world is started when it is first needed.

    Raises:
        StoreError: There is no such run, it cannot be read or written, or has another writer.
    """
    journal = SqliteJournal.open(store)
    try:
        recording, name = read_recording(journal)
        if worlds is not None:
            world = worlds.lend(name)
        elif is_hosted(name) or (is_server(name) and recording.setting.people):
            # People may join before anything else needs it.
            world = open_world(name, recording.seed, limits)
        else:
            world = LazyWorld(name, recording.seed, limits)
        _invite(recording.setting, world)
        journal.records.add_versions(own_versions())
        return Engine(recording, world, reader_of(claims_from, recording))
    except BaseException:
        journal.close()
        raise


def _invite(setting: Setting, world: World) -> None:
    """Let the people of a setting join, or refuse a world that they cannot."""
    host = joined_of(world)
    if host is not None:
        host.invite(setting.people)
    elif setting.people:
        raise InputError(
            f"{' and '.join(sorted(setting.people))} in {setting.name!r} is of type human, and "
            "people cannot join this world; open it with "
            "Nest.open(..., realtime=True, listen=25565), run it with --realtime --listen 25565, "
            "or play on a server: minecraft://HOST:PORT"
        )
