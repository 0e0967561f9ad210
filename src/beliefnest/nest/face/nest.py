"""Nest: the real world and all beliefs in it."""

import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Self

from beliefnest.belief.grounds import InitialBelief
from beliefnest.belief.view import State
from beliefnest.errors import InputError, UnknownNameError, WorldError
from beliefnest.nest.acting.engine import Engine
from beliefnest.nest.acting.frame_recorder import ChatListener
from beliefnest.nest.acting.script import OnProgress, play_script
from beliefnest.nest.face.base import NestBase
from beliefnest.nest.face.exploration import Attempt, Exploration, ScoreFunction, programs_by_name
from beliefnest.nest.face.given import tick_of
from beliefnest.nest.face.opening import BareSetting, HasSetting, as_scenario, begun, resumed
from beliefnest.nest.face.recorded import RecordedNest
from beliefnest.nest.face.shown import Past
from beliefnest.nest.face.simulator import Simulator
from beliefnest.nest.face.turns import in_turn
from beliefnest.nest.past.over_time import StatesAfter, TickWalk, each_entry
from beliefnest.nest.past.setting import Setting
from beliefnest.nest.past.unique import unique_items
from beliefnest.owned import is_own
from beliefnest.perception.options import Perception
from beliefnest.prompts import Renderer
from beliefnest.timeline.journal import Entry
from beliefnest.timeline.run_records import Senses
from beliefnest.world.nameable import ClaimsFrom
from beliefnest.world.paths import BeliefPath, parse_path
from beliefnest.world.seeds import checked_seed
from beliefnest.world.values import TICKS_PER_SECOND, Position
from beliefnest.worlds.by_name import Worlds, open_world
from beliefnest.worlds.names import world_name
from beliefnest.worlds.process_limits import ProcessLimits
from beliefnest.worlds.protocol import RealtimePlay
from beliefnest.worlds.scripted.nest_world import ScriptedNestWorld
from beliefnest.worlds.scripted.world import ScriptedWorld

if TYPE_CHECKING:
    from beliefnest.visits.layout import Layout

_PATIENCE_S = 600.0
_LONGEST_S = 24 * 60 * 60


