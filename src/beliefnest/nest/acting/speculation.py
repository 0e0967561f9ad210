"""Speculation: programs run ahead of their turn, in several processes at once.

The effect of a program depends only on the snapshot, the seed and the tick with which its body
begins. So it can run early, in any body that begins with them, and its frames can be recorded when
its turn comes: the record is the same as if it had run then.
"""

from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from dataclasses import dataclass, field
from queue import Empty, SimpleQueue
from threading import Event

import msgspec

from beliefnest.errors import BeliefNestError, BodyError, BodyLostError, WorldError
from beliefnest.nest.acting.lives import Lives
from beliefnest.world.frames import Frame, Snapshot
from beliefnest.worlds.protocol import (
    AS_USUAL,
    Body,
    ProgramResult,
    RunRules,
    SenseSource,
    Sink,
    World,
)


class SpeculationStart(msgspec.Struct, frozen=True):
    """Initial state of the bodies in which programs run. `name` is unique in their worlds."""

    name: str
    seed: str
    snapshot: Snapshot
    rules: RunRules = AS_USUAL


@dataclass(slots=True)
class Speculation:
    """Result of programs that ran in a body of their own.

    Attributes:
        tick: The body's last tick.
        internal_state: The body's internal state at the end.
        frames: The body's frames, in order.
        results: Results by agent; empty if the call raised.
        error: The error that the call raised; None: it raised none.
    """

    tick: int
    internal_state: bytes = b""
    frames: list[Frame] = field(default_factory=list)
    results: Mapping[str, ProgramResult] = field(default_factory=dict)
    error: BeliefNestError | None = None


class SpeculatedBody:
    """Stand-in for a body whose programs have run already. It can only replay their result."""

    goes_on = False

    def __init__(self, speculation: Speculation, sink: Sink) -> None:
        self._speculation = speculation
        self._sink = sink
        self._ran = False

    @property
    def lost(self) -> bool:
        """True if the process in which the programs ran has ended."""
        return self._ran and isinstance(self._speculation.error, BodyLostError)

    @property
    def tick(self) -> int:
        """The body's latest tick."""
        return self._speculation.tick

    @property
    def internal_state(self) -> bytes:
        """The internal state of the body, which nobody can perceive."""
        return self._speculation.internal_state

    def snapshot(self) -> Snapshot:
        """Raise BodyError: the body is gone."""
        raise _gone()

    def run(
        self,
        programs: Mapping[str, str],
        timeout_ticks: int,
        senses: Mapping[str, SenseSource] | None = None,
        rules: RunRules = AS_USUAL,
    ) -> Mapping[str, ProgramResult]:
        """Hand the frames of the programs to the sink, and return or raise their outcome."""
        self._ran = True
        for frame in self._speculation.frames:
            self._sink(frame)
        if self._speculation.error is not None:
            raise self._speculation.error
        return self._speculation.results

    def step(self, ticks: int) -> None:
        """Raise BodyError: the body is gone."""
        raise _gone()

    def set_state(self, snapshot: Snapshot) -> None:
        """Raise BodyError: the body is gone."""
        raise _gone()

    def close(self) -> None:
        """Do nothing: no process is held open."""


def speculate(
    worlds: Sequence[World],
    start: SpeculationStart,
    jobs: Mapping[int, Mapping[str, str]],
    timeout_ticks: int,
) -> Mapping[int, Speculation]:
    """Run jobs in several worlds at the same time, each in a body with the same initial state.

    Args:
        worlds: Worlds to use; each runs one job after the other.
        start: Initial state of each body.
        jobs: Programs by agent, by number of the job.
        timeout_ticks: Ticks after which programs are stopped.

    Returns:
        Speculations by number of the job. Jobs for which no body could be opened are left out.
    """
    waiting: SimpleQueue[int] = SimpleQueue()
    for number in jobs:
        waiting.put(number)
    speculations: dict[int, Speculation] = {}
    stopped = Event()

    def work(world: World) -> None:
        with closing(_Workplace(world, start, stopped)) as place:
            while not stopped.is_set():
                try:
                    number = waiting.get_nowait()
                except Empty:
                    return
                speculation = place.run(jobs[number], timeout_ticks)
                if speculation is None:
                    return
                speculations[number] = speculation

    with ThreadPoolExecutor(len(worlds)) as pool:
        try:
            list(pool.map(work, worlds))
        except BaseException:
            # The results of running jobs are of no use any more: interrupt their worlds.
            stopped.set()
            for world in worlds:
                world.interrupt()
            raise
    return speculations


class _Workplace:
    """World that runs one job after the other, with its body reset before each job."""

    def __init__(self, world: World, start: SpeculationStart, stopped: Event) -> None:
        self._world, self._start, self._stopped = world, start, stopped
        self._body: Body | None = None
        self._frames: list[Frame] = []

    def run(self, programs: Mapping[str, str], timeout_ticks: int) -> Speculation | None:
        """Return the result of programs; None: no body can be opened for them."""
        speculation = Speculation(self._start.snapshot.tick)
        self._frames = speculation.frames
        body = self._begun()
        if body is None:
            return None
        try:
            speculation.results = body.run(programs, timeout_ticks, None, self._start.rules)
        except BeliefNestError as error:
            speculation.error = error
            self.close()
        speculation.tick, speculation.internal_state = body.tick, body.internal_state
        return speculation

    def close(self) -> None:
        """Close the body."""
        if self._body is not None:
            self._body.close()
            self._body = None

    def _begun(self) -> Body | None:
        """Return a body in the initial state; None: none can be opened."""
        if self._body is not None:
            try:
                self._body.set_state(self._start.snapshot)
            except BodyError:
                # The body cannot be reset: open another one below.
                self.close()
        if self._body is None:
            self._body = _opened(self._world, self._start, self._take, self._stopped)
        return self._body

    def _take(self, frame: Frame) -> None:
        self._frames.append(frame)


def _opened(world: World, start: SpeculationStart, sink: Sink, stopped: Event) -> Body | None:
    def opened() -> Body | None:
        if stopped.is_set():
            return None
        return world.open_body(start.name, start.seed, start.snapshot, sink)

    try:
        return Lives().call(opened)
    except (BodyError, WorldError):
        return None


def _gone() -> BodyError:
    return BodyError("the body in which the programs ran is closed; open another one")
