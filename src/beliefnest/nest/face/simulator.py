"""Live simulator of a nest, as users work with it."""

from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from typing import TYPE_CHECKING, Literal

from beliefnest.belief.arrays import UNKNOWN
from beliefnest.belief.node_memory import paths_with_room
from beliefnest.belief.node_view import NodeView
from beliefnest.errors import BranchError, InputError, WorldError
from beliefnest.importing import part
from beliefnest.nest.acting.engine import Engine
from beliefnest.nest.face.given import check_branch_name, tick_of, whole
from beliefnest.nest.face.recording_model import RecordingModel
from beliefnest.nest.face.shown import ShownSimulator
from beliefnest.nest.face.turns import in_turn
from beliefnest.nest.past.recording import Recording
from beliefnest.timeline.journal import FOLLOW, TimelineInfo, TimelineKey
from beliefnest.timeline.run_records import Senses
from beliefnest.world.double_chests import believed_container_at, is_double, other_half, states_in
from beliefnest.world.paths import BeliefPath
from beliefnest.world.registry import Registry
from beliefnest.world.signs import plain_state, written
from beliefnest.world.texts import is_well_formed
from beliefnest.world.values import TICKS_PER_SECOND, Block, Items, Position
from beliefnest.worlds.protocol import ProgramPast, ProgramResult
from beliefnest.worlds.scripted.nest_world import ScriptedBody, ScriptedNestWorld
from beliefnest.worlds.scripted.world import ScriptedWorld

if TYPE_CHECKING:  # Models take long to import, and few nests have one.
    from beliefnest.episodes.imagination import Imagination
    from beliefnest.llm.messages import Model

Mode = Literal["control", "follow"]

_LONGEST = 24 * 3600 * TICKS_PER_SECOND


