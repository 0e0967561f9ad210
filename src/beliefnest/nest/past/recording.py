"""Recorded past of one nest: its timelines, the selected ones, and any state from them.

Nothing here acts in a world. `nest/acting` appends to the journal and changes the selection.
States, explanations and recorded runs only read.
"""

from collections.abc import Iterable, Mapping
from contextlib import suppress
from copy import copy
from threading import RLock
from typing import Self

from beliefnest.belief.context import BeliefContext
from beliefnest.errors import BranchError, StoreError, TickError
from beliefnest.nest.past.history import StateHistory
from beliefnest.nest.past.setting import MAIN, Setting
from beliefnest.nest.past.setting_codec import decode_start
from beliefnest.nest.past.summed_state import StateSums
from beliefnest.nest.past.timeline_state import TimelineState
from beliefnest.owned import Barred, Owned, is_own
from beliefnest.prompts import Renderer
from beliefnest.prompts.mind_view import ToldMind
from beliefnest.timeline.bounds import RunBounds
from beliefnest.timeline.journal import FOLLOW, ForkPoint, TimelineInfo, TimelineKey
from beliefnest.timeline.run_records import Records
from beliefnest.timeline.store import Journal
from beliefnest.world.paths import BeliefPath, path_text
from beliefnest.world.registry import Registry
from beliefnest.world.values import Box


class Turn(Owned):
    """Lock that a thread holds while it uses a nest: a reentrant context manager.

    Raises:
        ForkedError: Another process opened the nest.
    """

    def __init__(self) -> None:
        super().__init__()
        self._lock = RLock()

    def __enter__(self) -> None:
        # Check the process first: after a fork the lock may be held by a thread that the child
        # does not have.
        self.check_own("the nest")
        self._lock.acquire()

    def __exit__(self, *_: object) -> None:
        if self.is_own:
            self._lock.release()


