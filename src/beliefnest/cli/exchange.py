"""`beliefnest export` and `beliefnest import`: runs as tables, traces as runs."""

from collections.abc import Iterator, Sequence
from itertools import chain
from pathlib import Path
from typing import cast, get_args

from beliefnest.belief.plain import belief_json, place_key
from beliefnest.cli.folder import store_in
from beliefnest.cli.options import ExportOptions
from beliefnest.cli.terminal_text import say
from beliefnest.episodes.telling import goal_rows, round_rows, told_episode
from beliefnest.errors import InputError
from beliefnest.nest.face.recorded import RecordedNest
from beliefnest.nest.past.trace_import import import_trace
from beliefnest.timeline.export import ExportForm, export
from beliefnest.timeline.export_tables import BeliefRow, TableRow, program_row, prompt_row, run_row
from beliefnest.timeline.run_records import Records
from beliefnest.timeline.store import Journal
from beliefnest.timeline.trace import load_trace
from beliefnest.world.paths import parse_path, path_text
from beliefnest.world.registry import Registry


def export_run(options: ExportOptions) -> None:
    """Write a run as tables, and print the number of rows of each.

    Raises:
        BeliefNestError: There is no such run, path or format, or the folder cannot be written.
    """
    if options.format not in get_args(ExportForm):
        raise InputError(
            f"there is no format {options.format!r}; there are {', '.join(get_args(ExportForm))}"
        )
    store, paths = store_in(options.run), options.path or ()
    # The run may still be recorded: read all tables from one moment.
    with Journal.read(store) as journal, journal.unchanging():
        nest = RecordedNest(journal)
        for path in paths:
            parse_path(path, nest.agents)
        counts = export(
            journal,
            cast(ExportForm, options.format),
            options.out,
            registry=Registry.load(),
            first=nest.setting.snapshot,
            beliefs=_beliefs(nest, paths),
            notes=chain(_notes(journal.records), _rounds(nest)),
        )
    for table, count in counts.items():
        say(f"{table}: {count}\n")


def _notes(records: Records) -> Iterator[TableRow]:
    yield run_row(records.run(), records.versions())
    yield from map(program_row, records.programs())
    yield from map(prompt_row, records.prompts())


def _rounds(nest: RecordedNest) -> Iterator[TableRow]:
    """Yield the decisions of an episode's rounds, and the tick at which its goal was reached."""
    episode = told_episode(nest)
    if episode is not None:
        yield from (("rounds", row) for row in round_rows(episode))
        yield from (("goals", row) for row in goal_rows(episode))


def _beliefs(nest: RecordedNest, paths: Sequence[str]) -> Iterator[BeliefRow]:
    for path in dict.fromkeys(parse_path(path, nest.agents) for path in paths):
        for moment in nest.over_time(path_text(path)):
            blocks = {place_key(place): block for place, block in moment.blocks.items()}
            state = belief_json(moment.state)
            yield BeliefRow(path, moment.timeline, moment.tick, state, blocks)


def import_run(trace: Path, out: Path) -> None:
    """Make a run file from a trace that another program wrote.

    Raises:
        BeliefNestError: The trace has bad lines, or the file exists or cannot be written.
    """
    loaded = load_trace(trace, Registry.load())
    import_trace(loaded, trace.stem, out)
    say(f"{out}: {len(loaded.entries)} ticks with changes, {len(loaded.agents)} agents\n")
