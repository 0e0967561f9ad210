"""Recorded run, read-only: any simulator, on any branch, at any tick."""

from collections.abc import Iterator
from pathlib import Path
from typing import Self

from beliefnest.nest.face.base import NestBase
from beliefnest.nest.face.given import tick_of
from beliefnest.nest.face.shown import Past, PastSimulator
from beliefnest.nest.past.over_time import Moment, over_time
from beliefnest.nest.past.recording import read_recording
from beliefnest.timeline.journal import FOLLOW, TimelineKey
from beliefnest.timeline.store import Journal
from beliefnest.world.paths import parse_path


class RecordedNest(NestBase):
    """Read-only nest of a recorded run.

    A belief path that is malformed, or names an unknown agent, raises PathError.

    Args:
        journal: The run file. Closing the nest closes it too.

    Raises:
        StoreError: The file cannot be read.
    """

    def __init__(self, journal: Journal) -> None:
        self._recording, _ = read_recording(journal)

    @classmethod
    def read(cls, store: str | Path) -> Self:
        """Return the nest of a run file, on the branches that were selected last.

        Another process may still write the file. Close the nest, or use it in a `with` block.

        Raises:
            StoreError: There is no such run, or it cannot be read.
        """
        journal = Journal.read(store)
        try:
            return cls(journal)
        except BaseException:
            journal.close()
            raise

    def close(self) -> None:
        """Close the run file."""
        self._recording.close()

    def __getitem__(self, path: str) -> PastSimulator:
        """Return a simulator at the latest tick of its timeline."""
        return self.simulator(path)

    def select(self, path: str, branch: str) -> None:
        """Select the branch on which a simulator, and those below it, are read.

        Raises:
            BranchError: The simulator has no such branch.
        """
        names = parse_path(path, self.agents)
        if branch == FOLLOW and names:
            self._recording.selected.pop(names, None)
            return
        key = TimelineKey(names, branch)
        self._recording.journal.info(key)
        self._recording.selected[names] = key

    def branch(self, path: str) -> str:
        """Return the branch on which a simulator is read; `follow` in follow mode."""
        key = self._recording.selected.get(parse_path(path, self.agents))
        return FOLLOW if key is None else key.branch

    def head(self, path: str) -> int:
        """Return the latest tick of a simulator's timeline."""
        return self._recording.info(parse_path(path, self.agents)).head

    def ticks(self, path: str) -> tuple[int, ...]:
        """Return the first tick of a simulator's timeline, and all ticks with an entry.

        Ticks before a fork belong to another timeline.
        """
        info = self._recording.info(parse_path(path, self.agents))
        entries = self._recording.journal.entries(info.key, 0, info.entries)
        return (info.start, *(entry.tick for entry in entries))

    def over_time(self, path: str) -> Iterator[Moment]:
        """Yield a simulator at every tick with a change, on each timeline it has or can follow."""
        return over_time(self._recording, parse_path(path, self.agents))

    def branches(self) -> tuple[TimelineKey, ...]:
        """Return all timelines, in order of creation."""
        return tuple(info.key for info in self._recording.journal.timelines())

    def at(self, tick: int) -> Past:
        """Return all simulators at a tick.

        Raises:
            TickError: The tick is not a whole number. When a state is read: the tick is in the
                future of that simulator's timeline, or before the start.
        """
        return Past(self._recording, tick_of(tick))

    def simulator(self, path: str, tick: int | None = None) -> PastSimulator:
        """Return a simulator at a tick; None: at the latest one of its timeline."""
        return self.at(self.head(path) if tick is None else tick)[path]