class Nest(NestBase):
    """The real world and every belief in it. Each simulator is made when it is first used.

    `Nest(world)` wraps a `ScriptedWorld` and follows what happens in it. `Nest.open` opens a
    scenario in a world of its own. Use the nest in a `with` block, or close it. Wherever a belief
    path is given, one that is malformed or names an unknown agent raises PathError.

    Args:
        world: The scripted world that serves as the real world.
        perception: Options of perception; None: the defaults.
        static_blocks: Names and positions of blocks that everybody knows from the start.
        initial_beliefs: Further priors, at any depth.
        store: File to record in; None: memory.
        claims_from: Function or model that reads claims out of utterances without claims
            (docs/claims.md); None: nobody reads them.
        unique: Items that everybody knows to be unique. An agent that perceives such
            an item in one place believes it to be nowhere else.
    """

    def __init__(
        self,
        world: ScriptedWorld,
        perception: Perception | None = None,
        static_blocks: Iterable[str | Position] = (),
        initial_beliefs: Iterable[InitialBelief] = (),
        store: str | Path | None = None,
        claims_from: ClaimsFrom | None = None,
        unique: Iterable[str] = (),
    ) -> None:
        if not isinstance(world, ScriptedWorld):
            raise InputError(
                f"Nest(world) takes a ScriptedWorld, not {type(world).__name__}; open a scenario "
                "with bn.Nest.open(scenario)"
            )
        setting = Setting(
            name="scripted",
            snapshot=world.snapshot(),
            perception=perception or Perception(),
            static_blocks=frozenset(static_blocks),
            initial_beliefs=tuple(initial_beliefs),
            unique=unique_items(unique),
        )
        bodies = ScriptedNestWorld(world)
        self._hold(begun(BareSetting(setting), bodies, "scripted", 0, store, claims_from))

    @classmethod
    def open(
        cls,
        scenario: HasSetting | Setting,
        world: str = "embedded",
        store: str | Path | None = None,
        seed: int = 0,
        worlds: Worlds | None = None,
        limits: ProcessLimits | None = None,
        claims_from: ClaimsFrom | None = None,
        renderer: Renderer | None = None,
        *,
        realtime: bool = False,
        listen: int | str | None = None,
    ) -> Self:
        """Open a scenario in a world.

        Args:
            scenario: The scenario or setting to open.
            world: `embedded`, `scripted`, or the address of a server (docs/servers.md).
            store: File to record in; None: memory.
            seed: Seed of every random number.
            worlds: Pool that lends the world to one nest after the other; None: start a world.
            limits: Memory and time that the world's process may use, if one is started.
            claims_from: Function or model that reads claims out of utterances; None: nobody does.
            renderer: Renderer of prompts with filters of your own, `Renderer(filters)`; several
                nests may share it. None: a new one.
            realtime: True if the embedded world runs in real time, so that people can join
                (docs/people.md).
            listen: Address at which people join: a port of this machine, or HOST:PORT; 0: any free
                port; None: Minecraft's port 25565.

        Raises:
            BodyError: The world could not be started.
            UnknownNameError: There is no such world.
            InputError: The scenario has people but nobody can join the world, or the seed is not a
                whole number of 64 bits.
            StoreError: The store exists already, or cannot be written.
        """
        world, seed = world_name(world, realtime=realtime, listen=listen), checked_seed(seed)
        started = as_scenario(scenario)
        opened = open_world(world, seed, limits) if worlds is None else worlds.lend(world)
        try:
            return cls._of(begun(started, opened, world, seed, store, claims_from, renderer))
        except BaseException:
            opened.close()
            raise

    @classmethod
    def resume(
        cls,
        store: str | Path,
        limits: ProcessLimits | None = None,
        worlds: Worlds | None = None,
        claims_from: ClaimsFrom | None = None,
        renderer: Renderer | None = None,
    ) -> Self:
        """Continue a recorded run where it was left, on every branch, with its seed.

        The world starts, and bodies are opened, when they are first needed.

        Args:
            store: The run file.
            limits: Memory and time that the world's process may use.
            worlds: Pool that lends the world to one nest after the other; None: start a world.
            claims_from: Function or model that reads claims out of utterances from now on; None:
                nobody does. Claims that were read before are in the record.
            renderer: Renderer of prompts, which is not recorded; None: a new one.

        Raises:
            StoreError: There is no such run, it cannot be read or written, or another process
                writes to it.
        """
        return cls._of(resumed(store, limits, worlds, claims_from, renderer))

    @staticmethod
    def read(store: str | Path) -> RecordedNest:
        """Open a recorded run for reading, also while another process writes it.

        Raises:
            StoreError: There is no such run, or it cannot be read.
        """
        return RecordedNest.read(store)

    @classmethod
    def _of(cls, engine: Engine) -> Self:
        nest = cls.__new__(cls)
        nest._hold(engine)
        return nest

    def _hold(self, engine: Engine) -> None:
        self._engine = engine
        self._recording = engine.recording

    def close(self) -> None:
        """End the world and close the store. Do nothing in a forked child: its parent owns them."""
        if is_own(self._recording):
            with self._recording.turn:
                self._engine.close()

    @property
    def scripted_world(self) -> ScriptedWorld:
        """The scripted world that serves as the real world.

        Raises:
            WorldError: The real world is a Minecraft one.
        """
        return self["/"].scripted

    def __getitem__(self, path: str) -> Simulator:
        """Return the simulator of a belief path; `/` is the real world."""
        return Simulator(self._engine, parse_path(path, self.agents))

    @in_turn
    def states(self, paths: Iterable[str]) -> Mapping[str, State]:
        """Return the states of several simulators by path, read-only; faster than one by one.

        Args:
            paths: Belief paths; the keys of the result are these texts.

        Raises:
            PathError: A path is malformed or names an unknown agent.
        """
        nodes = {path: parse_path(path, self.agents) for path in paths}
        states = self._recording.states(nodes.values())
        return {path: states[node] for path, node in nodes.items()}

    @in_turn
    def at(self, tick: int) -> Past:
        """Return all simulators as they were at a past tick.

        Raises:
            TickError: The tick is not a whole number, or in the future or before the start.
        """
        then = tick_of(tick)
        self._recording.moment((), then)
        return Past(self._recording, then)

    def explore(
        self,
        path: str,
        agent: str,
        programs: Mapping[str, str] | Sequence[str],
        score: ScoreFunction,
        timeout_ticks: int = 1200,
        name: str = "plan",
        processes: int | None = None,
        senses: Senses = "world",
    ) -> tuple[Attempt, ...]:
        """Try programs in one simulator from its present, each on a branch of its own.

        Several can run at the same time, in bodies of their own. Results, records and their order
        are the same as if they ran one after the other.

        Args:
            path: Belief path of the simulator. At the end it is again on its present branch.
            agent: Name of the agent whose bot runs the programs.
            programs: Texts of the programs to try, or texts by name.
            score: Function that rates the outcome of a program: by a number, or by a mapping from
                names to numbers.
            timeout_ticks: Ticks after which a program is stopped.
            name: Prefix of the branch names: `NAME 1`, `NAME 2` and so on, or with the names of
                the programs.
            processes: Number of processes that run programs at the same time. Each further process
                takes about a second to start, once, and 200 MB while the nest is open. None: the
                first program runs alone; the others use all processors if they would take more
                than four seconds one by one.
            senses: `world`: programs read the whole world; `percepts`: only what their agent
                perceives or remembers. With `percepts` they always run one by one.

        Returns:
            An attempt for each program, in order. If anything fails, no branch is left.

        Raises:
            PathError: There is no such path or agent.
            BranchError: One of the branches exists already. Nothing was run.
            WorldError: The agent's pose is not known there, or the world runs no programs.
            InputError: `processes` is below 1, `senses` is none of the two, the path is `/` and
                the real world runs in real time, or the score is no number.
        """
        self[path].child(agent)
        parsed = parse_path(path, self.agents)
        if not parsed and self._engine.world.realtime is not None:
            raise InputError(
                "this real world runs in real time, so programs cannot be tried out in it; explore "
                "a belief instead, which is played in the embedded world"
            )
        return Exploration(
            engine=self._engine,
            path=parsed,
            agent=agent,
            programs=programs_by_name(programs),
            score=score,
            timeout_ticks=timeout_ticks,
            name=name,
            processes=processes,
            senses=senses,
        ).attempts()

    @contextmanager
    def together(self) -> Iterator[None]:
        """Record everything that happens in the real world inside the block, or nothing of it."""
        with self._recording.turn, self._engine.bodies.changing(()):
            yield

    @in_turn
    def keep(self, name: str, value: bytes) -> None:
        """Store bytes in the run under a name, and replace those stored before."""
        self._recording.records.put_state(f"kept {name}", value)

    def each_entry(
        self, paths: Sequence[BeliefPath], after: int, until: int, walk: TickWalk | None = None
    ) -> Iterator[tuple[Entry, StatesAfter]]:
        """Yield each entry of the real world's timeline with a function that returns states.

        The simulators follow the real world. Entries whose states nobody asks for cost little.

        Args:
            paths: The simulators.
            after: Last tick to leave out.
            until: Last tick to yield.
            walk: Place up to which the caller has read these simulators; None: none was read.

        Yields:
            An entry, and a function that returns the states after it. Call it, and read what it
            returns, before you ask for the next entry.
        """
        with self._recording.turn:
            yield from each_entry(self._recording, paths, after, until, walk)

    def play(self, on_progress: OnProgress | None = None) -> None:
        """Play the scenario's script in the real world, from the first step that was not played.

        Wait for the people of the scenario first, as `wait_for_people` does.

        Raises:
            WorldError: A person did not join.
            ProgramError: A program failed. The message names the step, its file and line, and the
                line of the program.
            BodyError: The process of the Minecraft side ended at every attempt of a step.
        """
        self.wait_for_people(on_progress=on_progress)
        play_script(self._engine, on_progress)

    def wait(self, until: Callable[[], bool] | None = None, timeout_s: float = 60.0) -> bool:
        """Let time pass in the real world, tick by tick, and record what happens in it.

        On a server time passes by itself, so everything since the last call is recorded first. In
        the embedded and the scripted world time passes as fast as it can.

        Args:
            until: Function called after every tick; True ends the wait. None: wait for the whole
                time.
            timeout_s: Greatest time to wait, in seconds of the world's time (20 ticks each).

        Returns:
            True if `until` held, or if there is none.

        Raises:
            InputError: The time is below 0, or longer than a day.
            BodyError: The Minecraft side failed, or the server has stopped.
        """
        if not 0 <= timeout_s <= _LONGEST_S:
            raise InputError(
                f"timeout_s is {timeout_s!r}; give a number of seconds from 0 to {_LONGEST_S}"
            )
        self._pass(0)
        last = self._head() + round(timeout_s * TICKS_PER_SECOND)
        while until is None or not until():
            if self._head() >= last:
                return until is None
            self._pass(1)
        return True

    def on_chat(self, callback: ChatListener) -> None:
        """Call a function with each utterance and whisper in the real world from now on.

        Its arguments are tick, speaker and text. It is called in the thread, and at the end, of the
        call of the nest that records the utterance. It may use the nest.

        Raises:
            InputError: The callback is not a function.
        """
        if not callable(callback):
            raise InputError(
                f"on_chat() was given {callback!r}; give a function of tick, speaker and text"
            )
        self._engine.bodies.chat_listeners.append(callback)

    @in_turn
    def _pass(self, ticks: int) -> None:
        self._engine.step((), ticks)

    @in_turn
    def _head(self) -> int:
        return self._recording.info(()).head

    @property
    def address(self) -> str | None:
        """The address at which Minecraft clients join, `HOST:PORT`; None if people cannot join."""
        host = self._engine.world.realtime
        return None if host is None else host.address

    @property
    @in_turn
    def people(self) -> frozenset[str]:
        """The names of the people who are joined now."""
        host = self._engine.world.realtime
        return frozenset() if host is None or not host.invited else host.here()

    def wait_for_people(
        self, timeout_s: float = _PATIENCE_S, on_progress: OnProgress | None = None
    ) -> None:
        """Wait until all people of the scenario have joined. Time passes meanwhile.

        Args:
            timeout_s: Greatest number of seconds to wait.
            on_progress: Function called with a line that says who has to join, where and how; None:
                print the line to stderr.

        Raises:
            InputError: The time is below 0, or longer than a day.
            WorldError: A person did not join.
        """
        host = self._engine.world.realtime
        if host is None or not host.invited:
            return
        shown: frozenset[str] | None = None

        def all_here() -> bool:
            nonlocal shown
            awaited = host.invited - self.people
            if awaited and awaited != shown:
                _tell(_line(host, awaited), len(host.invited - awaited), len(host.invited))
            shown = awaited
            return not awaited

        def _tell(line: str, done: int, total: int) -> None:
            if on_progress is None:
                sys.stderr.write(f"{line}\n")
            else:
                on_progress(line, done, total)

        if not self.wait(all_here, timeout_s):
            awaited = host.invited - self.people
            raise WorldError(
                f"{_names(awaited)} did not join within {timeout_s:g} s; {_line(host, awaited)}; "
                "or let programs act instead, with nest.take_over(NAME)"
            )

    @in_turn
    def take_over(self, name: str) -> None:
        """Let programs act for a person until `hand_back`. Disconnect the person if joined.

        Raises:
            UnknownNameError: The scenario has no person of that name.
        """
        host = self._host_of_person(name)
        host.invite(host.invited - {name})

    @in_turn
    def hand_back(self, name: str) -> None:
        """Let a person join again after `take_over`. The agent stands still until then.

        Raises:
            UnknownNameError: The scenario has no person of that name.
        """
        host = self._host_of_person(name)
        host.invite(host.invited | {name})

    @in_turn
    def pause(self) -> None:
        """Stop the real world until `go_on`.

        No tick passes. Acts and utterances of people have no effect, and people see a message.
        Beliefs can be read, forked and acted in meanwhile. A pause is not recorded, because no time
        passes in it.

        Raises:
            WorldError: The world does not run in real time, or is on a server elsewhere.
        """
        self._real_time_world().pause(paused=True)

    @in_turn
    def go_on(self) -> None:
        """Let the real world run again after `pause`. Do nothing if it runs.

        Raises:
            WorldError: The world does not run in real time, or is on a server elsewhere.
        """
        self._real_time_world().pause(paused=False)

    def _real_time_world(self) -> RealtimePlay:
        world = self._engine.world.realtime
        if world is None:
            raise WorldError(
                "this world does not run in real time, so there is nothing to pause: no time "
                "passes between calls"
            )
        return world

    def _host_of_person(self, name: str) -> RealtimePlay:
        people = self._recording.setting.people
        if name not in people:
            names = ", ".join(sorted(people)) or "none"
            raise UnknownNameError(f"this scenario has no person {name!r}; its people are {names}")
        host = self._engine.world.realtime
        if host is None:
            raise InputError(
                f"{name} is a person, and people cannot join this world; open it with "
                "realtime=True, listen=25565"
            )
        return host

    @in_turn
    def layout(self) -> "Layout":
        """Return the places of the real world and of all embodied simulators in Minecraft.

        Raises:
            InputError: The real world does not run in real time, so nobody can visit it.
        """
        if self._engine.visitable is None:
            raise InputError(
                "nothing stands where people could go, because this world does not run in real "
                "time; open the nest with realtime=True, listen=25565, or on a server"
            )
        return self._engine.visitable.layout()


def _names(people: frozenset[str]) -> str:
    return " and ".join(sorted(people))


def _line(host: RealtimePlay, awaited: frozenset[str]) -> str:
    return (
        f"join as {' or '.join(sorted(awaited))}: "
        f"Minecraft Java edition {host.minecraft}, Multiplayer, Direct Connection, {host.address}"
    )
