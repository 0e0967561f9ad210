"""A story played in a world, and the nest that follows it."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from types import TracebackType
from typing import Self

from beliefnest.belief.entries import Basis
from beliefnest.errors import InputError, ProgramError
from beliefnest.nest.face.nest import Nest
from beliefnest.nest.face.past_simulator import PastSimulator
from beliefnest.nest.face.simulator import Simulator
from beliefnest.nest.past.setting import Setting
from beliefnest.perception.options import Perception
from beliefnest.scenarios.stories.plan import WALL, FloorPlan, feet, lay_out
from beliefnest.scenarios.stories.questions import Question
from beliefnest.scenarios.stories.story import Act, Come, Go, Move, Place, Story, Wait
from beliefnest.world.scripted import ScriptedWorld
from beliefnest.world.values import Position

__all__ = ["Answer", "PlayedStory"]

_TIMEOUT_TICKS = 2400


@dataclass(frozen=True, slots=True)
class Answer:
    """Where a simulator of the nest holds a thing.

    Attributes:
        path: The simulator.
        tick: The tick it was asked at.
        thing: What was asked for.
        place: The container that holds it there; None: none does.
        basis: What that rests on; None: nothing.
    """

    path: str
    tick: int
    thing: str
    place: Place | None
    basis: Basis | None

    @property
    def text(self) -> str | None:
        """Name of the container; None: none holds the thing."""
        return None if self.place is None else self.place.container


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
    ) -> Self:
        """Open a nest in a world and act the story out there.

        Args:
            story: What happens.
            world: `scripted`, where a line takes one tick, or `embedded`, where bots do it.
            seed: Drives every random number.
            asked: What will be asked: beliefs that are followed from the start cost less
                than those made late. Other questions can be asked as well.

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
        nest = Nest.open(story_setting(plan), world=world, seed=seed)
        try:
            for path in sorted({question.path for question in asked}, key=_deepest_first):
                _ = nest[path].state
            ends = _play(story, plan, nest, world)
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

    def answer(self, question: Question) -> Answer:
        """What the nest says.

        Raises:
            InputError: The question names an agent or a thing that is not in the story.
        """
        return self._find(self.asked(question), question.thing)

    def asked(self, question: Question) -> Simulator | PastSimulator:
        """The simulator that a question is about.

        Raises:
            InputError: The question names an agent or a thing that is not in the story.
        """
        check_question(self.story, question)
        if question.at_beginning:
            return self.nest.at(self.plan.snapshot.tick)[question.path]
        return self.nest[question.path]

    def answer_all(self, questions: Iterable[Question]) -> tuple[Answer, ...]:
        """What the nest says to several questions, in their order.

        Raises:
            InputError: A question names an agent or a thing that is not in the story.
        """
        asked = tuple(questions)
        by_depth = sorted(set(asked), key=lambda question: _deepest_first(question.path))
        found = {question: self.answer(question) for question in by_depth}
        return tuple(found[question] for question in asked)

    def line_at(self, tick: int) -> int | None:
        """Index of the line during which a tick passed; None: before the first."""
        if tick <= self.plan.snapshot.tick:
            return None
        return next((n for n, end in enumerate(self.line_ends) if tick <= end), None)

    def _find(self, simulator: Simulator | PastSimulator, thing: str) -> Answer:
        item = self.plan.items[thing]
        containers = simulator.state.containers
        holding = [p for p, held in sorted(containers.items()) if held.items.get(item)]
        if not holding:
            return Answer(simulator.path, simulator.tick, thing, None, None)
        latest = max(holding, key=lambda position: containers[position].basis.observed_at)
        place, basis = self.plan.place_at(latest), containers[latest].basis
        return Answer(simulator.path, simulator.tick, thing, place, basis)


def _deepest_first(path: str) -> tuple[int, str]:
    """A deep node brings those above it along."""
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
    if question.thing not in story.things:
        there = ", ".join(story.things)
        raise InputError(
            f"{question.text!r}: no line says where the {question.thing} is; there are {there}"
        )


def story_setting(plan: FloorPlan) -> Setting:
    """What a nest of a story starts from.

    Whoever is in a room knows where everything in it is; all know the building.
    """
    return Setting(
        name="story",
        snapshot=plan.snapshot,
        perception=Perception(max_visible_distance=None, hearing="sight", containers="transparent"),
        static_blocks=frozenset({WALL}),
    )


def _play(story: Story, plan: FloorPlan, nest: Nest, world: str) -> list[int]:
    """Act every line out; the tick each ended with."""
    ends = []
    for line, act in zip(story.lines, story.acts, strict=True):
        if world == "scripted":
            _tell(nest["/"].scripted, plan, act)
        else:
            _perform(nest, programs_of(act, plan), f"line {line.number}: {line.text!r}")
        ends.append(nest.tick)
    return ends


def _tell(world: ScriptedWorld, plan: FloorPlan, act: Act) -> None:
    """One act, in one tick."""
    with world.tick():
        match act:
            case Come(agents, room):
                for agent in agents:
                    world.place_agent(agent, feet(plan.stands[room, agent]))
            case Go(agents):
                for agent in agents:
                    world.place_agent(agent, feet(plan.cells[agent]))
            case Move(agent, thing, source, target):
                item = {plan.items[thing]: 1}
                world.withdraw(agent, plan.places[source], item)
                world.deposit(agent, plan.places[target], item)
            case Wait():
                pass


def _perform(nest: Nest, programs: Mapping[str, str], where: str) -> None:
    """One act, by bots that do it together."""
    if not programs:
        nest["/"].step(1)
        return
    for agent, result in nest["/"].run_all(programs, _TIMEOUT_TICKS).items():
        if not result.ok:
            raise ProgramError(f"{where}: the program of {agent} failed: {result.error}")


def programs_of(act: Act, plan: FloorPlan) -> dict[str, str]:
    """The programs that bots act something out with, by agent; empty: nothing is done."""
    match act:
        case Come(agents, room):
            return {agent: _walk(plan.stands[room, agent]) for agent in agents}
        case Go(agents):
            return {agent: _walk(plan.cells[agent]) for agent in agents}
        case Move(agent, thing, source, target):
            items = f"{{{plan.items[thing]}: 1}}"
            # Back to the stand, where it is in nobody's way.
            return {
                agent: f"await getItemFromChest(bot, {_vec3(plan.places[source])}, {items})\n"
                f"await depositItemIntoChest(bot, {_vec3(plan.places[target])}, {items})\n"
                + _walk(plan.stands[source.room, agent])
            }
        case Wait():
            return {}


def _walk(block: Position) -> str:
    return f"await goToPosition(bot, {_vec3(block)}, 0)"


def _vec3(position: Position) -> str:
    return f"new Vec3({', '.join(map(str, position))})"
