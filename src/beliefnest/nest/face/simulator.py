"""One simulator of the nest, as its users hold it."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Literal

from beliefnest.bodies.protocol import ProgramPast, ProgramResult
from beliefnest.bodies.scripted import ScriptedBody
from beliefnest.errors import BranchError, InputError, WorldError
from beliefnest.nest.acting.engine import Engine
from beliefnest.nest.acting.imagination import Imagination
from beliefnest.nest.face.recording_model import RecordingModel
from beliefnest.nest.face.shown import ShownSimulator
from beliefnest.nest.face.ticks import tick_of, whole
from beliefnest.nest.face.turns import in_turn
from beliefnest.nest.past.setting import Senses
from beliefnest.timeline.journal import FOLLOW, TimelineInfo, TimelineKey
from beliefnest.world.paths import BeliefPath, paths_below
from beliefnest.world.scripted import ScriptedWorld
from beliefnest.world.signs import plain_state, written
from beliefnest.world.texts import is_well_formed
from beliefnest.world.values import TICKS_PER_SECOND, Block, Items, Position

if TYPE_CHECKING:  # Models take long to import, and few nests have one.
    from beliefnest.llm.messages import Model

__all__ = ["Simulator", "check_senses"]

Mode = Literal["control", "follow"]

_LONGEST = 24 * 3600 * TICKS_PER_SECOND


class Simulator(ShownSimulator):
    """The real world or a belief, live; `Nest[path]` gives one."""

    def __init__(self, engine: Engine, path: BeliefPath) -> None:
        super().__init__(engine.recording, path)
        self._engine = engine

    @property
    def mode(self) -> Mode:
        """`control` with a timeline of its own, else `follow`."""
        return "control" if self._path in self._recording.selected else "follow"

    @property
    def branch(self) -> str:
        """Name of the selected branch; `follow` in follow mode."""
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
            raise WorldError(f"{self.path} lives in Minecraft; act in it with run()")
        return body.world

    def child(self, agent: str) -> "Simulator":
        """Return the simulator of what `agent` believes in this one."""
        return Simulator(self._engine, self._child_path(agent))

    @in_turn
    def switch(self, name: str, at: int | None = None) -> None:
        """Select a branch: a new name forks here, a known one restores its latest state.

        Args:
            name: The branch; `follow` goes back to following the parent's belief.
            at: Past tick to fork a new branch from; None: now.

        Raises:
            BranchError: The name is not allowed, or `at` is given for a known branch or `follow`.
            TickError: `at` is no whole number, in the future or before the start.
        """
        _check_branch_name(name)
        if name == FOLLOW:
            if at is not None:
                raise BranchError(
                    f"{FOLLOW!r} goes on with the present; fork tick {at} under a name"
                )
            self._engine.follow(self._path)
            return
        key = TimelineKey(self._path, name)
        if all(info.key != key for info in self._recording.journal.timelines()):
            self._engine.fork(self._path, name, None if at is None else tick_of(at))
        elif at is not None:
            raise BranchError(f"branch {name!r} exists; fork tick {at} under another name")
        else:
            self._engine.select(key)

    @in_turn
    def branches(self) -> tuple[TimelineInfo, ...]:
        """Return the simulator's own timelines, in order of creation, each with its fork point."""
        timelines = self._recording.journal.timelines()
        return tuple(info for info in timelines if info.key.path == self._path)

    @in_turn
    def rename(self, old: str, new: str) -> None:
        """Give a branch another name.

        Raises:
            BranchError: There is no branch `old`, or one `new`, or the name is not allowed.
        """
        _check_branch_name(new)
        if new == FOLLOW:
            raise BranchError(f"{FOLLOW!r} is the name of no branch; choose another one")
        self._engine.rename(TimelineKey(self._path, old), new)

    @in_turn
    def delete(self, name: str, recursive: bool = False) -> None:
        """Delete a branch, for good.

        Args:
            name: The branch.
            recursive: Whether to delete what is based on it as well, beliefs' branches too.

        Raises:
            BranchError: There is no such branch, a simulator is on it, or others are based
                on it and `recursive` is not set.
        """
        journal = self._recording.journal
        key = journal.info(TimelineKey(self._path, name)).key
        self._engine.delete([*(_based_on(key, journal.timelines()) if recursive else ()), key])

    @in_turn
    def describe(self, name: str, text: str) -> None:
        """Say what a branch is for.

        Raises:
            BranchError: There is no branch of that name.
            InputError: The description is no text.
        """
        if not isinstance(text, str):
            raise InputError(f"a description is a text, not {text!r}")
        self._recording.journal.describe(TimelineKey(self._path, name), text)

    def run(
        self, agent: str, code: str, timeout_ticks: int = 1200, senses: Senses = "world"
    ) -> ProgramResult:
        """Run a program as an agent of this simulator, which must be in control mode.

        Args:
            agent: Whose bot runs it.
            code: JavaScript: the body of an async function, or one whole async function.
            timeout_ticks: Ticks after which the program is stopped, at most those of a day.
            senses: `percepts`: it reads no more than its agent perceives or remembers.

        Raises:
            InputError: The code is no text, or the ticks are no such number.
            PathError: There is no such agent.
            BranchError: The simulator is in follow mode.
            WorldError: The agent is not in it, or the world runs no programs.
            BodyError: The Minecraft side failed, or died again and again before the program
                began. If it dies under the program, the result says so (`killed`).
        """
        return self.run_all({agent: code}, timeout_ticks, senses)[agent]

    @in_turn
    def run_all(
        self,
        programs: Mapping[str, str],
        timeout_ticks: int = 1200,
        senses: Senses = "world",
        past: Mapping[str, ProgramPast] | None = None,
    ) -> Mapping[str, ProgramResult]:
        """Run programs of several agents at the same time, tick by tick together.

        Args:
            programs: Their texts by agent.
            timeout_ticks: As for `run`.
            senses: As for `run`.
            past: What programs had done when they were cut, by agent: they go on with it. With a
                mapping, be it empty, results list what programs called.

        Raises:
            InputError: There is no program, or as for `run`.
        """
        if not isinstance(programs, Mapping) or not programs:
            raise InputError(f"no program is in {programs!r}; give a mapping of code by agent")
        for agent, code in programs.items():
            self._child_path(agent)
            if not isinstance(code, str):
                raise InputError(f"the program of {agent} is a text, not {type(code).__name__}")
            if not is_well_formed(code):
                raise InputError(
                    f"the program of {agent} has half of a character in it; write the whole "
                    "character, or an escape such as \\u{1f600}"
                )
        check_senses(senses)
        return self._engine.run(self._path, programs, _timeout(timeout_ticks), None, senses, past)

    def noting(self, model: "Model", **detail: str) -> "Model":
        """Return a model whose conversation with the caller is kept in the run, request by request.

        Give it to `ask_for_program` in place of the model; `Nest.prompts` lists what was kept.

        Args:
            model: Who is asked.
            detail: Facts to keep with every request, as `task`.
        """
        return RecordingModel(model, self._recording, self._path, detail)

    @in_turn
    def step(self, ticks: int = 1) -> None:
        """Let ticks pass in a control-mode simulator.

        Raises:
            InputError: The number is not whole, below 0, or more than a day takes.
            BranchError: The simulator is in follow mode.
        """
        number = whole(ticks)
        if number is None or not 0 <= number <= _LONGEST:
            raise InputError(
                f"{ticks!r} ticks cannot pass; give a whole number, at most {_LONGEST}"
            )
        self._engine.step(self._path, number)

    @in_turn
    def edit(
        self,
        blocks: Mapping[Position, str | None] | None = None,
        containers: Mapping[Position, Items] | None = None,
        signs: Mapping[Position, str] | None = None,
    ) -> None:
        """Change blocks, contents or texts of signs by hand; it is recorded as an edit.

        Args:
            blocks: New block state texts; None makes a block unknown.
            containers: New contents, which are then complete.
            signs: New texts of signs, those of `blocks` among them; lines are split by line breaks.

        Raises:
            PositionError: A position is outside the box.
            UnknownNameError: There is no such block or item.
            InputError: A block is no known sign, or a text does not fit on one.
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
            held = self._recording.reading(self._path).blocks[box.index(position)]
            state = plain_state(states.get(position, int(held)))
            states[position] = written(registry, state, text)
        for items in (containers or {}).values():
            for name, count in items.items():
                registry.item_stack(name)
                if count <= 0:
                    raise InputError(f"{count} {name} cannot be held; give a count above 0")
        self._engine.edit(self._path, states, {p: dict(i) for p, i in (containers or {}).items()})

    @in_turn
    def embody(self, stands: bool = True, *, unknown: str = "air") -> None:
        """Let what it holds stand in Minecraft, for people to visit, or no longer.

        It stands beyond view distance of reality and is kept up to date, tick by tick, as long as
        the nest lets time pass: blocks, what is known of contents, signs, and agents of known
        pose, under names of their own. `Nest.layout` says where, and how to go to it. It is what
        the simulator holds on whatever branch it is; nothing that visitors do changes it.

        Args:
            stands: Whether it is to stand. If it does so already, or does not, nothing happens.
            unknown: The block that unknown ones are shown as.

        Raises:
            InputError: It is the real world, people cannot come into this world, or the arguments
                are of other kinds.
            UnknownNameError: There is no such block.
            WorldError: The place on a server holds other blocks.
            BodyError: It could not be built.
        """
        if stands is not True and stands is not False:
            raise InputError(f"embody({stands!r}): give True, or False to end it")
        if not isinstance(unknown, str):
            raise InputError(f"unknown is {unknown!r}; give the name of a block")
        embodying = self._engine.embodying
        if stands:
            embodying.begin(self._path, unknown)
        else:
            embodying.end(self._path)

    @in_turn
    def imagine(self, depth: int = 1, pace: int = 1) -> Imagination:
        """What it holds now as a world of its own, to try courses in; nothing is recorded.

        It is scripted, whatever the real world is: see docs/scripted-world.md.

        Args:
            depth: How deep below it beliefs are followed.
            pace: Ticks of the real world that are as one tick in it.

        Raises:
            InputError: The depth is below 0.
        """
        if depth < 0:
            raise InputError(f"depth is {depth}; give 0 or more")
        info = self._recording.info(self._path)
        for path in paths_below(self._path, depth, self._recording.agents):
            forest = self._recording.history.shared(info.key, path, info.entries)
        speech = -(-forest.context.options.speech_ticks // pace)
        return Imagination.of(forest, self._path, depth, info.head, speech_ticks=speech)


def check_senses(senses: object) -> None:
    """Refuse what is none of `Senses`; InputError says so."""
    if senses not in ("world", "percepts"):
        raise InputError(f"senses is {senses!r}; give 'world' or 'percepts'")


def _timeout(ticks: int) -> int:
    number = whole(ticks)
    if number is None or not 1 <= number <= _LONGEST:
        raise InputError(f"timeout_ticks is {ticks!r}; give a whole number, at most {_LONGEST}")
    return number


def _based_on(key: TimelineKey, infos: Sequence[TimelineInfo]) -> list[TimelineKey]:
    """Return all timelines that rest on one, each after those that rest on it."""
    resting = {key}
    for info in infos:
        if info.base is not None and info.base.timeline in resting:
            resting.add(info.key)
    return [info.key for info in reversed(infos) if info.key in resting and info.key != key]


def _check_branch_name(name: object) -> None:
    if not isinstance(name, str) or not name or not name.isprintable() or set(name) & set("/[]"):
        raise BranchError(
            f"{name!r} is no branch name; use printable text without '/', '[' and ']'"
        )
