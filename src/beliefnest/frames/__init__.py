"""Contents of runs and studies as pandas data frames, with ids to join them."""

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from beliefnest.belief.plain import belief_json
from beliefnest.episodes.measures import Measures
from beliefnest.episodes.telling import round_rows, told_episode
from beliefnest.errors import InputError
from beliefnest.frames.sources import FrameSource, RecordedCell, cells_of, study_of
from beliefnest.nest.face.recorded import RecordedNest
from beliefnest.studies.kinds import EPISODE_KIND
from beliefnest.studies.plainframe import Typed, plain_frame
from beliefnest.studies.result import StudyResult
from beliefnest.timeline.export_tables import entry_rows, prompt_row
from beliefnest.timeline.store import Journal
from beliefnest.world.frames import Frame
from beliefnest.world.paths import path_text
from beliefnest.world.registry import Registry

if TYPE_CHECKING:  # Tables are an extra, imported when one is made.
    import pandas

__all__ = [
    "beliefs_df",
    "cells_df",
    "claims_df",
    "episodes_df",
    "events_df",
    "probes_df",
    "requests_df",
    "rounds_df",
]

FrameRow = dict[str, Any]


def cells_df(source: FrameSource) -> "pandas.DataFrame":
    """Return one row per cell: its settings, `ok`, `error`, `ticks`, `probes`, `right`, `run`.

    Args:
        source: A run file, the folder of a run or a study, or a study's result.

    Raises:
        InputError: The source holds neither a run nor a study.
        MissingExtraError: pandas is not installed.
    """
    return _frame((_cell_row(each) for each in cells_of(source)), ["cell"])


def episodes_df(source: FrameSource | Iterable[Measures]) -> "pandas.DataFrame":
    """Return one row per episode: its settings, success, ticks, messages and other measures.

    Args:
        source: A study of episodes (a folder or a result), whose rows also have `cell`; or
            measures, as of `Episode.measures`.

    Raises:
        InputError: The source is not a study of episodes.
        MissingExtraError: pandas is not installed.
    """
    if not isinstance(source, str | Path | StudyResult):
        rows = ({key: _plain(v) for key, v in each.row().items()} for each in source)
        return _frame(rows, ["task", "task_seed", "policies"])
    study = study_of(source)
    if study is None or study.kind is not EPISODE_KIND:
        raise InputError(f"there is no study of episodes at {source}")
    return _frame(iter(study.rows), ["cell"])


def rounds_df(source: FrameSource) -> "pandas.DataFrame":
    """Return one row for each agent in each round of episodes.

    The columns `cell`, `branch`, `round` and `agent` identify a row. The others are its policy,
    its program and the program's result. Arguments and errors as for `requests_df`.
    """
    return _frame(_recorded(source, _rounds), ["cell", "branch", "round", "agent"])


def probes_df(source: FrameSource) -> "pandas.DataFrame":
    """Return one row per probe: `cell`, `probe` (its name in requests and branches), `ok`, ...

    Arguments and errors as for `cells_df`. A run file without its folder has no probes.
    """
    rows = (
        {
            "cell": each.cell,
            "probe": f"probe {number}",
            **{key: _plain(value) for key, value in probe.items() if key != "run_dir"},
        }
        for each in cells_of(source)
        for number, probe in enumerate(each.about.get("probes", []), start=1)
    )
    return _frame(rows, ["cell", "probe"])


def requests_df(source: FrameSource) -> "pandas.DataFrame":
    """Return one row per request to a model: `cell`, `request`, `probe`, messages, answer.

    Arguments and errors as for `cells_df`. Cells of a study that were not recorded have no rows.
    """
    return _frame(_recorded(source, _requests), ["cell", "request"])


def events_df(source: FrameSource) -> "pandas.DataFrame":
    """Return one row per event: its place, `tick`, `kind`, `actor` and details.

    The columns `cell`, `path`, `branch`, `entry` and `number` identify a row. Arguments and
    errors as for `requests_df`.
    """
    return _frame(_recorded(source, _events), ["cell", "path", "branch", "entry", "number"])


def claims_df(source: FrameSource, paths: Sequence[str] | None = None) -> "pandas.DataFrame":
    """Return one row per claim and belief: if the claim was taken up there, and why.

    Args:
        source: As for `requests_df`.
        paths: Belief paths; None for the belief of each agent.

    Raises:
        PathError: A path is malformed or names an unknown agent.
        InputError: The source holds neither a run nor a study.
        MissingExtraError: pandas is not installed.
    """
    return _frame(
        _recorded(source, lambda journal: _claims(journal, paths)), ["cell", "claim", "path"]
    )


def beliefs_df(source: FrameSource, paths: Sequence[str]) -> "pandas.DataFrame":
    """Return one row per known container and agent of a belief, at each tick with a change.

    Args:
        source: As for `requests_df`.
        paths: Belief paths; `/` is the real world.

    Raises:
        PathError: A path is malformed or names an unknown agent.
        InputError: The source holds neither a run nor a study.
        MissingExtraError: pandas is not installed.
    """
    return _frame(
        _recorded(source, lambda journal: _beliefs(journal, paths)), ["cell", "path", "tick"]
    )


