"""The recorded past of one nest: its timelines, who is on which, and any state from them.

Nothing here acts in a world. What acts (`nest/acting`) appends to the journal and changes the
selection; what reads (states, explanations, recorded runs) needs no more than this.
"""

from collections.abc import Iterable, Mapping
from contextlib import suppress
from copy import copy
from typing import Self

from beliefnest.belief.context import BeliefContext
from beliefnest.belief.node_view import NodeView
from beliefnest.errors import BranchError, StoreError, TickError
from beliefnest.nest.past.history import History
from beliefnest.nest.past.setting import MAIN, Setting
from beliefnest.nest.past.setting_codec import decode_start
from beliefnest.nest.past.turn import Turn
from beliefnest.nest.past.views import LiveState
from beliefnest.prompts import Renderer
from beliefnest.timeline.journal import FOLLOW, ForkPoint, TimelineInfo, TimelineKey
from beliefnest.timeline.records import Records, RunJournal
from beliefnest.timeline.store import SqliteJournal
from beliefnest.world.paths import BeliefPath, path_text
from beliefnest.world.values import Box

__all__ = ["Recording", "read_recording"]


class Recording:
    """Timelines and states of one nest.

    Attributes:
        setting: What the nest started from.
        journal: The timelines, with what ran on them.
        seed: Drives every random number of the nest.
        renderer: Fills prompts.
        history: From the journal to any node.
        selected: The timeline of every simulator in control mode.
        turn: Held by the thread that is in the nest.
        world: Name of the world that the nest was opened in.
        remembered: What readers keep of the nest from one question to the next, by their own keys.
    """

    def __init__(
        self,
        setting: Setting,
        journal: RunJournal,
        seed: int = 0,
        renderer: Renderer | None = None,
        world: str = "scripted",
    ) -> None:
        self.setting = setting
        self.world = world
        self.remembered: dict[object, object] = {}
        self.journal = journal
        self.seed = seed
        self.renderer = Renderer() if renderer is None else renderer
        self.history = History(journal, setting)
        self.selected: dict[BeliefPath, TimelineKey] = {(): TimelineKey((), MAIN)}
        self.turn = Turn()
        self._latest: tuple[TimelineInfo, ForkPoint] | None = None

    @property
    def agents(self) -> tuple[str, ...]:
        """All agents, sorted."""
        return self.context.agents

    @property
    def context(self) -> BeliefContext:
        """What all nodes share."""
        return self.history.context

    @property
    def box(self) -> Box:
        """The part of space there is."""
        return self.setting.snapshot.box

    @property
    def records(self) -> Records:
        """What ran, with which results."""
        return self.journal.records

    def on(self, key: TimelineKey) -> Self:
        """Return the same with a simulator on a timeline, and none below it on another."""
        other = copy(self)
        above = {p: k for p, k in self.selected.items() if key.path[: len(p)] == p}
        other.selected = {**above, key.path: key}
        return other

    def controller(self, path: BeliefPath) -> TimelineKey:
        """The timeline of the nearest simulator in control mode, the node itself included."""
        for depth in range(len(path), -1, -1):
            if path[:depth] in self.selected:
                return self.selected[path[:depth]]
        raise BranchError("the nest was not opened; use Nest.open or Nest(world)")

    def info(self, path: BeliefPath) -> TimelineInfo:
        """Return the timeline that a node's state comes from."""
        return self.journal.info(self.controller(path))

    def place_of(self, key: TimelineKey, tick: int) -> tuple[TimelineKey, int]:
        """Timeline and number of entries that hold a tick, back through the bases.

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
        """The timelines that lead to a moment, oldest first: each up to where the next begins."""
        found = [moment]
        while (base := self.journal.info(found[-1].timeline).base) is not None:
            found.append(base)
        return found[::-1]

    def moment(self, path: BeliefPath, tick: int | None = None) -> ForkPoint:
        """Where a node's state comes from now, or at a past tick of the timeline it is on.

        Raises:
            TickError: The tick is in the future, or before the start of everything.
        """
        info = self.info(path)
        if tick is None:
            # Hundreds of nodes may be asked for one after the other.
            if self._latest is None or self._latest[0] is not info:
                self._latest = info, ForkPoint(info.key, info.entries, info.head)
            return self._latest[1]
        if tick > info.head:
            raise TickError(f"tick {tick} is in the future; {path_text(path)} is at {info.head}")
        return ForkPoint(*self.place_of(info.key, tick), tick)

    def reading(self, path: BeliefPath, tick: int | None = None) -> NodeView:
        """Return a node's state now, or at a past tick; TickError as for `moment`."""
        moment = self.moment(path, tick)
        return self.history.reading(moment.timeline, path, moment.entries, moment.tick)

    def state(self, path: BeliefPath, tick: int | None = None) -> LiveState:
        """Return the view of a node's state now, or at a past tick; TickError as for `moment`."""
        moment = self.moment(path, tick)
        reading = self.history.reading(moment.timeline, path, moment.entries, moment.tick)
        return self.view_of(reading, moment)

    def states(self, paths: Iterable[BeliefPath]) -> Mapping[BeliefPath, LiveState]:
        """Return the views of several nodes' states now, by path."""
        wanted = list(paths)
        together: dict[TimelineKey, list[BeliefPath]] = {}
        for path in wanted:
            together.setdefault(self.controller(path), []).append(path)
        for key, nodes in together.items():
            self.history.expect(key, nodes)
        return {path: self.state(path) for path in wanted}

    def view_of(self, reading: NodeView, moment: ForkPoint) -> LiveState:
        """Return the view of a node's state that was read at a moment."""
        return LiveState(self.history, moment, reading, self.turn)

    def close(self) -> None:
        """Leave checkpoints for later readers, and close the journal.

        A forked child closes nothing: all of it is its parent's.
        """
        if not self.turn.is_own:
            return
        try:
            # Whoever reads the run without checkpoints gets the same, later.
            with suppress(StoreError):
                self.history.close()
        finally:
            self.journal.close()


def read_recording(journal: SqliteJournal) -> tuple[Recording, str]:
    """What a run file holds, as it was left, and the name of the world it ran in.

    Raises:
        StoreError: It cannot be read, or the run was stopped before it had begun.
    """
    run = journal.records.run()
    setting, world = decode_start(run.setting)
    recording = Recording(setting, journal, run.seed, world=world)
    recording.selected = {
        path: journal.info(TimelineKey(path, branch)).key
        for path, branch in journal.records.selected().items()
        if branch != FOLLOW
    }
    if () not in recording.selected:
        raise StoreError("the run was stopped while it began; start it again")
    return recording, world