class Simulator(ShownSimulator):
    """The real world or a belief, live. Get one with `nest[path]`."""

    def __init__(self, engine: Engine, path: BeliefPath) -> None:
        super().__init__(engine.recording, path)
        self._engine = engine

    @property
    def mode(self) -> Mode:
        """The mode: `control` with a timeline of its own, otherwise `follow`."""
        return "control" if self._path in self._recording.selected else "follow"

    @property
    def branch(self) -> str:
        """The name of the selected branch; `follow` in follow mode."""
        key = self._recording.selected.get(self._path)
        return FOLLOW if key is None else key.branch

    @property
    @in_turn
    def scripted(self) -> ScriptedWorld:
        """The scripted world to act in, of a control-mode simulator without Minecraft.

        Raises:
            WorldError: The simulator's body is a Minecraft one.
            BranchError: The simulator is in follow mode.
        """
        body = self._engine.body(self._path)
        if not isinstance(body, ScriptedBody):
            raise WorldError(f"{self.path} is a Minecraft world; act in it with run()")
        return body.world

    def child(self, agent: str) -> "Simulator":
        """Return the simulator of the belief that `agent` has in this one."""
        return Simulator(self._engine, self._child_path(agent))

    @in_turn
    def switch(self, name: str, at: int | None = None) -> None:
        """Select a branch: a new name forks here, a known one restores its latest state.

        Args:
            name: Name of the branch. `follow` makes it follow the parent's belief again.
            at: Past tick to fork a new branch from; None: now.

        Raises:
            BranchError: The name is not allowed, or `at` is given for a known branch or `follow`.
            TickError: `at` is not a whole number, or in the future or before the start.
        """
        check_branch_name(name)
        if name == FOLLOW:
            if at is not None:
                raise BranchError(
                    f"{FOLLOW!r} always shows the present; fork tick {at} under another name"
                )
            self._engine.follow(self._path)
            return
        key = TimelineKey(self._path, name)
        if not self._recording.journal.has(key):
            self._engine.fork(self._path, name, None if at is None else tick_of(at))
        elif at is not None:
            raise BranchError(f"branch {name!r} exists; fork tick {at} under another name")
        else:
            self._engine.select(key)

    @in_turn
    def branches(self) -> tuple[TimelineInfo, ...]:
        """Return the simulator's own timelines with their fork points, in order of creation."""
        timelines = self._recording.journal.timelines()
        return tuple(info for info in timelines if info.key.path == self._path)

    @in_turn
    def rename(self, old: str, new: str) -> None:
        """Give a branch another name.

        Raises:
            BranchError: There is no branch `old`, or one `new`, or the name is not allowed.
        """
        check_branch_name(new)
        if new == FOLLOW:
            raise BranchError(f"{FOLLOW!r} is reserved for follow mode; choose another branch")
        self._engine.rename(TimelineKey(self._path, old), new)

    @in_turn
    def delete(self, name: str, recursive: bool = False) -> None:
        """Delete a branch permanently.

        Args:
            name: Name of the branch.
            recursive: True to delete all timelines that were forked from it as well, including
                branches of beliefs.

        Raises:
            BranchError: There is no such branch, a simulator is on it, or other timelines were
                forked from it and `recursive` is not set.
        """
        journal = self._recording.journal
        key = journal.info(TimelineKey(self._path, name)).key
        self._engine.delete([*(_based_on(key, journal.timelines()) if recursive else ()), key])

    @in_turn
    def describe(self, name: str, text: str) -> None:
        """Store a description of a branch.

        Raises:
            BranchError: There is no branch of that name.
            InputError: The description is not a text.
        """
        if not isinstance(text, str):
            raise InputError(f"the description is {text!r}; give a text")
        self._recording.journal.describe(TimelineKey(self._path, name), text)

    def run(
        self, agent: str, code: str, timeout_ticks: int = 1200, senses: Senses = "world"
    ) -> ProgramResult:
        """Run a program as an agent of this simulator, which must be in control mode.

        Args:
            agent: Name of the agent whose bot runs the program.
            code: JavaScript: the body of an async function, or one whole async function.
            timeout_ticks: Ticks after which the program is stopped, at most those of a day.
            senses: `world`: the program reads the whole world; `percepts`: only what its agent
                perceives or remembers.

        Raises:
            InputError: The code is not a text, or the number of ticks is not allowed.
            PathError: There is no such agent.
            BranchError: The simulator is in follow mode.
            WorldError: The agent is not in the simulator, or the world cannot run programs.
            BodyError: The Minecraft side failed, or its process ended at every attempt before the
                program began. If it ends while the program runs, the result says so (`killed`).
        """
        return self.run_all({agent: code}, timeout_ticks, senses)[agent]

    @in_turn
    def run_all(
        self,
        programs: Mapping[str, str],
        timeout_ticks: int = 1200,
        senses: Senses = "world",
        past: Mapping[str, ProgramPast] | None = None,
        mute: Collection[str] = (),
    ) -> Mapping[str, ProgramResult]:
        """Run programs of several agents at the same time, tick by tick together.

        Args:
            programs: Texts of the programs by agent.
            timeout_ticks: As for `run`.
            senses: As for `run`.
            past: Pasts of interrupted programs by agent, from which they continue. With any
                mapping, even an empty one, results list the calls of programs.
            mute: Agents that cannot say or whisper anything; their programs fail if they try.

        Raises:
            InputError: There is no program, or as for `run`.
        """
        if not isinstance(programs, Mapping) or not programs:
            raise InputError(f"no program is in {programs!r}; give a mapping from agent to code")
        for agent, code in programs.items():
            self._child_path(agent)
            if not isinstance(code, str):
                raise InputError(
                    f"the program of {agent} is of type {type(code).__name__}; give a text"
                )
            if not is_well_formed(code):
                raise InputError(
                    f"the program of {agent} has half a character in it (a lone surrogate); "
                    "write the whole character, or an escape such as \\u{1f600}"
                )
        check_senses(senses)
        ticks = _timeout(timeout_ticks)
        return self._engine.run(self._path, programs, ticks, None, senses, past, mute)

    def noting(self, model: "Model", **detail: str) -> "Model":
        """Return a model that asks another one and records each request and answer in the run.

        Give it to `ask_for_program` in place of the model. `Nest.prompts` lists the records.

        Args:
            model: The model to ask.
            detail: Facts to record with every request, for example `task`.
        """
        return RecordingModel(model, self._recording, self._path, detail)

    @in_turn
    def step(self, ticks: int = 1) -> None:
        """Let ticks pass in a control-mode simulator.

        Raises:
            InputError: The number is not whole, is below 0, or is more than a day has.
            BranchError: The simulator is in follow mode.
        """
        number = whole(ticks)
        if number is None or not 0 <= number <= _LONGEST:
            raise InputError(
                f"{ticks!r} ticks cannot pass; give a whole number from 0 to {_LONGEST}"
            )
        self._engine.step(self._path, number)

    @in_turn
    def edit(
        self,
        blocks: Mapping[Position, str | None] | None = None,
        containers: Mapping[Position, Items] | None = None,
        signs: Mapping[Position, str] | None = None,
    ) -> None:
        """Change blocks, contents or texts of signs by hand. The change is recorded as an edit.

        Args:
            blocks: New block state texts; None makes a block unknown.
            containers: New contents, which then count as complete; of a double chest, those given
                for both halves are added up.
            signs: New texts of signs, also of signs that `blocks` puts; line breaks separate lines.

        Raises:
            PositionError: A position is outside the box.
            UnknownNameError: There is no such block or item.
            InputError: A block is not a known sign, or a text does not fit on a sign.
        """
        registry = self._recording.context.registry
        box = self._recording.box
        for position in (*(blocks or {}), *(containers or {}), *(signs or {})):
            box.check(position)
        states: dict[Position, Block] = {
            position: -1 if text is None else registry.state_id(text)
            for position, text in (blocks or {}).items()
        }
        for position, text in (signs or {}).items():
            present = self._recording.state(self._path).terrain[box.index(position)]
            state = plain_state(states.get(position, present))
            states[position] = written(registry, state, text)
        for items in (containers or {}).values():
            for name, count in items.items():
                registry.item_stack(name)
                if count <= 0:
                    raise InputError(
                        f"a container cannot hold {count} {name}; give a count above 0"
                    )
        view = self._recording.state(self._path)
        states = {**_parted(registry, view, states), **states}
        state_now = states_in(box, view.terrain, UNKNOWN)

        def state_at(at: Position) -> int:
            return plain_state(states[at]) if at in states else state_now(at)

        contents: dict[Position, dict[str, int]] = {}
        for position, items in (containers or {}).items():
            place = believed_container_at(registry, state_at, position)
            contents[place] = dict(Counter(contents.get(place, {})) + Counter(items))
        self._engine.edit(self._path, states, contents)

    @in_turn
    def embody(self, stands: bool = True, *, unknown: str = "air") -> None:
        """Show the simulator's state in Minecraft for people to visit, or remove it again.

        The state stands beyond the view distance of the real world. While the nest lets time pass
        it is kept up to date tick by tick: blocks, known contents, signs, and agents of known pose,
        under names of their own. `Nest.layout` says where it stands and how to go there. It shows
        the branch on which the simulator is. Visitors cannot change it.

        Args:
            stands: True to show it, False to remove it. Repeating either does nothing.
            unknown: Name of the block that stands for unknown blocks.

        Raises:
            InputError: The simulator is the real world, people cannot join this world, or an
                argument has the wrong type.
            UnknownNameError: There is no such block.
            WorldError: The place on a server holds other blocks.
            BodyError: The state could not be built.
        """
        if stands is not True and stands is not False:
            raise InputError(f"embody() was given {stands!r}; give True, or False to end it")
        if not isinstance(unknown, str):
            raise InputError(f"unknown is {unknown!r}; give the name of a block")
        visitable = self._engine.visitable
        if visitable is None:
            if stands:
                raise InputError(
                    "nobody can visit a belief in this world, because it does not run in real "
                    "time; open the nest with realtime=True, listen=25565, or on a server with "
                    'world="minecraft://HOST:PORT"'
                )
        elif stands:
            visitable.begin(self._path, unknown)
        else:
            visitable.end(self._path)

    def _live_on(self, recording: Recording) -> "Simulator":
        return Simulator(Engine(recording, ScriptedNestWorld()), self._path)

    @in_turn
    def imagination(self, depth: int = 1, pace: int = 1, tick: int | None = None) -> "Imagination":
        """Return the state at a tick as a world of its own, to try out courses without recording.

        That world is scripted, whatever the real world is: see docs/scripted-world.md.

        Args:
            depth: Number of levels below the simulator at which beliefs are followed.
            pace: Number of ticks of the real world that one tick stands for.
            tick: A past tick; 0: the first; None: the latest.

        Raises:
            InputError: The depth is below 0, or so great that memory has no room for the beliefs.
            TickError: The tick is in the future or before the start.
        """
        if depth < 0:
            raise InputError(f"depth is {depth}; give a whole number from 0 on")
        recording = self._recording
        if tick == 0:
            first = recording.stretches(recording.moment(self._path))[0]
            tick = recording.journal.info(first.timeline).start
        moment = recording.moment(self._path, tick)
        paths = paths_with_room(recording.context, self._path, depth)
        if tick is None:
            recording.history.expect(moment.timeline, paths)
            for path in paths:
                forest = recording.history.shared(moment.timeline, path, moment.entries)
        else:
            forest = recording.history.walk(moment.timeline, paths)
            recording.history.advance(moment.timeline, forest, moment.entries)
        speech = -(-forest.context.options.speech_ticks // pace)
        grounds = recording.remembered.setdefault("grounds of imaginations", {})
        imagination: Imagination = part("imagination")(
            forest, self._path, depth, moment.tick, grounds, speech_ticks=speech
        )
        return imagination


def check_senses(senses: object) -> None:
    """Raise InputError for a value that is not one of `Senses`."""
    if senses not in ("world", "percepts"):
        raise InputError(f"senses is {senses!r}; give 'world' or 'percepts'")


def _timeout(ticks: int) -> int:
    number = whole(ticks)
    if number is None or not 1 <= number <= _LONGEST:
        raise InputError(f"timeout_ticks is {ticks!r}; give a whole number, at most {_LONGEST}")
    return number


def _based_on(key: TimelineKey, infos: Sequence[TimelineInfo]) -> list[TimelineKey]:
    """Return all timelines that were forked from one, each after its own forks."""
    resting = {key}
    for info in infos:
        if info.base is not None and info.base.timeline in resting:
            resting.add(info.key)
    return [info.key for info in reversed(infos) if info.key in resting and info.key != key]


def _parted(
    registry: Registry, view: NodeView, states: Mapping[Position, Block]
) -> dict[Position, Block]:
    """Return single chests for the halves of double chests whose other half is replaced."""
    state_at = states_in(view.box, view.terrain, UNKNOWN)
    single: dict[Position, Block] = {}
    for place, block in states.items():
        other = other_half(registry, state_at(place), place)
        replaced = plain_state(block)
        if (
            other is not None
            and is_double(registry, state_at, place)
            and replaced >= 0
            and registry.name(replaced) != registry.name(state_at(place))
        ):
            single[other[0]] = registry.changed(state_at(other[0]), type="single")
    return single
