"""`beliefnest replay`: run the programs of recorded runs again and compare the results."""

import json
import sys
from collections.abc import Iterator
from pathlib import Path

import msgspec

from beliefnest.cli.folder import stores_in
from beliefnest.cli.terminal_text import say
from beliefnest.errors import InputError
from beliefnest.nest.acting.replay import ReplayedTimeline, replay
from beliefnest.nest.past.recording import read_start
from beliefnest.timeline.store import Journal
from beliefnest.world.paths import path_text
from beliefnest.world.texts import quoted
from beliefnest.world.words import counted
from beliefnest.worlds.by_name import Worlds
from beliefnest.worlds.servers.address import is_server
from beliefnest.worlds.servers.listening import is_hosted


def replay_runs(run: Path, *, as_json: bool) -> int:
    """Run all programs of a run or a study again, in a fresh world with the same seeds.

    Returns:
        0 if every frame is as recorded, else 1.

    Raises:
        BeliefNestError: There is no such run, it ran no programs, or the world failed.
    """
    same = True
    rows = []
    # One pool of worlds serves all seeds: a study has a seed for each of its many runs.
    with Worlds(0) as worlds:
        for store in stores_in(run):
            for replayed in _replayed(store, worlds):
                same = same and replayed.difference is None
                row = _row(store, replayed)
                rows.append(row)
                if not as_json:
                    say(_line(row) + "\n")
    if as_json:
        sys.stdout.write(json.dumps({"same": same, "timelines": rows}, indent=2) + "\n")
    return 0 if same else 1


def _replayed(store: Path, worlds: Worlds) -> Iterator[ReplayedTimeline]:
    with Journal.read(store) as journal, journal.unchanging():
        run = journal.records.run()
        setting, name = read_start(journal)
        programs = journal.records.programs()
        if name == "scripted" and not programs:
            raise InputError(
                f"{store} holds no programs to run again: events of a scripted world, a suite's "
                "story or an imported trace come from the user and cannot differ; replay a run in "
                "which programs ran"
            )
        if is_server(name) or is_hosted(name):
            raise InputError(
                f"{store} was played in real time, which cannot be repeated; "
                "replay a run in the embedded or the scripted world"
            )
        world = worlds.lend(name)
        try:
            yield from replay(setting, journal, programs, world, run.seed)
        finally:
            world.close()


def _row(store: Path, replayed: ReplayedTimeline) -> dict[str, object]:
    first = replayed.difference
    return {
        "store": str(store),
        "path": path_text(replayed.key.path),
        "branch": replayed.key.branch,
        "programs": replayed.programs,
        "difference": None if first is None else msgspec.to_builtins(first, str_keys=True),
    }


def _line(row: dict[str, object]) -> str:
    programs = counted(int(str(row["programs"])), "program")
    place = f"{row['store']}: {row['path']} {quoted(row['branch'])}, {programs}"
    match row["difference"]:
        case {"tick": tick, "entry": entry, "field": field, "recorded": old, "found": new}:
            where = f"tick {tick}, {field or f'entry {entry}'}"
            return f"{place}: differs at {where}: recorded {quoted(old)}, now {quoted(new)}"
        case _:
            return f"{place}: no difference"
