"""Speculation: programs run ahead of their turn, in several processes at once.

What a program does depends on the snapshot, the seed and the tick it begins with, and on nothing
else. So it can run in any body filled with them, and be recorded when its turn comes.
"""

from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from dataclasses import dataclass, field
from queue import Empty, SimpleQueue
from threading import Event

from beliefnest.bodies.protocol import AS_USUAL, Body, ProgramResult, RunRules, Sense, Sink, World
from beliefnest.errors import BeliefNestError, BodyError, BodyLostError, WorldError
from beliefnest.nest.acting.lives import Lives
from beliefnest.world.frames import Frame, Snapshot

__all__ = ["SpeculatedBody", "Speculation", "SpeculationStart", "speculate"]


@dataclass(frozen=True, slots=True)
class SpeculationStart:
    """What a body begins with that a program runs in; no other body in its world has its name."""

    name: str
    seed: str
    snapshot: Snapshot
    rules: RunRules = AS_USUAL


@dataclass(slots=True)
class Speculation:
    """What became of programs in a body of their own.

    Attributes:
        tick: The body's tick in the end.
        internal_state: What went on in it in the end.
        frames: Its frames, in order.
        results: Results by agent; empty if the call raised.
        error: What it raised.
    """

    tick: int
    internal_state: bytes = b""
    frames: list[Frame] = field(default_factory=list)
    results: Mapping[str, ProgramResult] = field(default_factory=dict)
    error: BeliefNestError | None = None


class SpeculatedBody:
    """A body in which programs have run already; it can do nothing but run them, once."""

    def __init__(self, speculation: Speculation, sink: Sink) -> None:
        self._speculation = speculation
        self._sink = sink
        self._ran = False

    @property
    def lost(self) -> bool:
        """True if the process ended in which they ran."""
        return self._ran and isinstance(self._speculation.error, BodyLostError)

    @property
    def goes_on(self) -> bool:
        """False: its clock stands still between the calls."""
        return False

    @property
    def tick(self) -> int:
        """The body's latest tick."""
        return self._speculation.tick

    @property
    def internal_state(self) -> bytes:
        """What goes on in it and nobody can perceive."""
        return self._speculation.internal_state

    def snapshot(self) -> Snapshot:
        """Raise BodyError: the body is gone."""
        raise _gone()

    def run(
        self,
        programs: Mapping[str, str],
        timeout_ticks: int,
        senses: Mapping[str, Sense] | None = None,
        rules: RunRules = AS_USUAL,
    ) -> Mapping[str, ProgramResult]:
        """Hand out the frames of the programs, which have run already."""
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
        """Nothing is held open."""


def speculate(
    worlds: Sequence[World],
    start: SpeculationStart,
    jobs: Mapping[int, Mapping[str, str]],
    timeout_ticks: int,
) -> Mapping[int, Speculation]:
    """Run programs, each job in a body as it is at the start, in several worlds at the same time.

    Args:
        worlds: Where; each does one job after the other.
        start: What each body begins with.
        jobs: Programs by agent, by the caller's number.
        timeout_ticks: Ticks after which programs are stopped.

    Returns:
        Speculations by number; those for which no body could be made are left out.
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
            # Nobody waits for what still runs.
            stopped.set()
            for world in worlds:
                world.interrupt()
            raise
    return speculations


class _Workplace:
    """Where one job after the other is run in a world, in a body that begins each as the first."""

    def __init__(self, world: World, start: SpeculationStart, stopped: Event) -> None:
        self._world, self._start, self._stopped = world, start, stopped
        self._body: Body | None = None
        self._frames: list[Frame] = []

    def run(self, programs: Mapping[str, str], timeout_ticks: int) -> Speculation | None:
        """What becomes of programs; None: no body can be made for them."""
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
        """Give the body up."""
        if self._body is not None:
            self._body.close()
            self._body = None

    def _begun(self) -> Body | None:
        """Return the body, as it is at the start; None: none can be made."""
        if self._body is not None:
            try:
                self._body.set_state(self._start.snapshot)
            except BodyError:
                # Another one is made in its place.
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
    return BodyError("the body in which the programs ran is gone; another one has to be made")
