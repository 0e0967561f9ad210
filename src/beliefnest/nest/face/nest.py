"""The nest: the real world and all beliefs in it."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Protocol, Self

from beliefnest.belief.entries import InitialBelief
from beliefnest.bodies.limits import ProcessLimits
from beliefnest.bodies.protocol import World
from beliefnest.bodies.scripted import ScriptedBodies
from beliefnest.bodies.worlds import LazyWorld, Worlds, open_world
from beliefnest.errors import BodyError, ProgramError
from beliefnest.nest.acting.engine import Engine
from beliefnest.nest.acting.exploration import Attempt, Exploration, Score
from beliefnest.nest.acting.script import STEP, steps_played
from beliefnest.nest.explain.comparison import Difference, compare, false_beliefs
from beliefnest.nest.face.looking import Looking
from beliefnest.nest.face.reader import Reader
from beliefnest.nest.face.simulator import PastSimulator, Simulator
from beliefnest.nest.face.ticks import tick_of
from beliefnest.nest.face.turns import in_turn
from beliefnest.nest.past.run_log import FileLog
from beliefnest.nest.past.setting import Setting, Step
from beliefnest.nest.past.setting_codec import decode_start, encode_start
from beliefnest.nest.past.versions import own_versions
from beliefnest.perception.options import Perception
from beliefnest.timeline.memory import MemoryJournal
from beliefnest.timeline.records import ProgramRecord, PromptRecord, RunRecord
from beliefnest.timeline.store import SqliteJournal
from beliefnest.world.paths import parse_path
from beliefnest.world.scripted import ScriptedWorld

if TYPE_CHECKING:
    from beliefnest.nest.face.recorded import RecordedNest

__all__ = ["HasSetting", "Nest", "Past", "Progress"]

Progress = Callable[[str, int, int], None]
"""Takes what is being done, how many parts of it are done, and of how many."""

_TRIES = 3
"""How often a step of the script is begun, if the world's process ends under it."""


class HasSetting(Protocol):
    """Something a nest can open: a scenario with its condition chosen."""

    @property
    def setting(self) -> Setting:
        """What the nest starts from."""

    @property
    def text(self) -> str:
        """The text of the scenario's file, for the record; empty if there is none."""

    @property
    def templates(self) -> Mapping[str, str]:
        """Texts of the prompt templates that the file names, for the record."""

    @property
    def condition(self) -> int | None:
        """Number of the chosen condition; None if there is none."""


