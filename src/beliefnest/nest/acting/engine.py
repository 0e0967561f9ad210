"""The effects behind a nest: which timeline each simulator is on, and its body.

A simulator is in control mode iff a timeline is selected for it; it then has a body in
the world and its frames are recorded there (semantics, sections 6 and 7).

A call on a body happens as a whole or, if it raises, not at all. If the process behind the
world ends, all bodies in it are lost, and each is made again from its timeline when it is
needed. The call under way has not happened: it is made again, but for programs, which end as
`killed`.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from threading import RLock
from typing import Self, TypeVar

from beliefnest.belief.node_view import NodeView
from beliefnest.bodies.protocol import KILLED, Body, Fault, ProgramResult, World
from beliefnest.errors import (
    BodyError,
    BodyLostError,
    BranchError,
    StoreError,
    TickError,
    WorldError,
)
from beliefnest.nest.acting.frame_recorder import FrameRecorder
from beliefnest.nest.acting.script import UNDONE
from beliefnest.nest.acting.speculation import Outcome, SpeculatedBody
from beliefnest.nest.past.body_state import hidden_at, note_hidden, present, snapshot_at
from beliefnest.nest.past.history import History
from beliefnest.nest.past.run_log import MemoryLog, RunLog, note_programs
from beliefnest.nest.past.setting import MAIN, Setting
from beliefnest.nest.past.views import Blocks, LiveState
from beliefnest.timeline.journal import (
    FOLLOW,
    Edit,
    ForkPoint,
    Journal,
    TimelineInfo,
    TimelineKey,
)
from beliefnest.world.frames import Snapshot
from beliefnest.world.paths import path_text
from beliefnest.world.values import Items, Position

__all__ = ["Engine"]

Path = tuple[str, ...]

_LIVES = 3
"""How many processes a call may use up."""

T = TypeVar("T")


class Engine:
    """Timelines, bodies and states of one nest. `Nest` and `Simulator` are its face.

    Args:
        setting: What the nest started from.
        journal: The timelines.
        world: Where bodies live; a body is made when it is first needed.
        seed: Drives every random number.
        log: Notes beside the timelines, kept together with them; None: in memory.

    Attributes:
        turn: Held by the thread that is in the nest.
    """

    def __init__(
        self,
        setting: Setting,
        journal: Journal,
        world: World,
        seed: int,
        log: RunLog | None = None,
    ) -> None:
        self.turn = RLock()
        self.setting = setting
        self.journal = journal
        self.world = world
        self.seed = seed
        self.log: RunLog = MemoryLog(journal) if log is None else log
        self.history = History(journal, setting)
        self.selected: dict[Path, TimelineKey] = {}
        self._bodies: dict[Path, Body] = {}
        self._recorders: dict[Path, FrameRecorder] = {}
        self._bodiless: set[Path] = set()
        self._others: list[World] = []

    def begin(self) -> Self:
        """Start the real world's timeline and give it its body."""
        key = TimelineKey((), MAIN)
        with self.log.together():
            self.journal.create(key, None, self.setting.snapshot.tick)
            self.log.select(key.path, key.branch)
        self.selected[()] = key
        self._surviving(lambda: self._open_body(key, self.setting.snapshot))
        return self

    def resume(self) -> Self:
        """Take up the selections that were noted; bodies are made when they are needed.

        Raises:
            StoreError: The run was stopped before it had begun.
        """
        for path, branch in self.log.selected().items():
            if branch != FOLLOW:
                self.selected[path] = self.journal.info(TimelineKey(path, branch)).key
        if () not in self.selected:
            raise StoreError("the run was stopped while it began; start it again")
        return self

    def controller(self, path: Path) -> TimelineKey:
        """The timeline of the nearest simulator in control mode, the node itself included."""
        for depth in range(len(path), -1, -1):
            if path[:depth] in self.selected:
                return self.selected[path[:depth]]
        raise BranchError("the nest was not opened; use Nest.open or Nest(world)")

    def info(self, path: Path) -> TimelineInfo:
        """The timeline that a node's state comes from."""
        return self.journal.info(self.controller(path))

    @property
    def agents(self) -> tuple[str, ...]:
        """All agents, sorted."""
        return self.history.context.agents

    def reading(self, path: Path, tick: int | None = None) -> NodeView:
        """A node's state now, or at a past tick of the timeline it is on."""
        key, position = self._when(path, tick)
        return self.history.reading(key, path, position)

    def state(self, path: Path, tick: int | None = None) -> LiveState:
        """The view of a node's state now, or at a past tick of the timeline it is on.

        Raises:
            TickError: The tick is in the future, or before the start of everything.
        """
        key, position = self._when(path, tick)
        shown = self.journal.info(key).head if tick is None else tick
        return self.state_after(key, path, position, shown)

    def state_after(self, key: TimelineKey, path: Path, entries: int, tick: int) -> LiveState:
        """The view of a node's state on a timeline, after some of its entries, as of a tick."""
        reading = self.history.reading(key, path, entries)
        blocks = Blocks(self.history, key, entries, reading, self.turn)
        return LiveState(reading, blocks, self.setting.snapshot.box, tick, self.turn)

    def _when(self, path: Path, tick: int | None) -> tuple[TimelineKey, int]:
        info = self.info(path)
        if tick is None:
            return info.key, info.entries
        if tick > info.head:
            raise TickError(f"tick {tick} is in the future; {path_text(path)} is at {info.head}")
        return self.place_of(info.key, tick)

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

    def seed_of(self, path: Path) -> str:
        """Seed of a simulator's body."""
        return f"{self.seed} {path_text(path)}"

    def fork(self, path: Path, name: str, tick: int | None) -> None:
        """Begin a branch at the current tick, or at a past one, and select it."""
        self._surviving(lambda: self._fork(path, name, tick))

    def _fork(self, path: Path, name: str, tick: int | None) -> None:
        base = present(self.journal, self.controller(path))
        if tick is not None:
            if tick > base.tick:
                raise TickError(f"tick {tick} is in the future; the fork can be at {base.tick}")
            place, entries = self.place_of(base.timeline, tick)
            base = ForkPoint(place, entries, tick)
        key = TimelineKey(path, name)
        snapshot = snapshot_at(self.journal, self.history, path, base)
        with self._embodied(key, snapshot), self.log.together():
            self.journal.create(key, base, base.tick)
            self.log.select(path, name)

    def select(self, key: TimelineKey) -> None:
        """Put a simulator on a timeline it has, in the world too."""
        if self.selected.get(key.path) != key:
            self._surviving(lambda: self._select(key))

    def _select(self, key: TimelineKey) -> None:
        with self._embodied(key, self._recorded(key)):
            self.log.select(key.path, key.branch)

    def follow(self, path: Path) -> None:
        """Put a simulator into follow mode; its body is given up."""
        if path == ():
            raise BranchError(f"the real world follows nothing; {FOLLOW!r} is for beliefs")
        if path in self.selected:
            self.log.select(path, FOLLOW)
            del self.selected[path]
        self._give_up(path)

    def rename(self, key: TimelineKey, name: str) -> None:
        """Give a branch another name; who is on it stays on it."""
        with self.log.together():
            self.journal.rename(key, name)
            self.log.renamed(key.path, key.branch, name)
        # What is remembered of timelines based on it names it as well.
        for info in self.journal.timelines():
            self.history.forget(info.key)
        self.history.forget(key)
        if self.selected.get(key.path) == key:
            new = self.selected[key.path] = TimelineKey(key.path, name)
            if key.path in self._recorders:
                self._recorders[key.path].key = new

    def delete(self, keys: Sequence[TimelineKey]) -> None:
        """Remove timelines, those based on others first, all of them or none.

        Raises:
            BranchError: A simulator is on one of them, or another one is based on it.
        """
        for key in keys:
            if self.selected.get(key.path) == key:
                raise BranchError(
                    f"{path_text(key.path)} is on branch {key.branch!r}; "
                    "switch it to another one before deleting that"
                )
        with self.log.together():
            for key in keys:
                self.journal.delete(key)
                self.log.forgotten(key.path, key.branch)
        for key in keys:
            self.history.forget(key)

    def body(self, path: Path) -> Body:
        """The body of a simulator in control mode, made if there is none yet.

        Raises:
            BranchError: The simulator is in follow mode.
            BodyError: The world could not be started.
        """
        return self._surviving(lambda: self._body(path))

    def _body(self, path: Path) -> Body:
        if path not in self.selected:
            raise BranchError(
                f"{path_text(path)} is in follow mode and has no body to act in; "
                "switch it to a branch first: simulator.switch('my-branch')"
            )
        if path not in self._bodies:
            key = self.selected[path]
            self._open_body(key, self._recorded(key))
        return self._bodies[path]

    def run(
        self,
        path: Path,
        programs: Mapping[str, str],
        timeout_ticks: int,
        detail: Mapping[str, str] | None = None,
    ) -> Mapping[str, ProgramResult]:
        """Run programs in a body, record what happens, and note them with their results.

        If the process behind the world ends under them, their results say so, and what they
        did until then is not kept.
        """
        noted = {**(detail or {}), "timeout_ticks": str(timeout_ticks)}
        return self._surviving(lambda: self._run(path, programs, timeout_ticks, noted))

    def _run(
        self, path: Path, programs: Mapping[str, str], timeout_ticks: int, noted: Mapping[str, str]
    ) -> Mapping[str, ProgramResult]:
        self._body(path)
        before = self.info(path)
        try:
            with self._recording(path) as body:
                results = body.run(programs, timeout_ticks)
                note_programs(self.log, before, programs, results, noted)
        except BodyLostError as lost:
            message = (
                f"nothing of the program is kept, {path_text(path)} is at tick {before.head} as "
                f"it was before, and what comes next runs in a new process: {lost}"
            )
            fault = Fault(message, KILLED)
            results = {agent: ProgramResult(agent, False, fault, 0) for agent in programs}
            with self.log.together():
                note_programs(self.log, before, programs, results, {**noted, UNDONE: KILLED})
        return results

    def take_over(
        self, path: Path, programs: Mapping[str, str], timeout_ticks: int, outcome: Outcome
    ) -> Mapping[str, ProgramResult]:
        """Run programs that have run already, in another body that was as this simulator's is."""
        self._give_up(path)
        recorder = FrameRecorder(self.journal, self.history, self.selected[path])
        self._bodies[path], self._recorders[path] = SpeculatedBody(outcome, recorder), recorder
        try:
            return self.run(path, programs, timeout_ticks)
        finally:
            self._give_up(path)

    def others(self, count: int) -> Sequence[World]:
        """That many worlds like this nest's own; each is started when it is first needed."""
        while len(self._others) < count:
            self._others.append(self.world.another())
        return self._others[:count]

    def step(self, path: Path, ticks: int) -> None:
        """Let ticks pass in a body."""
        self._surviving(lambda: self._step(path, ticks))

    def _step(self, path: Path, ticks: int) -> None:
        with self._recording(path) as body:
            body.step(ticks)

    def edit(
        self,
        path: Path,
        blocks: Mapping[Position, int],
        containers: Mapping[Position, Items],
    ) -> None:
        """Record a change by hand, in the body too where there is one."""
        self._surviving(lambda: self._edit(path, blocks, containers))

    def _edit(
        self,
        path: Path,
        blocks: Mapping[Position, int],
        containers: Mapping[Position, Items],
    ) -> None:
        key = self.info(path).key
        try:
            with self.log.together():
                self._append_edit(key, Edit(self.info(path).head, path, blocks, containers))
                if path in self._bodies:
                    self._bodies[path].become(self._recorded(key))
        except BaseException:
            self._forget_undone()
            self._restore(path)
            raise

    def _append_edit(self, key: TimelineKey, edit: Edit) -> None:
        # What goes on in the body goes on after an edit.
        hidden = hidden_at(self.journal, present(self.journal, key))
        self.journal.append(key, [edit], edit.tick)
        note_hidden(self.journal, present(self.journal, key), hidden)

    def _forget_undone(self) -> None:
        """Forget what was read of timelines while a call was under way that did not happen."""
        for info in self.journal.timelines():
            self.history.forget(info.key)

    def close(self) -> None:
        """Give up all bodies, the world and the journal."""
        self._bodies.clear()
        try:
            for world in (*self._others, self.world):
                world.close()
            # Whoever reads the run without checkpoints gets the same, later.
            with suppress(StoreError):
                self.history.close()
        finally:
            self.journal.close()

    def _recorded(self, key: TimelineKey) -> Snapshot:
        """What a body on that timeline has to be like now."""
        return snapshot_at(self.journal, self.history, key.path, present(self.journal, key))

    @contextmanager
    def _embodied(self, key: TimelineKey, snapshot: Snapshot) -> Iterator[None]:
        """Give a simulator's body a state and, if the body of the block records that, select it.

        If the world or the journal refuses, the simulator is where it was before.
        """
        body = self._bodies.get(key.path)
        try:
            if body is not None:
                body.become(snapshot)
            elif key.path not in self._bodiless:
                self._open_body(key, snapshot)
            yield
        except BaseException:
            self._restore(key.path)
            raise
        self.selected[key.path] = key
        if key.path in self._recorders:
            self._recorders[key.path].key = key

    @contextmanager
    def without_body(self, path: Path) -> Iterator[None]:
        """Give a simulator's body up, and make none for a branch that is only selected."""
        self._give_up(path)
        self._bodiless.add(path)
        try:
            yield
        finally:
            self._bodiless.discard(path)

    def _restore(self, path: Path) -> None:
        """Make a simulator's body, after a fault, what its timeline says."""
        self._forget_lost()
        key, body = self.selected.get(path), self._bodies.get(path)
        if body is None:
            return
        if key is None:
            self._give_up(path)
            return
        try:
            body.become(self._recorded(key))
        except BodyError:
            # Not even that; another one is made when it is needed.
            self._give_up(path)

    def _forget_lost(self) -> None:
        """Forget the bodies whose process has ended; others are made when they are needed."""
        for path in [path for path, body in self._bodies.items() if body.lost]:
            del self._bodies[path], self._recorders[path]

    def _surviving(self, call: Callable[[], T]) -> T:
        """Make a call that needs bodies; if their process ends under it, make it again.

        Raises:
            BodyError: It was started again and again, and each time it ended.
        """
        told: list[BodyLostError] = []
        while len(told) < _LIVES:
            self._forget_lost()
            try:
                return call()
            except BodyLostError as lost:
                told.append(lost)
        self._forget_lost()
        raise BodyError(
            f"the process behind the world ended {len(told)} times under one call; nothing of it "
            "is kept. Run `beliefnest doctor`; if memory or time did not suffice, give more with "
            f"limits=ProcessLimits(...). The last time: {told[-1]}"
        ) from told[-1]

    def _give_up(self, path: Path) -> None:
        self._recorders.pop(path, None)
        body = self._bodies.pop(path, None)
        if body is not None:
            body.close()

    def _open_body(self, key: TimelineKey, snapshot: Snapshot) -> None:
        recorder = FrameRecorder(self.journal, self.history, key)
        name, seed = path_text(key.path), self.seed_of(key.path)
        self._bodies[key.path] = self.world.open_body(name, seed, snapshot, recorder)
        self._recorders[key.path] = recorder
        self.log.add_versions(self.world.versions)

    @contextmanager
    def _recording(self, path: Path) -> Iterator[Body]:
        """A call on a body; what happens and what is noted is kept once it ends, as a whole."""
        body = self._body(path)
        recorder = self._recorders[path]
        recorder.batched = True
        try:
            with self.log.together():
                yield body
                recorder.flush(body.tick)
                note_hidden(self.journal, present(self.journal, recorder.key), body.hidden)
        except WorldError:
            # It was refused, so that there is nothing to take back.
            raise
        except BaseException:
            recorder.drop()
            self._forget_undone()
            self._restore(path)
            raise
        finally:
            recorder.batched = False
        recorder.keep_up()
