"""Imagination: a belief as a world of its own, tried out in this process and recorded nowhere.

It is what a branch of a belief would be in the scripted world (semantics, section 6): what the
believer believes is the case in it, and what it believes others to believe follows as it follows
anything. A fork takes well under a millisecond, so that a planner can try hundreds of courses.
Of whatever lies above the believer nothing is in it.
"""

import math
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from beliefnest.belief.columns import Columns
from beliefnest.belief.entries import PerceivedEvent, Source
from beliefnest.belief.forest import Forest
from beliefnest.belief.initial import forked_forest
from beliefnest.belief.node_view import NodeView
from beliefnest.bodies.footpaths import Ground, InReach
from beliefnest.bodies.scripted_hand import REACH, Doing, Hand
from beliefnest.bodies.scripted_skills import CALLS, SKILLS
from beliefnest.errors import BeliefNestError, PathError
from beliefnest.nest.past.embodiable import embodiable, with_chests
from beliefnest.programs.calls import Call
from beliefnest.world.frames import BlockGrid, Frame
from beliefnest.world.paths import BeliefPath, normalised, path_text, paths_below
from beliefnest.world.registry import Registry
from beliefnest.world.scripted import ScriptedWorld
from beliefnest.world.values import Event, Position

__all__ = ["Imagination", "Performer"]

_MOST_GROUNDS = 64


@dataclass
class _News:
    """What has happened since a forest was forked."""

    happened: list[tuple[int, Event]] = field(default_factory=list)

    def events(self, count: int) -> Sequence[tuple[int, Event]]:
        """Return all events since then."""
        return self.happened

    def before(self, path: BeliefPath) -> Sequence[PerceivedEvent]:
        """Nothing: what was heard before has had its effect."""
        return ()


class Performer:
    """An agent at calls, one after the other.

    Attributes:
        calls: What is to be done yet, the call under way first.
        failed: Whether the latest call could not be done.
        doing: The call under way; None: none is.
    """

    def __init__(self, calls: Iterable[Call] = ()) -> None:
        self.calls = list(calls)
        self.failed = False
        self.doing: Doing | None = None

    @property
    def is_done(self) -> bool:
        """True if nothing is left."""
        return not self.calls

    def again(self) -> "Performer":
        """Return one that begins the call under way anew, as in a fork."""
        return Performer(self.calls)


