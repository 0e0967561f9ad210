"""Playing of stories in a world, with a nest that tracks the beliefs."""

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Self

import msgspec
from msgspec.structs import replace

from beliefnest.belief.grounds import Basis
from beliefnest.errors import InputError, ProgramError
from beliefnest.nest.face.nest import Nest
from beliefnest.nest.face.shown import PastSimulator
from beliefnest.nest.face.simulator import Simulator
from beliefnest.nest.past.setting import Setting
from beliefnest.perception.options import ContainerMode, Perception, Testimony
from beliefnest.suites.stories.acting import programs_of, tell
from beliefnest.suites.stories.floor_plan import WALL, FloorPlan, lay_out
from beliefnest.suites.stories.questions import Question
from beliefnest.suites.stories.story import Come, Go, Place, Story, Tell
from beliefnest.world.claims import Claim
from beliefnest.world.nameable import Nameable
from beliefnest.world.texts import quoted

if TYPE_CHECKING:  # Importing models takes long, and few stories need one.
    from beliefnest.llm.claim_reader import ClaimsFromModel
    from beliefnest.llm.messages import Model

_TIMEOUT_TICKS = 2400
_TICKS_PER_BLOCK = 8
"""Ticks allowed per block of a walk; more than walking takes."""


class StoryAnswer(msgspec.Struct, frozen=True):
    """Answer of a simulator to a question about a thing, a door or a sign.

    Attributes:
        path: Path of the simulator.
        tick: Tick of the answer.
        thing: The thing in question.
        place: Container that holds the thing there; None: no known container.
        basis: Basis of the belief; None: none.
        is_open: True if the door is open; None: unknown, or the question is about no door.
        says: Text of the sign; None: unknown, or the question is about no sign.
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
        """Return the name of the container, `open` or `shut`, or the text of the sign.

        None: the answer is unknown, or no container holds the thing.
        """
        if self.says is not None:
            return self.says
        if self.is_open is not None:
            return "open" if self.is_open else "shut"
        return None if self.place is None else self.place.container


class Knowing(msgspec.Struct, frozen=True):
    """Rules by which agents of a story learn of events that they do not see.

    Attributes:
        containers: `transparent`: agents in a room know the contents of its containers.
            `opaque`: agents know contents after they opened a container or saw a transfer.
        testimony: Effect of claims on hearers (semantics, section 8).
        sincere: True if hearers assume that speakers believe what they say.
        claims_from: Model that extracts claims from utterances; None: use the claims that the
            story states beside the words.
    """

    containers: ContainerMode = "transparent"
    testimony: Testimony = "informed"
    sincere: bool = False
    claims_from: "ClaimsFromModel | None" = None


_KNOWING = Knowing()


class StoryReader(msgspec.Struct, frozen=True):
    """Extractor of claims that gives the model the story's names of things and containers.

    Attributes:
        reader: Extractor that asks the model.
        plan: Floor plan with the items and places of the story.
    """

    reader: "ClaimsFromModel"
    plan: FloorPlan

    @property
    def name(self) -> str:
        """Return the name of the model."""
        return self.reader.name

    def through(self, wrap: "Callable[[Model], Model]") -> "StoryReader":
        """Return the same extractor with its model wrapped by a function."""
        return replace(self, reader=self.reader.through(wrap))

    def __call__(self, text: str, speaker: str, nameable: Nameable) -> Iterable[Claim]:
        """Return the claims in a text; raise errors as the inner extractor does."""
        called = {item: thing for thing, item in self.plan.items.items()}
        at = self.plan.place_at
        containers = {p: f"{at(p).container} of the {at(p).room}" for p in nameable.containers}
        return self.reader(text, speaker, replace(nameable, called=called, containers=containers))


class PlayedStory:
    """Played story and its nest; use it in a `with` block, or close it.

    Attributes:
        story: The story.
        plan: Floor plan of the story.
        nest: Nest at the end of the story, open until this object is closed.
        line_ends: Last tick of each line, in order of `story.lines`.
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
        """Open a nest in a world and play the story there.

        Args:
            story: The story.
            world: `scripted`, where a line takes one tick, or `embedded`, where bots act.
            seed: Seed of every random number.
            asked: Questions that will be asked. Beliefs that are tracked from the start cost
                less than those computed late. Other questions are possible as well.
            knowing: Rules by which agents learn of events that they do not see.

        Raises:
            BodyError: The world could not be started, or died.
            InputError: A question names an agent or thing that is not in the story.
            ProgramError: A bot could not do what a line says.
            UnknownNameError: The world does not exist.
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
            as_read = story if reader is None else _in_words_alone(story)
            ends = _play(as_read, plan, nest, world, grace)
        except BaseException:
            nest.close()
            raise
        return cls(story, plan, nest, ends)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.nest.close()

    def answer(self, question: Question) -> StoryAnswer:
        """Answer a question from the nest.

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
        """Answer several questions from the nest, in their order.

        Raises:
            InputError: A question names an agent or a thing that is not in the story.
        """
        asked = tuple(questions)
        by_depth = sorted(set(asked), key=lambda question: _deepest_first(question.path))
        answers = {question: self.answer(question) for question in by_depth}
        return tuple(answers[question] for question in asked)

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
        holding = [p for p, content in sorted(containers.items()) if content.items.get(item)]
        if not holding:
            return StoryAnswer(simulator.path, simulator.tick, thing, None, None)
        latest = max(holding, key=lambda position: containers[position].basis.observed_at)
        place, basis = self.plan.place_at(latest), containers[latest].basis
        return StoryAnswer(simulator.path, simulator.tick, thing, place, basis)


