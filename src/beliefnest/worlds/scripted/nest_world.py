"""Bodies without Minecraft: a `ScriptedWorld` of its own for every simulator."""

from collections.abc import Mapping
from types import MappingProxyType

from beliefnest.errors import WorldError
from beliefnest.world.frames import Snapshot
from beliefnest.worlds.process_limits import ProcessLimits
from beliefnest.worlds.protocol import AS_USUAL, ProgramResult, RunRules, SenseSource, Sink
from beliefnest.worlds.scripted.desk import Desk
from beliefnest.worlds.scripted.ground_cache import Grounds
from beliefnest.worlds.scripted.world import ScriptedWorld


class ScriptedBody:
    """Simulator's part of the scripted world; users act in it through `world`.

    Attributes:
        world: The world, to which users report events.
    """

    lost = goes_on = False

    def __init__(
        self, world: ScriptedWorld, sink: Sink, seed: str, grounds: Grounds, desk: Desk
    ) -> None:
        self.world = world
        self._sink = sink
        self._seed = seed
        self._grounds = grounds
        self._desk = desk
        self._recording = True
        world.listen(sink)

    @property
    def tick(self) -> int:
        """Latest tick of the body."""
        return self.world.now

    @property
    def internal_state(self) -> bytes:
        """Pressed buttons, and when they come out again."""
        return self.world.under_way

    def snapshot(self) -> Snapshot:
        """Return the present state."""
        return self.world.snapshot()

    def run(
        self,
        programs: Mapping[str, str],
        timeout_ticks: int,
        senses: Mapping[str, SenseSource] | None = None,
        rules: RunRules = AS_USUAL,
    ) -> Mapping[str, ProgramResult]:
        """Run programs by agent, together, until the last has ended; see docs/scripted-world.md."""
        for agent in programs:
            if agent not in self.world.agents:
                there = ", ".join(sorted(self.world.agents)) or "nobody"
                raise WorldError(f"{agent} is not there: its pose is not known; there are {there}")
        from beliefnest.worlds.scripted.programs import run_programs

        return run_programs(
            self.world,
            programs,
            timeout_ticks,
            senses or {},
            rules,
            self._seed,
            self._grounds,
            self._desk,
        )

    def step(self, ticks: int) -> None:
        """Let ticks pass."""
        self.world.step(ticks)

    def set_state(self, snapshot: Snapshot) -> None:
        """Set the state to a snapshot; no frames are sent."""
        self.world.set_state(snapshot)

    def close(self) -> None:
        """Stop recording; a second call does nothing."""
        if self._recording:
            self._recording = False
            self.world.unlisten(self._sink)


class ScriptedNestWorld:
    """World of scripted bodies; `first` becomes the first body, the real world's."""

    has_physics = False
    realtime = None
    versions: Mapping[str, str] = MappingProxyType({})

    def __init__(self, first: ScriptedWorld | None = None) -> None:
        self._first = first
        self._grounds = Grounds()
        self._desk = Desk()

    def open_body(self, name: str, seed: str, snapshot: Snapshot, sink: Sink) -> ScriptedBody:
        """Create a body.

        Its name has no effect; its seed affects only its programs' random numbers.
        """
        world, self._first = self._first, None
        world = world or ScriptedWorld.from_snapshot(snapshot)
        return ScriptedBody(world, sink, seed, self._grounds, self._desk)

    def start(self) -> None:
        """Do nothing: there is no process."""

    def another(self) -> "ScriptedNestWorld":
        """Return another empty world."""
        return ScriptedNestWorld()

    def interrupt(self) -> None:
        """Do nothing: no call takes long."""

    def close(self) -> None:
        """Do nothing: the world holds no resources."""


def scripted_world(seed: int, limits: ProcessLimits | None) -> ScriptedNestWorld:
    """Return a scripted world. It draws no random numbers and has no process."""
    return ScriptedNestWorld()