class Imagination:
    """A belief as a world of its own, and what is believed in it.

    Args:
        forest: The nodes, the believer's own first; nobody else's. None: beliefs are not followed.
        root: The believer's path.
        unknown: Blocks that are unknown to it, in which one can be and on which one can stand.
        world: What is the case in it.
        grounds: Where one can stand, by blocks; shared by forks.
        news: Where the forest looks up what has happened.
        speech_ticks: Ticks that it takes somebody in it to say something.

    Attributes:
        root: The believer's path.
        world: What is the case in it.
        happened: All that has happened in it and in what it was forked from: (tick, event).
    """

    def __init__(
        self,
        forest: Forest | None,
        root: BeliefPath,
        unknown: "np.ndarray[tuple[int, int, int], np.dtype[np.bool_]]",
        world: ScriptedWorld,
        grounds: dict[bytes, Ground],
        news: _News,
        speech_ticks: int = 0,
    ) -> None:
        self.root = root
        self.world = world
        self.happened: list[tuple[int, Event]] = []
        self._forest = forest
        self._unknown = unknown
        self._grounds = grounds
        self._ground: tuple[BlockGrid, Ground] | None = None
        self._news = news
        self._speech_ticks = speech_ticks
        self._columns: Columns | None = None
        self._held = 0
        if forest is not None:
            context = forest.context
            self._columns = Columns(context)
            forest.enter(self._columns)
        world.listen(self._take)

    @classmethod
    def of(
        cls,
        source: Forest,
        root: BeliefPath,
        depth: int,
        tick: int,
        grounds: dict[bytes, Ground] | None = None,
        speech_ticks: int | None = None,
    ) -> "Imagination":
        """What a node of a forest would be as a world of its own.

        Args:
            source: Holds the node and those below it.
            root: The node.
            depth: How deep below it beliefs are followed.
            tick: The tick it is.
            grounds: As for the class.
            speech_ticks: As for the class; None: as many as it takes in the world.
        """
        wanted = paths_below(root, depth, source.context.agents)
        news = _News()
        forest = forked_forest(source, news, root, root, tick, further=wanted[1:])
        believed = NodeView(forest, root, tick)
        snapshot, registry = believed.snapshot(), source.context.registry
        blocks = with_chests(registry, snapshot.box, believed.blocks, snapshot.containers)
        possible = embodiable(registry, snapshot, blocks)
        world = ScriptedWorld.from_snapshot(replace(possible, tick=tick))
        known = {} if grounds is None else grounds
        speech = source.context.options.speech_ticks if speech_ticks is None else speech_ticks
        return cls(forest, root, believed.blocks < 0, world, known, news, speech)

    @property
    def tick(self) -> int:
        """The latest tick."""
        return self.world.now

    def is_unknown(self, place: Position) -> bool:
        """Return True if the believer does not know the block at a position of the box."""
        index = self.world.box.index(place)
        return bool(self._unknown[index]) and int(self.world.blocks[index]) == 0

    def may_reach(self, agent: str, place: Position) -> bool:
        """Whether an agent may get to where it can use the block at a position; False: it cannot.

        Nobody whose place is unknown can.
        """
        state = self.world.agents.get(agent)
        if state is None:
            return False
        x, y, z = (math.floor(value) for value in state.position)
        return self._standing().may_lead((x, y, z), InReach(place, REACH))

    def knows(self, path: BeliefPath) -> bool:
        """Return True if beliefs are followed as deep as a path below the root."""
        whole = normalised((*self.root, *path))
        return whole == self.root or (self._forest is not None and whole in self._forest)

    def view(self, path: BeliefPath = ()) -> NodeView:
        """What a node holds; read it before time goes on.

        Args:
            path: Agents below the root.

        Raises:
            PathError: Beliefs are not followed that deep.
        """
        whole = normalised((*self.root, *path))
        return NodeView(self._with(whole), whole)

    def print_of(self, agent: str, depth: int) -> tuple[object, ...] | None:
        """What a plan of an agent in it could depend on; equal ones lead to equal plans.

        Args:
            agent: The agent, whose belief it plans in.
            depth: How deep below that belief it looks.

        Returns:
            None: it depends on more, as on when somebody could last learn of something.
        """
        forest = self._fold()
        root = normalised((*self.root, agent))
        if forest is None or (depth and forest.context.options.testimony == "informed"):
            return None
        nodes = paths_below(root, depth, forest.context.agents)
        return tuple(_print(NodeView(forest, node)) for node in nodes)

    def fork(self) -> "Imagination":
        """Return the same once more, to go another way."""
        forest, news = self._fold(), _News()
        if forest is not None:
            nodes = [path for path in forest.paths if path != self.root]
            forest = forked_forest(
                forest, news, self.root, self.root, self.world.now, further=nodes
            )
        return self._again(forest, news)

    def bare(self) -> "Imagination":
        """A fork in which beliefs are not followed: only what the believer takes for real."""
        return self._again(None, _News())

    def _again(self, forest: Forest | None, news: _News) -> "Imagination":
        made = Imagination(
            forest,
            self.root,
            self._unknown,
            self.world.again(),
            self._grounds,
            news,
            self._speech_ticks,
        )
        made.happened += self.happened
        return made

    def doubting(self, speakers: Collection[str]) -> tuple["Imagination", frozenset[Position]]:
        """Return the same with what some have said of containers taken for lies.

        Returns:
            That, and the containers without the things that were claimed to be in them.
        """
        made = self.fork()
        held = {place: dict(items) for place, items in made.world.containers.items()}
        doubted = frozenset(
            place
            for place, content in made.view().containers.items()
            if content.basis.source is Source.HEARD and content.basis.speaker in speakers
        )
        for place in doubted & held.keys():
            held[place] = {}
        if doubted:
            made.world.set_state(replace(made.world.snapshot(), containers=held))
        return made, doubted

    def below(self, agent: str, depth: int) -> "Imagination":
        """What an agent in it believes, as a world of its own.

        Raises:
            PathError: Beliefs are not followed that deep.
        """
        root = normalised((*self.root, agent))
        return Imagination.of(
            self._with(root), root, depth, self.world.now, self._grounds, self._speech_ticks
        )

    def play(
        self,
        performers: Mapping[str, Performer],
        ticks: int,
        stop: Callable[[], bool] = lambda: False,
    ) -> int:
        """Let agents act together, tick by tick, until `stop` says so; how many ticks passed.

        Performers whose agents are not in it, or whose call cannot be done, go on with the next.
        """
        passed = 0
        for name, performer in performers.items():
            self._begin(name, performer)
        while passed < ticks and not stop():
            passed += 1
            with self.world.tick():
                ended = [name for name, each in performers.items() if _advance(each)]
            for name in ended:
                performer = performers[name]
                performer.doing = None
                del performer.calls[0]
                self._begin(name, performer)
        return passed

    def _begin(self, name: str, performer: Performer) -> None:
        """Let an agent begin its next call that can be begun."""
        while performer.doing is None and performer.calls:
            if name not in self.world.agents:
                performer.calls.clear()
                performer.failed = True
                return
            call = performer.calls[0]
            hand = Hand(
                name,
                self.world,
                known=self._standing,
                others=lambda: self.world.agents,
                signs=lambda: self.world.signs,
                ground=self._standing,
                speech_ticks=self._speech_ticks,
            )
            try:
                doing = _doing(hand, call)
                next(doing)
                performer.doing = doing
                performer.failed = False
            except StopIteration:
                del performer.calls[0]
            except BeliefNestError:
                performer.failed = True
                del performer.calls[0]

    def _standing(self) -> Ground:
        blocks = self.world.blocks
        if self._ground is None or self._ground[0] is not blocks:
            unknown = self._unknown & (blocks == 0)
            grid = np.where(unknown, -1, blocks)
            key = grid.tobytes()
            if key not in self._grounds:
                if len(self._grounds) >= _MOST_GROUNDS:
                    self._grounds.clear()
                self._grounds[key] = Ground(Registry.load(), self.world.box, grid)
            self._ground = (blocks, self._grounds[key])
        return self._ground[1]

    def _take(self, frame: Frame) -> None:
        if frame.is_empty:
            return
        events = [(frame.tick, event) for event in frame.events]
        self.happened += events
        if self._columns is not None:
            self._columns.add(frame)
            self._news.happened += events

    def _with(self, path: BeliefPath) -> Forest:
        """Return the forest as of now, which has to hold a node."""
        forest = self._fold()
        if forest is None or path not in forest:
            raise PathError(f"{path_text(path)} is deeper than this imagination goes")
        return forest

    def _fold(self) -> Forest | None:
        forest, columns = self._forest, self._columns
        if forest is not None and columns is not None and forest.position < columns.end:
            forest.context.track(columns.held[self._held :])
            self._held = len(columns.held)
            forest.advance(columns.end)
        return forest


def _print(view: NodeView) -> tuple[object, ...]:
    contents = [
        (place, tuple(sorted(each.items.items())), each.complete)
        for place, each in view.containers.items()
    ]
    agents = [
        (name, each.position, each.yaw, each.pitch, each.current, *sorted(each.inventory.items()))
        for name, each in view.agents.items()
    ]
    return (view.numbers.tobytes(), tuple(contents), tuple(agents))


def _advance(performer: Performer) -> bool:
    """Return a tick of the call under way; whether it has ended."""
    if performer.doing is None:
        return False
    try:
        next(performer.doing)
    except StopIteration:
        return True
    except BeliefNestError:
        performer.failed = True
        return True
    return False


def _doing(hand: Hand, call: Call) -> Doing:
    if call.skill == "openContainer":
        yield from SKILLS["goToPosition"](hand, call.args[0], 2)
    yield from {**SKILLS, **CALLS}[call.skill](hand, *call.args)
