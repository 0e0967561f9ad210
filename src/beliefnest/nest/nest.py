"""The nest: the real world and all beliefs in it."""

from collections.abc import Callable, Iterable
from pathlib import Path
from types import TracebackType
from typing import Protocol, Self

from beliefnest.belief.entries import InitialBelief
from beliefnest.bodies.protocol import World
from beliefnest.bodies.scripted import ScriptedBodies
from beliefnest.bodies.worlds import open_world
from beliefnest.errors import ProgramError
from beliefnest.nest.compare import Difference, compare, false_beliefs
from beliefnest.nest.engine import Engine
from beliefnest.nest.paths import parse_path
from beliefnest.nest.setting import Setting, Step
from beliefnest.nest.simulator import PastSimulator, Simulator
from beliefnest.perception.options import Perception
from beliefnest.timeline.journal import Journal, MemoryJournal
from beliefnest.world.scripted import ScriptedWorld

__all__ = ["HasSetting", "Nest", "Past", "Progress"]

Progress = Callable[[str, int, int], None]
"""Takes what is being done, how many parts of it are done, and of how many."""


class HasSetting(Protocol):
    """Something a nest can open: a scenario with its condition chosen."""

    @property
    def setting(self) -> Setting:
        """What the nest starts from."""


class Nest:
    """The real world and every belief in it; each node is made on first use.

    `Nest(world)` wraps a `ScriptedWorld` and follows what it is told; `Nest.open` opens a
    scenario in a world of its own. Use it in a `with` block, or close it.

    Args:
        world: The scripted world that is the real one.
        perception: What agents can perceive.
        static_blocks: Names of blocks that everybody knows from the start.
        initial_beliefs: Further priors, at any depth.
        store: File to record in; None: memory.
    """

    def __init__(
        self,
        world: ScriptedWorld,
        perception: Perception | None = None,
        static_blocks: Iterable[str] = (),
        initial_beliefs: Iterable[InitialBelief] = (),
        store: str | Path | None = None,
    ) -> None:
        setting = Setting(
            name="scripted",
            snapshot=world.snapshot(),
            perception=perception or Perception(),
            static_blocks=frozenset(static_blocks),
            initial_beliefs=tuple(initial_beliefs),
        )
        self._engine = _engine(setting, ScriptedBodies(world), store, 0)

    @classmethod
    def open(
        cls,
        scenario: HasSetting | Setting,
        world: str = "embedded",
        store: str | Path | None = None,
        seed: int = 0,
    ) -> Self:
        """Open a scenario in a world.

        Args:
            scenario: What to start from.
            world: `embedded`, or `scripted`.
            store: File to record in; None: memory.
            seed: Drives every random number.

        Raises:
            BodyError: The world could not be started.
            UnknownNameError: There is no such world.
        """
        setting = scenario if isinstance(scenario, Setting) else scenario.setting
        nest = cls.__new__(cls)
        opened = open_world(world, seed)
        try:
            nest._engine = _engine(setting, opened, store, seed)
        except BaseException:
            opened.close()
            raise
        return nest

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """End the world and close the store."""
        self._engine.close()

    @property
    def setting(self) -> Setting:
        """What the nest started from."""
        return self._engine.setting

    @property
    def agents(self) -> tuple[str, ...]:
        """Names of all agents, sorted."""
        return self._engine.agents

    @property
    def tick(self) -> int:
        """The real world's latest tick."""
        return self._engine.info(()).head

    def __getitem__(self, path: str) -> Simulator:
        """The simulator of a belief path; `/` is the real world.

        Raises:
            PathError: The path is malformed or names an unknown agent.
        """
        return Simulator(self._engine, parse_path(path, self.agents))

    def at(self, tick: int) -> "Past":
        """All simulators as they were at a past tick.

        Raises:
            TickError: The tick is in the future or before the start.
        """
        self._engine.reading((), tick)
        return Past(self._engine, tick)

    def compare(self, a: str, b: str, *, unknown: bool = True) -> list[Difference]:
        """Where two simulators differ: blocks, containers, agents' poses, inventories.

        Args:
            a: Belief path of one.
            b: Belief path of the other.
            unknown: Whether to tell of what is unknown, or not there, in one of them.

        Raises:
            PathError: A path is malformed or names an unknown agent.
        """
        one, other = parse_path(a, self.agents), parse_path(b, self.agents)
        return compare(self._engine, one, other, None, unknown=unknown)

    def false_beliefs(self, path: str) -> list[Difference]:
        """What a simulator holds otherwise than reality (`a`) does; unknown is not false.

        Contents are false if they claim items that are not there, or claim to be complete
        and miss some.

        Raises:
            PathError: The path is malformed or names an unknown agent.
        """
        return false_beliefs(self._engine, parse_path(path, self.agents), None)

    def play(self, on_progress: Progress | None = None) -> None:
        """Play the scenario's script in the real world.

        Raises:
            ProgramError: A program failed; the message says which step, where it is
                written, and the program's line.
        """
        script = self.setting.script
        for number, step in enumerate(script):
            if on_progress is not None:
                on_progress(step.label or f"step {number + 1}", number, len(script))
            self._play_step(number, step)
        if on_progress is not None:
            on_progress("script played", len(script), len(script))

    def _play_step(self, number: int, step: Step) -> None:
        results = self["/"].run_all(step.programs, step.timeout_ticks)
        for agent, result in results.items():
            if not result.ok:
                label = f" ({step.label})" if step.label else ""
                where = f"{step.where}: " if step.where else ""
                raise ProgramError(
                    f"{where}step {number + 1}{label}: the program of {agent} failed: "
                    f"{result.error}"
                )


class Past:
    """All simulators at one past tick."""

    def __init__(self, engine: Engine, tick: int) -> None:
        self._engine = engine
        self._tick = tick

    def __getitem__(self, path: str) -> PastSimulator:
        """The simulator of a belief path as it was."""
        return PastSimulator(self._engine, parse_path(path, self._engine.agents), self._tick)

    def compare(self, a: str, b: str, *, unknown: bool = True) -> list[Difference]:
        """Where two simulators differ: blocks, containers, agents' poses, inventories.

        Args:
            a: Belief path of one.
            b: Belief path of the other.
            unknown: Whether to tell of what is unknown, or not there, in one of them.

        Raises:
            PathError: A path is malformed or names an unknown agent.
        """
        one, other = parse_path(a, self._engine.agents), parse_path(b, self._engine.agents)
        return compare(self._engine, one, other, self._tick, unknown=unknown)

    def false_beliefs(self, path: str) -> list[Difference]:
        """What a simulator holds otherwise than reality (`a`) does; unknown is not false.

        Contents are false if they claim items that are not there, or claim to be complete
        and miss some.

        Raises:
            PathError: The path is malformed or names an unknown agent.
        """
        return false_beliefs(self._engine, parse_path(path, self._engine.agents), self._tick)


def _engine(setting: Setting, world: World, store: str | Path | None, seed: int) -> Engine:
    journal: Journal = MemoryJournal() if store is None else _store(store)
    return Engine(setting, journal, world, seed).begin()


def _store(path: str | Path) -> Journal:
    from beliefnest.timeline.store import SqliteJournal

    return SqliteJournal.create_file(Path(path))
