"""Import of traces of other programs into run files."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from beliefnest.nest.past.setting import MAIN, Setting
from beliefnest.nest.past.setting_codec import encode_start
from beliefnest.nest.past.versions import own_versions
from beliefnest.timeline.journal import TimelineKey
from beliefnest.timeline.run_records import RunRecord
from beliefnest.timeline.store import Journal
from beliefnest.timeline.trace import Trace, record_trace


def import_trace(trace: Trace, name: str, store: str | Path) -> None:
    """Write a trace to a run file, which can be read and resumed as any other.

    Args:
        trace: The trace.
        name: Name of the run.
        store: Path of the new file.

    Raises:
        StoreError: The file exists or cannot be written.
    """
    absent = frozenset(trace.agents) - trace.first.agents.keys()
    setting = Setting(
        name,
        trace.first,
        trace.perception,
        static_blocks=trace.static_blocks,
        absent=absent,
        unique=trace.unique,
    )
    key = TimelineKey((), MAIN)
    with _kept_whole(Journal.create_file(store)) as journal, journal.together():
        journal.records.set_run(
            RunRecord(
                scenario=name,
                text="",
                condition="",
                seed=0,
                versions=own_versions(),
                setting=encode_start(setting, "scripted"),
            )
        )
        record_trace(trace, journal, key)
        journal.records.select(key.path, key.branch)


@contextmanager
def _kept_whole(journal: Journal) -> Iterator[Journal]:
    """Close a new run file at the end. Delete it if anything raises."""
    path = journal.path
    try:
        with journal:
            yield journal
    except BaseException:
        for end in ("", "-wal", "-shm"):
            path.with_name(path.name + end).unlink(missing_ok=True)
        raise
