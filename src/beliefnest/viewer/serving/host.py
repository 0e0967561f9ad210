"""Runs that a server shows, and all their updates so far."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from threading import RLock
from typing import Any

import msgspec

from beliefnest.errors import InputError, StoreError
from beliefnest.nest.face.reader import Reader
from beliefnest.timeline.journal import TimelineKey
from beliefnest.viewer.page.reasons import explanation_of, look_of, sight_of
from beliefnest.viewer.page.run import About, RunData
from beliefnest.world.paths import BeliefPath, parse_path, path_text


class OpenRun(msgspec.Struct, frozen=True):
    """Run that is open for reading.

    Attributes:
        reader: Reader of the run, which may still grow.
        about: Names and texts about the run.
        close: Function that closes it.
    """

    reader: Reader
    about: About
    close: Callable[[], None]


@dataclass
class Host:
    """Host of runs that may grow; it answers queries about them. Use it in one thread at a time.

    Args:
        find: Lists the files of the present runs.
        open: Opens a run.
        depth: Depth of the beliefs that are recorded from the start.

    Attributes:
        told: All updates so far, each with the number of its run, in order. A page that connects
            late gets all of them.
    """

    find: Callable[[], Sequence[Path]]
    open: Callable[[Path], OpenRun]
    depth: int = 2
    told: list[tuple[int, dict[str, Any]]] = field(default_factory=list)
    _files: list[Path] = field(default_factory=list)
    _opened: list[OpenRun] = field(default_factory=list)
    _data: list[RunData] = field(default_factory=list)
    _turn: RLock = field(default_factory=RLock)

    def discover(self) -> list[StoreError]:
        """Open runs that have begun since; return why others cannot be read yet."""
        faults = []
        with self._turn:
            for file in self.find():
                if file in self._files:
                    continue
                try:
                    opened = self.open(file)
                    self._files.append(file)
                    self._opened.append(opened)
                    self._data.append(RunData(opened.reader, opened.about, self.depth))
                except StoreError as fault:
                    # A run that has just begun may be readable a moment later.
                    faults.append(fault)
        return faults

    def follow(self) -> int:
        """Read the updates of all runs; return the number of updates so far."""
        with self._turn:
            for number, data in enumerate(self._data):
                update = data.update()
                if update:
                    self.told.append((number, update))
            return len(self.told)

    def deepen(self, run: int, on: int, path: str) -> str:
        """Record one more node from now on; return its path.

        Raises:
            InputError: There is no such run or timeline, or the path is not below the timeline's.
            PathError: The path is malformed or names an unknown agent.
        """
        with self._turn:
            _, key, node = self._named(run, on, path)
            if node[: len(key.path)] != key.path:
                raise InputError(f"{path!r} is not below the timeline's own simulator")
            if len(node) > _DEEPEST:
                raise InputError(f"{path!r} is deeper than {_DEEPEST} agents")
            self._data[run].deepen(key, node)
            return path_text(node)

    def explain(self, run: int, on: int, path: str, tick: int, thing: str) -> dict[str, Any]:
        """Return the answer of `explanation_of`."""
        with self._turn:
            reader, key, node = self._named(run, on, path)
            return explanation_of(reader, key, node, tick, thing)

    def look(self, run: int, on: int, path: str, tick: int, viewer: str, thing: str) -> Any:
        """Return the answer of `look_of`."""
        with self._turn:
            reader, key, node = self._named(run, on, path)
            parse_path(f"/{viewer}", reader.agents)
            return look_of(reader, key, node, tick, viewer, thing)

    def sight(self, run: int, on: int, path: str, tick: int, viewer: str) -> list[int]:
        """Return the answer of `sight_of`."""
        with self._turn:
            reader, key, node = self._named(run, on, path)
            parse_path(f"/{viewer}", reader.agents)
            return sight_of(reader, key, node, tick, viewer)

    def close(self) -> None:
        """Close all runs."""
        with self._turn:
            for opened in self._opened:
                opened.close()
            self._opened.clear()
            self._data.clear()

    def _named(self, run: int, on: int, path: str) -> tuple[Reader, TimelineKey, BeliefPath]:
        if not 0 <= run < len(self._data):
            raise InputError(f"no run number {run}; there are {len(self._data)}")
        keys = self._data[run].keys()
        if not 0 <= on < len(keys):
            raise InputError(f"no timeline number {on}; there are {len(keys)}")
        reader = self._opened[run].reader
        return reader, keys[on], parse_path(path, reader.agents)


_DEEPEST = 8
"""Largest number of agents in a path that is requested over the network."""
