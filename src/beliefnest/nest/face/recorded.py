"""A recorded run, read-only: any simulator of it, on any branch, at any tick."""

from collections.abc import Iterator
from pathlib import Path
from typing import Self

from beliefnest.nest.face.base import NestBase
from beliefnest.nest.face.shown import Past, PastSimulator
from beliefnest.nest.face.ticks import tick_of
from beliefnest.nest.past.over_time import Moment, over_time
from beliefnest.nest.past.recording import read_recording
from beliefnest.timeline.journal import FOLLOW, TimelineKey
from beliefnest.timeline.store import SqliteJournal
from beliefnest.world.paths import parse_path

__all__ = ["RecordedNest"]


class RecordedNest(NestBase):
    """Simulators of a run as they were; nothing in it can act.

    A belief path that is malformed, or names an unknown agent, raises PathError.

    Args:
        journal: The run file; whoever closes it or the nest closes both.

    Raises:
        StoreError: It cannot be read.
    """

    def __init__(self, journal: SqliteJournal) -> None:
        self._recording, _ = read_recording(journal)

    @classmethod
    def read(cls, store: str | Path) -> Self:
        """Return a run file as it was left, or as another process writes it, on its branches.

        Close it, or use it in a `with` block.

        Raises:
            StoreError: There is no such run, or it cannot be read.
        """
        journal = SqliteJournal.read(store)
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
        """Read a simulator, and those below it, on one of its branches.

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
        """Return the name of the branch that a simulator is read on; `follow` in follow mode."""
        key = self._recording.selected.get(parse_path(path, self.agents))
        return FOLLOW if key is None else key.branch

    def head(self, path: str) -> int:
        """Return the latest tick of the timeline that a simulator is on."""
        return self._recording.info(parse_path(path, self.agents)).head

    def ticks(self, path: str) -> tuple[int, ...]:
        """Return the ticks at which anything happened on the timeline that a simulator is on.

        Those before a fork belong to another timeline; the first one is the fork's.
        """
        info = self._recording.info(parse_path(path, self.agents))
        entries = self._recording.journal.entries(info.key, 0, info.entries)
        return (info.start, *(entry.tick for entry in entries))

    def over_time(self, path: str) -> Iterator[Moment]:
        """A simulator at every tick with a change, on every timeline that it has or can follow."""
        return over_time(self._recording, parse_path(path, self.agents))

    def branches(self) -> tuple[TimelineKey, ...]:
        """Return all timelines there are, in order of creation."""
        return tuple(info.key for info in self._recording.journal.timelines())

    def at(self, tick: int) -> Past:
        """Return all simulators at a tick.

        Raises:
            TickError: The tick is no whole number; or, when a state is read, it is in the future of
                that simulator's timeline or before the start.
        """
        return Past(self._recording, tick_of(tick))

    def simulator(self, path: str, tick: int | None = None) -> PastSimulator:
        """Return a simulator at a tick; None: at the latest one of its timeline."""
        return self.at(self.head(path) if tick is None else tick)[path]