class Nest(Looking):
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
        start = _Start(setting, "scripted", 0)
        self._engine = _begun(start, ScriptedBodies(world), store)

    @classmethod
    def open(
        cls,
        scenario: HasSetting | Setting,
        world: str = "embedded",
        store: str | Path | None = None,
        seed: int = 0,
        worlds: Worlds | None = None,
        limits: ProcessLimits | None = None,
    ) -> Self:
        """Open a scenario in a world.

        Args:
            scenario: What to start from.
            world: `embedded`, or `scripted`.
            store: File to record in; None: memory.
            seed: Drives every random number.
            worlds: Lends the world, to one nest after the other; None: one is started.
            limits: What the world's process may take, if one is started.

        Raises:
            BodyError: The world could not be started.
            UnknownNameError: There is no such world.
            StoreError: The store exists already, or cannot be written.
        """
        if isinstance(scenario, Setting):
            start = _Start(scenario, world, seed)
        else:
            start = _Start(
                scenario.setting, world, seed, scenario.text, scenario.templates, scenario.condition
            )
        opened = open_world(world, seed, limits) if worlds is None else worlds.lend(world)
        try:
            return cls._of(_begun(start, opened, store))
        except BaseException:
            opened.close()
            raise

    @classmethod
    def resume(
        cls,
        store: str | Path,
        limits: ProcessLimits | None = None,
        worlds: Worlds | None = None,
    ) -> Self:
        """Go on with a recorded run where it was, on every branch, with its seed.

        The world is started, and bodies are made, when they are first needed.

        Args:
            store: The run file.
            limits: What the world's process may take.
            worlds: Lends the world, to one nest after the other; None: one is started.

        Raises:
            StoreError: There is no such run, it cannot be read or written, or has another
                writer.
        """
        journal = SqliteJournal.open(store)
        try:
            run = journal.records.run()
            setting, world = decode_start(run.setting)
            late = LazyWorld(world, run.seed, limits) if worlds is None else worlds.lend(world)
            engine = Engine(setting, journal, late, run.seed, FileLog(journal)).resume()
            engine.log.add_versions(own_versions())
            return cls._of(engine)
        except BaseException:
            journal.close()
            raise

    @staticmethod
    def read(store: str | Path) -> "RecordedNest":
        """Look at a recorded run, also while another process writes it; nothing can act in it.

        Raises:
            StoreError: There is no such run, or it cannot be read.
        """
        from beliefnest.nest.face.recorded import RecordedNest

        return RecordedNest.read(store)

    @classmethod
    def _of(cls, engine: Engine) -> Self:
        nest = cls.__new__(cls)
        nest._engine = engine
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

    @in_turn
    def close(self) -> None:
        """End the world and close the store."""
        self._engine.close()

    @property
    def setting(self) -> Setting:
        """What the nest started from."""
        return self._engine.setting

    @property
    def seed(self) -> int:
        """Drives every random number."""
        return self._engine.seed

    @property
    def scripted_world(self) -> ScriptedWorld:
        """The scripted world that is the real one.

        Raises:
            WorldError: The real world is a Minecraft one.
        """
        return self["/"].scripted

    @property
    def agents(self) -> tuple[str, ...]:
        """Names of all agents, sorted."""
        return self._engine.agents

    @property
    def reader(self) -> Reader:
        """What viewers read of the nest, on any of its timelines."""
        return Reader(self._engine)

    @property
    def tick(self) -> int:
        """The real world's latest tick."""
        return self._engine.info(()).head

    @in_turn
    def programs(self) -> Sequence[ProgramRecord]:
        """All programs that ran, on branches that are there, in order of their end."""
        return self._engine.log.programs()

    @in_turn
    def prompts(self) -> Sequence[PromptRecord]:
        """All requests to models that `Simulator.noting` kept, with what came of them."""
        return self._engine.log.prompts()

    @in_turn
    def versions(self) -> Sequence[Mapping[str, str]]:
        """Program to version, when the run began and whenever it was resumed with others."""
        return self._engine.log.versions()

    def __getitem__(self, path: str) -> Simulator:
        """The simulator of a belief path; `/` is the real world.

        Raises:
            PathError: The path is malformed or names an unknown agent.
        """
        return Simulator(self._engine, parse_path(path, self.agents))

    @in_turn
    def at(self, tick: int) -> "Past":
        """All simulators as they were at a past tick.

        Raises:
            TickError: The tick is no whole number, in the future or before the start.
        """
        then = tick_of(tick)
        self._engine.reading((), then)
        return Past(self._engine, then)

    @in_turn
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

    @in_turn
    def false_beliefs(self, path: str) -> list[Difference]:
        """What a simulator holds otherwise than reality (`a`) does; unknown is not false.

        Contents are false if they claim items that are not there, or claim to be complete
        and miss some.

        Raises:
            PathError: The path is malformed or names an unknown agent.
        """
        return false_beliefs(self._engine, parse_path(path, self.agents), None)

    def explore(
        self,
        path: str,
        agent: str,
        programs: Sequence[str],
        score: Score,
        timeout_ticks: int = 1200,
        name: str = "plan",
        processes: int | None = None,
    ) -> tuple[Attempt, ...]:
        """Try programs in one simulator, each on a branch of its own, from its present.

        Several can run at the same time, in bodies of their own; what comes of it, and what is
        recorded in which order, is the same as one after the other.

        Args:
            path: Belief path of the simulator; it ends on the branch it is on.
            agent: Whose bot runs them.
            programs: What to try.
            score: Says how good it is what a program led to.
            timeout_ticks: Ticks after which a program is stopped.
            name: What the branches are called: `NAME 1`, `NAME 2` and so on.
            processes: How many processes run programs at the same time; each further one
                takes about a second to start, once, and 200 MB as long as the nest is open.
                None: the first program runs alone; if the others would take more than four
                seconds, as many as there are processors run them, else they run one by one.

        Returns:
            One attempt for each program, in order, with its branch, result and score.

        Raises:
            PathError: The path or the agent is not there.
            BranchError: There is such a branch already; nothing was run.
            WorldError: The agent's pose is not known there, or the world runs no programs.
            InputError: `processes` is below 1.
        """
        self[path].child(agent)
        return Exploration(
            engine=self._engine,
            path=parse_path(path, self.agents),
            agent=agent,
            programs=tuple(programs),
            score=score,
            timeout_ticks=timeout_ticks,
            name=name,
            processes=processes,
        ).attempts()

    def play(self, on_progress: Progress | None = None) -> None:
        """Play the scenario's script in the real world, from the first step not played there.

        Raises:
            ProgramError: A program failed; the message says which step, where it is
                written, and the program's line.
            BodyError: The Minecraft side died again and again under a step.
        """
        script = self.setting.script
        programs = self._engine.log.programs()
        played = steps_played(self._engine.journal, self._engine.controller(()), programs)
        for number, step in enumerate(script[played:], start=played):
            if on_progress is not None:
                on_progress(step.label or f"step {number + 1}", number, len(script))
            self._play_step(number, step)
        if on_progress is not None:
            on_progress("script played", len(script), len(script))

    @in_turn
    def _play_step(self, number: int, step: Step) -> None:
        for _ in range(_TRIES):
            results = self._engine.run((), step.programs, step.timeout_ticks, {STEP: str(number)})
            # Nothing of it was kept, and it does again what it would have done.
            if not any(result.killed for result in results.values()):
                break
        for agent, result in results.items():
            if not result.ok:
                label = f" ({step.label})" if step.label else ""
                where = f"{step.where}: " if step.where else ""
                fault = BodyError if result.killed else ProgramError
                raise fault(
                    f"{where}step {number + 1}{label}: the program of {agent} failed: "
                    f"{result.error}"
                )


