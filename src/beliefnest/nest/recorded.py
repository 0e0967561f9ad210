"""A recorded run, read-only: any simulator of it, on any branch, at any tick."""

from pathlib import Path
from typing import Self

from beliefnest.bodies.scripted import ScriptedBodies
from beliefnest.nest.engine import MAIN, Engine
from beliefnest.nest.nest import Past
from beliefnest.nest.paths import parse_path
from beliefnest.nest.runlog import FileLog
from beliefnest.nest.saved import decode_start
from beliefnest.nest.setting import Setting
from beliefnest.nest.simulator import PastSimulator
from beliefnest.timeline.journal import FOLLOW, Journal, TimelineKey
from beliefnest.timeline.records import ProgramRecord
from beliefnest.timeline.store import SqliteJournal

__all__ = ["RecordedNest"]


class RecordedNest:
    """Simulators of a run as they were; nothing in it can act.

    Args:
        setting: What the run started from.
        journal: What it recorded; the caller closes it.
    """

    def __init__(self, setting: Setting, journal: Journal) -> None:
        self._engine = Engine(setting, journal, ScriptedBodies(), 0)
        self._engine.selected[()] = TimelineKey((), MAIN)

    @classmethod
    def read(cls, store: str | Path) -> Self:
        """A run file as it was left, or as another process writes it, on its branches.

        Close it, or use it in a `with` block.

        Raises:
            StoreError: There is no such run, or it cannot be read.
        """
        journal = SqliteJournal.read(store)
        try:
            run = journal.records.run()
            setting, _ = decode_start(run.setting)
            log = FileLog(journal)
            nest = cls.__new__(cls)
            nest._engine = Engine(setting, journal, ScriptedBodies(), run.seed, log).resume()
        except BaseException:
            journal.close()
            raise
        return nest

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Close the run file."""
        self._engine.close()

    @property
    def setting(self) -> Setting:
        """What the run started from."""
        return self._engine.setting

    @property
    def agents(self) -> tuple[str, ...]:
        """Names of all agents, sorted."""
        return self._engine.agents

    def __getitem__(self, path: str) -> PastSimulator:
        """A simulator at the latest tick of its timeline.

        Raises:
            PathError: The path is malformed or names an unknown agent.
        """
        return self.simulator(path)

    def select(self, path: str, branch: str) -> None:
        """Read a simulator, and those below it, on one of its branches.

        Raises:
            PathError: The path is malformed or names an unknown agent.
            BranchError: The simulator has no such branch.
        """
        names = parse_path(path, self._engine.agents)
        if branch == FOLLOW and names:
            self._engine.selected.pop(names, None)
            return
        key = TimelineKey(names, branch)
        self._engine.journal.info(key)
        self._engine.selected[names] = key

    def head(self, path: str) -> int:
        """The latest tick of the timeline that a simulator is on."""
        return self._engine.info(parse_path(path, self._engine.agents)).head

    def changes(self, path: str) -> tuple[int, ...]:
        """The ticks with an entry on the timeline that a simulator is on, its own first one too."""
        info = self._engine.info(parse_path(path, self._engine.agents))
        entries = self._engine.journal.entries(info.key, 0, info.entries)
        return tuple(sorted({info.start, *(entry.tick for entry in entries)}))

    def branches(self) -> tuple[TimelineKey, ...]:
        """All timelines there are, in order of creation."""
        return tuple(info.key for info in self._engine.journal.timelines())

    def programs(self, path: str) -> tuple[ProgramRecord, ...]:
        """Programs that ran in a simulator on the branch it is on, in order of their end.

        In follow mode there are none; those that ran before the fork belong to another branch.
        """
        names = parse_path(path, self._engine.agents)
        branch = self._engine.info(names).key.branch
        noted = self._engine.log.programs()
        return tuple(
            each
            for each in noted
            if names in self._engine.selected and (each.path, each.branch) == (names, branch)
        )

    def at(self, tick: int) -> Past:
        """All simulators at a tick.

        Raises:
            TickError: The tick is in the future or before the start, when a state is read.
        """
        return Past(self._engine, tick)

    def simulator(self, path: str, tick: int | None = None) -> PastSimulator:
        """A simulator at a tick; None: at the latest one of its timeline."""
        return self.at(self.head(path) if tick is None else tick)[path]