class Recording(Barred):
    """Timelines and states of one nest.

    Attributes:
        setting: The setting from which the nest started.
        journal: The timelines, and notes of the programs and requests that ran.
        seed: Seed of every random number of the nest.
        renderer: Renderer of prompts.
        history: History that computes nodes from the journal.
        selected: The timeline of every simulator in control mode, by path.
        turn: Lock of the thread that uses the nest.
        world: Name of the world in which the nest was opened.
        remembered: Caches of readers, by keys of their own.
        sums: Sums of an imagined history, by path of its simulator.
        told: Observations and names that were read last, by path, moment and generation.
    """

    _called = "the nest"

    def __init__(
        self,
        setting: Setting,
        journal: Journal,
        seed: int = 0,
        renderer: Renderer | None = None,
        world: str = "scripted",
    ) -> None:
        self.setting = setting
        self.world = world
        self.remembered: dict[object, object] = {}
        self.sums: Mapping[BeliefPath, StateSums] = {}
        self.told: dict[tuple[BeliefPath, ForkPoint, int], ToldMind] = {}
        self.journal = journal
        self.seed = seed
        self.renderer = Renderer() if renderer is None else renderer
        self.turn = Turn()
        self.history = StateHistory(journal, setting, self.turn)
        self.selected: dict[BeliefPath, TimelineKey] = {(): TimelineKey((), MAIN)}
        self._latest: tuple[TimelineInfo, ForkPoint] | None = None

    @property
    def agents(self) -> tuple[str, ...]:
        """All agents, sorted."""
        return self.context.agents

    @property
    def context(self) -> BeliefContext:
        """The part that all nodes share."""
        return self.history.context

    @property
    def box(self) -> Box:
        """The box of the world."""
        return self.setting.snapshot.box

    @property
    def records(self) -> Records:
        """The notes of programs and of requests to models, with their results."""
        return self.journal.records

    def on(self, key: TimelineKey) -> Self:
        """Return the recording with one timeline selected.

        The simulators below that timeline's own follow it: none of them has another selected.
        """
        other = copy(self)
        above = {p: k for p, k in self.selected.items() if key.path[: len(p)] == p}
        other.selected, other.sums = {**above, key.path: key}, {}
        return other

    def following(self, path: BeliefPath) -> Self:
        """Return the recording with the simulators of a path and below in follow mode."""
        other = copy(self)
        other.selected = {p: k for p, k in self.selected.items() if p[: len(path)] != path}
        other.sums = {}
        return other

    def controller(self, path: BeliefPath) -> TimelineKey:
        """Return the timeline of the nearest simulator in control mode, the node itself included.

        Raises:
            BranchError: The nest was not opened.
        """
        for depth in range(len(path), -1, -1):
            if path[:depth] in self.selected:
                return self.selected[path[:depth]]
        raise BranchError("this nest was not opened: create it with Nest.open or Nest(world)")

    def info(self, path: BeliefPath) -> TimelineInfo:
        """Return the timeline that a node's state comes from."""
        return self.journal.info(self.controller(path))

    def place_of(self, key: TimelineKey, tick: int) -> tuple[TimelineKey, int]:
        """Return the timeline or base that contains a tick, and its number of entries until then.

        Raises:
            TickError: The tick lies before the first one.
        """
        info = self.journal.info(key)
        while tick < info.start:
            if info.base is None:
                raise TickError(f"tick {tick} is before the start, which is tick {info.start}")
            key = info.base.timeline
            info = self.journal.info(key)
        return key, self.journal.entries_until(key, tick)

    def stretches(self, moment: ForkPoint) -> list[ForkPoint]:
        """Return the timelines that lead to a moment, oldest first.

        Each one is given up to the point where the next begins.
        """
        points = [moment]
        while (base := self.journal.info(points[-1].timeline).base) is not None:
            points.append(base)
        return points[::-1]

    def moment(self, path: BeliefPath, tick: int | None = None) -> ForkPoint:
        """Return the point of a timeline from which a node's state comes, now or at a past tick.

        Raises:
            TickError: The tick is in the future, or before the start of everything.
        """
        info = self.info(path)
        if tick is None:
            # Kept, because callers ask for hundreds of nodes one after the other.
            if self._latest is None or self._latest[0] is not info:
                self._latest = info, ForkPoint(info.key, info.entries, info.head)
            return self._latest[1]
        if tick > info.head:
            raise TickError(f"tick {tick} is in the future; {path_text(path)} is at {info.head}")
        return ForkPoint(*self.place_of(info.key, tick), tick)

    def state(self, path: BeliefPath, tick: int | None = None) -> TimelineState:
        """Return the state of a node now, or at a past tick; raises as `moment` does."""
        if (sums := self.sums.get(path)) is not None and (state := sums.state(tick)) is not None:
            return state
        moment = self.moment(path, tick)
        return self.history.state(moment.timeline, path, moment.entries, moment.tick)

    def states(self, paths: Iterable[BeliefPath]) -> Mapping[BeliefPath, TimelineState]:
        """Return the states of several nodes now, by path."""
        wanted = list(paths)
        together: dict[TimelineKey, list[BeliefPath]] = {}
        for path in wanted:
            together.setdefault(self.controller(path), []).append(path)
        for key, nodes in together.items():
            self.history.expect(key, nodes)
        return {path: self.state(path) for path in wanted}

    def close(self) -> None:
        """Save checkpoints for later readers, and close the journal.

        Do nothing in a forked child: the journal belongs to its parent.
        """
        if not is_own(self):
            return
        try:
            # Without these checkpoints the run reads the same, only more slowly.
            with suppress(StoreError):
                self.history.close()
        finally:
            self.journal.close()


def read_start(journal: Journal) -> tuple[Setting, str]:
    """Return the setting of a run file, and the name of its world; bound what is read after it.

    Raises:
        StoreError: The file cannot be read, or the run was stopped before it had begun.
    """
    setting, world = decode_start(journal.records.run().setting)
    agents = frozenset({*setting.snapshot.agents, *setting.absent})
    journal.keep_within(RunBounds(setting.snapshot.box, agents, Registry.load()))
    return setting, world


def read_recording(journal: Journal, renderer: Renderer | None = None) -> tuple[Recording, str]:
    """Return the recording of a run file as it was left, and the name of its world.

    Args:
        journal: The run file.
        renderer: Renderer of prompts; None: a new one.

    Raises:
        StoreError: The file cannot be read, or the run was stopped before it had begun.
    """
    setting, world = read_start(journal)
    recording = Recording(setting, journal, journal.records.run().seed, renderer, world)
    recording.selected = {
        path: journal.info(TimelineKey(path, branch)).key
        for path, branch in journal.records.selected().items()
        if branch != FOLLOW
    }
    if () not in recording.selected:
        raise StoreError("the run was stopped while it began: start it again")
    return recording, world