class Past(Looking):
    """All simulators at one past tick."""

    def __init__(self, engine: Engine, tick: int) -> None:
        self._engine = engine
        self._tick = tick

    def _moment(self) -> int:
        return self._tick

    def __getitem__(self, path: str) -> PastSimulator:
        """The simulator of a belief path as it was."""
        return PastSimulator(self._engine, parse_path(path, self._engine.agents), self._tick)

    @in_turn
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

    @in_turn
    def false_beliefs(self, path: str) -> list[Difference]:
        """What a simulator holds otherwise than reality (`a`) does; unknown is not false.

        Contents are false if they claim items that are not there, or claim to be complete
        and miss some.

        Raises:
            PathError: The path is malformed or names an unknown agent.
        """
        return false_beliefs(self._engine, parse_path(path, self._engine.agents), self._tick)


@dataclass(frozen=True, slots=True)
class _Start:
    """What a run is started with."""

    setting: Setting
    world: str
    seed: int
    text: str = ""
    templates: Mapping[str, str] = field(default_factory=dict)
    condition: int | None = None

    def record(self, world: World) -> RunRecord:
        """What the run file keeps of it."""
        return RunRecord(
            scenario=self.setting.name,
            text=self.text,
            condition="" if self.condition is None else str(self.condition),
            seed=self.seed,
            versions={**own_versions(), **world.versions},
            setting=encode_start(self.setting, self.world),
            templates=self.templates,
        )


def _begun(start: _Start, world: World, store: str | Path | None) -> Engine:
    if store is None:
        engine = Engine(start.setting, MemoryJournal(), world, start.seed)
        engine.log.add_versions(own_versions())
        return engine.begin()
    journal = SqliteJournal.create_file(store)
    try:
        with journal.together():
            journal.records.set_run(start.record(world))
            return Engine(start.setting, journal, world, start.seed, FileLog(journal)).begin()
    except BaseException:
        journal.close()
        raise
