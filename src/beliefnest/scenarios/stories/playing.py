"""A story played in a world, and the nest that follows it."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from types import TracebackType
from typing import TYPE_CHECKING, Self

from beliefnest.belief.entries import Basis
from beliefnest.errors import InputError, ProgramError
from beliefnest.nest.face.nest import Nest
from beliefnest.nest.face.shown import PastSimulator
from beliefnest.nest.face.simulator import Simulator
from beliefnest.nest.past.setting import Setting
from beliefnest.perception.options import ContainerMode, Perception, Testimony
from beliefnest.scenarios.stories.acting import programs_of, tell
from beliefnest.scenarios.stories.plan import WALL, FloorPlan, lay_out
from beliefnest.scenarios.stories.questions import Question
from beliefnest.scenarios.stories.reading import StoryReader, in_words_alone
from beliefnest.scenarios.stories.story import (
    Come,
    Go,
    Place,
    Story,
)

if TYPE_CHECKING:  # Models take long to import, and few stories are read by one.
    from beliefnest.llm.hearsay import ClaimsFromModel

__all__ = ["Knowing", "PlayedStory", "StoryAnswer"]

_TIMEOUT_TICKS = 2400
_TICKS_PER_BLOCK = 8
"""More than walking takes."""


@dataclass(frozen=True, slots=True)
class StoryAnswer:
    """Where a simulator of the nest holds a thing.

    Attributes:
        path: The simulator.
        tick: The tick it was asked at.
        thing: What was asked for.
        place: The container that holds it there; None: none does.
        basis: What that rests on; None: nothing.
        is_open: For a door, whether it is open; None: that is unknown, or it is no door.
        says: For a sign, what is written on it; None: that is unknown, or it is no sign.
    """

    path: str
    tick: int
    thing: str
    place: Place | None
    basis: Basis | None
    is_open: bool | None = None
    says: str | None = None

    @property
    def text(self) -> str | None:
        """Name of the container, `open` or `shut`, or what a sign says.

        None: no container holds it, or unknown.
        """
        if self.says is not None:
            return self.says
        if self.is_open is not None:
            return "open" if self.is_open else "shut"
        return None if self.place is None else self.place.container


@dataclass(frozen=True, slots=True)
class Knowing:
    """How the agents of a story get to know what they do not see happen.

    Attributes:
        containers: `transparent`: who is in a room knows where everything in it is; `opaque`:
            who opened a container, or saw what was put there, knows what is in it.
        testimony: How hearers take what is said (semantics, section 8).
        sincere: Whether speakers are taken to believe what is not believed of them.
        claims_from: Who reads claims out of what is told; None: they stand beside the words.
    """

    containers: ContainerMode = "transparent"
    testimony: Testimony = "informed"
    sincere: bool = False
    claims_from: "ClaimsFromModel | None" = None


_KNOWING = Knowing()


class PlayedStory:
    """A story that was played, and its nest; use it in a `with` block, or close it.

    Attributes:
        story: The story.
        plan: Where everything is.
        nest: Open until this is closed; at the story's end.
        line_ends: The tick each line ended with, in order of `story.lines`.
    """

    def __init__(self, story: Story, plan: FloorPlan, nest: Nest, line_ends: Sequence[int]) -> None:
        self.story = story
        self.plan = plan
        self.nest = nest
        self.line_ends = tuple(line_ends)

    @classmethod
    def play(
        cls,
        story: Story,
        world: str = "scripted",
        seed: int = 0,
        asked: Iterable[Question] = (),
        knowing: Knowing = _KNOWING,
    ) -> Self:
        """Open a nest in a world and act the story out there.

        Args:
            story: What happens.
            world: `scripted`, where a line takes one tick, or `embedded`, where bots do it.
            seed: Drives every random number.
            asked: What will be asked: beliefs that are followed from the start cost less
                than those made late. Other questions can be asked as well.
            knowing: How agents get to know what they do not see happen.

        Raises:
            BodyError: The world could not be started, or died.
            InputError: A question names an agent or a thing that is not in the story.
            ProgramError: A bot could not do what a line says.
            UnknownNameError: There is no such world.
        """
        plan = lay_out(story)
        asked = tuple(asked)
        for question in asked:
            check_question(story, question)
        grace = _grace(story, plan, world)
        reader = knowing.claims_from
        setting = story_setting(plan, grace, knowing)
        claims_from = None if reader is None else StoryReader(reader, plan)
        nest = Nest.open(setting, world=world, seed=seed, claims_from=claims_from)
        try:
            for path in sorted({question.path for question in asked}, key=_deepest_first):
                _ = nest[path].state
            told = story if reader is None else in_words_alone(story)
            ends = _play(told, plan, nest, world, grace)
        except BaseException:
            nest.close()
            raise
        return cls(story, plan, nest, ends)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.nest.close()

    def answer(self, question: Question) -> StoryAnswer:
        """What the nest says.

        Raises:
            InputError: The question names an agent or a thing that is not in the story.
        """
        if question.door is not None:
            return self._door(self.asked(question), question.door)
        if question.sign is not None:
            return self._sign(self.asked(question), question.sign)
        return self._find(self.asked(question), question.thing)

    def asked(self, question: Question) -> Simulator | PastSimulator:
        """Return the simulator that a question is about.

        Raises:
            InputError: The question names an agent or a thing that is not in the story.
        """
        check_question(self.story, question)
        if question.at_beginning:
            return self.nest.at(self.plan.snapshot.tick)[question.path]
        return self.nest[question.path]

    def answer_all(self, questions: Iterable[Question]) -> tuple[StoryAnswer, ...]:
        """What the nest says to several questions, in their order.

        Raises:
            InputError: A question names an agent or a thing that is not in the story.
        """
        asked = tuple(questions)
        by_depth = sorted(set(asked), key=lambda question: _deepest_first(question.path))
        found = {question: self.answer(question) for question in by_depth}
        return tuple(found[question] for question in asked)

    def line_at(self, tick: int) -> int | None:
        """Return the index of the line during which a tick passed; None: before the first."""
        if tick <= self.plan.snapshot.tick:
            return None
        return next((n for n, end in enumerate(self.line_ends) if tick <= end), None)

    def _door(self, simulator: Simulator | PastSimulator, room: str) -> StoryAnswer:
        block = simulator.state.blocks[self.plan.doors[room]]
        is_open = None if block is None else "open=true" in block
        return StoryAnswer(simulator.path, simulator.tick, "", None, None, is_open)

    def _sign(self, simulator: Simulator | PastSimulator, room: str) -> StoryAnswer:
        says = simulator.state.signs.get(self.plan.signs[room])
        return StoryAnswer(simulator.path, simulator.tick, "", None, None, says=says)

    def _find(self, simulator: Simulator | PastSimulator, thing: str) -> StoryAnswer:
        item = self.plan.items[thing]
        containers = simulator.state.containers
        holding = [p for p, held in sorted(containers.items()) if held.items.get(item)]
        if not holding:
            return StoryAnswer(simulator.path, simulator.tick, thing, None, None)
        latest = max(holding, key=lambda position: containers[position].basis.observed_at)
        place, basis = self.plan.place_at(latest), containers[latest].basis
        return StoryAnswer(simulator.path, simulator.tick, thing, place, basis)


def _deepest_first(path: str) -> tuple[int, str]:
    """Return a deep node brings those above it along."""
    return (-path.count("/"), path)


def check_question(story: Story, question: Question) -> None:
    """Refuse a question about what is not in a story.

    Raises:
        InputError: It names an agent or a thing that is not there.
    """
    for agent in question.believers:
        if agent not in story.agents:
            there = ", ".join(story.agents)
            raise InputError(f"{question.text!r}: {agent} is not in the story; there are {there}")
    if question.door is not None:
        if question.door not in story.doors:
            there = ", ".join(story.doors) or "none"
            raise InputError(
                f"{question.text!r}: nobody opens or shuts a door of the {question.door}; there "
                f"are doors of: {there}"
            )
        return
    if question.sign is not None:
        if question.sign not in story.signs:
            there = ", ".join(story.signs) or "none"
            raise InputError(
                f"{question.text!r}: nobody writes on a sign of the {question.sign}; there are "
                f"signs of: {there}"
            )
        return
    if question.thing not in story.things:
        there = ", ".join(story.things)
        raise InputError(
            f"{question.text!r}: no line says where the {question.thing} is; there are {there}"
        )


def _grace(story: Story, plan: FloorPlan, world: str) -> int:
    """Return ticks that somebody may be out of sight for no other reason than that one walks.

    Who leaves a room does not see those in the hall before it gets there; in the scripted
    world that takes no time. In the embedded one the next line waits for longer than that, so
    that only who stayed in the room for another line may have learnt something.
    """
    if world == "scripted" or not story.tells:
        return 0
    length, _, depth = plan.snapshot.box.shape
    return _TICKS_PER_BLOCK * (length + depth)


def story_setting(plan: FloorPlan, grace: int = 0, knowing: Knowing = _KNOWING) -> Setting:
    """What a nest of a story starts from; all know the building.

    Args:
        plan: Where everything is.
        grace: Ticks out of sight in which nobody learns anything.
        knowing: How agents get to know what they do not see happen.
    """
    return Setting(
        name="story",
        snapshot=plan.snapshot,
        perception=Perception(
            max_visible_distance=None,
            hearing="sight",
            containers=knowing.containers,
            testimony=knowing.testimony,
            grace=grace,
            sincere=knowing.sincere,
        ),
        static_blocks=frozenset({WALL}),
    )


def _play(story: Story, plan: FloorPlan, nest: Nest, world: str, grace: int) -> list[int]:
    """Act every line out; the tick each ended with."""
    ends = []
    for line, act in zip(story.lines, story.acts, strict=True):
        if world == "scripted":
            tell(nest["/"].scripted, plan, act)
        else:
            programs = programs_of(act, plan)
            # One after the other where each shuts the door behind itself.
            shuts = isinstance(act, Come | Go) and act.shuts
            steps = [{a: p} for a, p in programs.items()] if shuts else [programs]
            for together in steps:
                _perform(nest, together, f"{line.place}: {line.text!r}")
            if grace and isinstance(act, Go):
                nest["/"].step(grace + 1)
        ends.append(nest.tick)
    return ends


def _perform(nest: Nest, programs: Mapping[str, str], where: str) -> None:
    """One act, by bots that do it together."""
    if not programs:
        nest["/"].step(1)
        return
    for agent, result in nest["/"].run_all(programs, _TIMEOUT_TICKS).items():
        if not result.ok:
            raise ProgramError(f"{where}: the program of {agent} failed: {result.error}")
