"""Opening of nests, for new runs and for recorded ones."""

from collections.abc import Mapping
from pathlib import Path
from typing import Protocol

import msgspec

from beliefnest.errors import InputError
from beliefnest.nest.acting.engine import Engine
from beliefnest.nest.face.hearing_model import reader_of
from beliefnest.nest.past.recording import Recording, read_recording
from beliefnest.nest.past.setting import Setting
from beliefnest.nest.past.setting_codec import encode_start
from beliefnest.nest.past.versions import own_versions
from beliefnest.prompts import Renderer
from beliefnest.timeline.run_records import RunRecord
from beliefnest.timeline.store import Journal
from beliefnest.world.nameable import ClaimsFrom
from beliefnest.worlds.by_name import Worlds
from beliefnest.worlds.names import maker_of
from beliefnest.worlds.process_limits import ProcessLimits
from beliefnest.worlds.protocol import World


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
            return Engine(recording, world, reader_of(claims_from, recording)).begin()
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
        return Engine(recording, world, reader_of(claims_from, recording))
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