def _cell_row(recorded: RecordedCell) -> FrameRow:
    about = recorded.about
    probes = about.get("probes", [])
    usages = [probe["usage"] for probe in probes]
    variation = about.get("variation", {})
    kept = ("scenario", "condition", "model", "template", "repeat", "seed", "error", "ticks")
    if "task" in about:
        kept = ("task", "condition", "player", "order", "instance", "repeat", "seed", "error")
    return {
        "cell": recorded.cell,
        **{key: about.get(key) for key in kept},
        **{key: _plain(value) for key, value in variation.items()},
        "probes": len(probes),
        "right": sum(probe["ok"] is True for probe in probes),
        "tokens": sum(each["input_tokens"] + each["output_tokens"] for each in usages),
        "run": None if recorded.file is None else str(recorded.file),
    }


def _recorded(source: FrameSource, rows: Any) -> Iterator[FrameRow]:
    """Yield the rows of every recorded cell; each run file is read in one consistent state."""
    cells = list(cells_of(source))
    if cells and all(each.file is None for each in cells):
        raise InputError(
            "the study recorded no runs, so that it has only cells and probes; run it again in "
            "another folder with record=True or `beliefnest study --record`"
        )
    for each in cells:
        if each.file is None:
            continue
        if not Path(each.file).is_file():
            raise InputError(
                f"the run file {each.file} of the cell {each.cell} is missing; restore it"
            )
        with Journal.read(each.file) as journal, journal.unchanging():
            for row in rows(journal):
                yield {"cell": each.cell, **row}


def _requests(journal: Journal) -> Iterator[FrameRow]:
    for number, prompt in enumerate(journal.records.prompts(), start=1):
        _, row = prompt_row(prompt)
        detail = row.pop("detail")
        plain = {key: _plain(value) for key, value in row.items()}
        yield {
            "request": number,
            "probe": detail.get("probe"),
            "task": detail.get("task"),
            "branch": prompt.branch,
            **plain,
        }


def _events(journal: Journal) -> Iterator[FrameRow]:
    registry = Registry.load()
    for info in journal.timelines():
        for number, entry in enumerate(journal.entries(info.key, 0, info.entries)):
            if isinstance(entry, Frame) and entry.events:
                for table, row in entry_rows(info.key, number, entry, registry):
                    if table == "events":
                        yield {key: _plain(value) for key, value in row.items()}


def _rounds(journal: Journal) -> Iterator[FrameRow]:
    episode = told_episode(RecordedNest(journal))
    return iter(()) if episode is None else round_rows(episode)


def _claims(journal: Journal, paths: Sequence[str] | None) -> Iterator[FrameRow]:
    nest = RecordedNest(journal)
    asked = [path_text((name,)) for name in nest.agents] if paths is None else paths
    for number, claim in enumerate(nest.claims(), start=1):
        for path in asked:
            yield {
                "claim": number,
                "tick": claim.tick,
                "speaker": claim.speaker,
                "addressee": claim.addressee,
                "text": claim.text,
                **{key: _plain(value) for key, value in _claim(claim.claim.plain()).items()},
                "false": claim.false,
                "lie": claim.lie,
                "path": path,
                "taken_up": claim.taken_up(path),
                "why": claim.why(path),
            }


def _claim(plain: Mapping[str, Any]) -> FrameRow:
    return {key: plain.get(key) for key in ("kind", "place", "item", "agent", "state")}


def _beliefs(journal: Journal, paths: Sequence[str]) -> Iterator[FrameRow]:
    nest = RecordedNest(journal)
    for path in paths:
        for moment in nest.over_time(path):
            state: Any = belief_json(moment.state)
            place = {
                "path": path,
                "timeline_path": path_text(moment.timeline.path),
                "timeline_branch": moment.timeline.branch,
                "tick": moment.tick,
            }
            for kind, key in (("container", "containers"), ("agent", "agents")):
                for subject, belief in state[key].items():
                    yield {**place, "kind": kind, "subject": subject, **_held(belief)}


def _held(belief: Mapping[str, Any]) -> FrameRow:
    items = belief.get("items", belief.get("inventory"))
    return {
        "items": _plain(items),
        "complete": belief.get("complete", belief.get("inventory_complete")),
        "position": _plain(belief.get("position")),
        "current": belief["current"],
        "observed_at": belief["observed_at"],
        "source": belief["source"],
    }


def _plain(value: Any) -> Any:
    """Return a value for a cell of the data frame: structures as JSON."""
    if isinstance(value, list | dict | tuple):
        return json.dumps(value, sort_keys=True)
    return value


def _frame(rows: Iterator[FrameRow], ids: Sequence[str]) -> "pandas.DataFrame":
    table_rows = list(rows)
    columns = dict.fromkeys([*ids, *(key for row in table_rows for key in row)])
    return plain_frame({name: Typed([row.get(name) for row in table_rows]) for name in columns})