def _deepest_first(path: str) -> tuple[int, str]:
    """Return a sort key that puts deep paths first: they create the nodes above them."""
    return (-path.count("/"), path)


def check_question(story: Story, question: Question) -> None:
    """Check that a question is about agents and things of a story.

    Raises:
        InputError: The question names an agent or thing that is not in the story.
    """
    door, sign, thing = question.door, question.sign, question.thing
    checks: list[tuple[str, Collection[str], str]] = [
        (each, story.agents, f"{each} is not in the story; there are")
        for each in question.believers
    ]
    if door is not None:
        fault = f"nobody opens or shuts a door of the {door}; there are doors of:"
        checks.append((door, story.doors, fault))
    elif sign is not None:
        fault = f"nobody writes on a sign of the {sign}; there are signs of:"
        checks.append((sign, story.signs, fault))
    else:
        checks.append((thing, story.things, f"no line says where the {thing} is; there are"))
    for name, names, fault in checks:
        if name not in names:
            raise InputError(f"{quoted(question.text)}: {fault} {', '.join(names) or 'none'}")


def _grace(story: Story, plan: FloorPlan, world: str) -> int:
    """Return the ticks for which agents may be out of sight only because they walk.

    An agent that leaves a room does not see the agents in the hall until it gets there. In the
    scripted world that takes no time. In the embedded world the next line waits for longer than
    that. So only agents that stayed in the room for another line may have learnt something.
    """
    if world == "scripted" or not story.tells:
        return 0
    length, _, depth = plan.snapshot.box.shape
    return _TICKS_PER_BLOCK * (length + depth)


def story_setting(plan: FloorPlan, grace: int = 0, knowing: Knowing = _KNOWING) -> Setting:
    """Return the setting of a story's nest, in which all agents know the building.

    Args:
        plan: Floor plan of the story.
        grace: Ticks out of sight in which an agent learns nothing.
        knowing: Rules by which agents learn of events that they do not see.
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
    """Play every line, and return the last tick of each."""
    ends = []
    for line, act in zip(story.lines, story.acts, strict=True):
        if world == "scripted":
            tell(nest["/"].scripted, plan, act)
        else:
            programs = programs_of(act, plan)
            # Agents go one after the other if each shuts the door behind itself.
            shuts = isinstance(act, Come | Go) and act.shuts
            steps = [{a: p} for a, p in programs.items()] if shuts else [programs]
            for together in steps:
                _perform(nest, together, f"{line.place}: {quoted(line.text)}")
            if grace and isinstance(act, Go):
                nest["/"].step(grace + 1)
        ends.append(nest.tick)
    return ends


def _perform(nest: Nest, programs: Mapping[str, str], where: str) -> None:
    """Let bots perform one act together."""
    if not programs:
        nest["/"].step(1)
        return
    for agent, result in nest["/"].run_all(programs, _TIMEOUT_TICKS).items():
        if not result.ok:
            raise ProgramError(f"{where}: the program of {agent} failed: {result.error}")


def _in_words_alone(story: Story) -> Story:
    """Return the story without the claims beside utterances, so that only the words remain."""
    acts = (replace(act, is_claimed=False) if isinstance(act, Tell) else act for act in story.acts)
    return replace(story, acts=tuple(acts))
