"""Imagination: a belief as a world of its own, which runs in this process and is not recorded.

It is what a branch of the belief would be in the scripted world (semantics, section 6). The
believer's beliefs are the facts of this world, and the believed beliefs of others follow it as any
beliefs follow a timeline. A fork takes well under a millisecond, so that a planner can try hundreds
of courses. An imagination contains nothing from the simulators above the believer.
"""

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import TYPE_CHECKING

import numpy as np
from msgspec.structs import replace

from beliefnest.belief.chunk_pool import lines_of_sight
from beliefnest.belief.columns import Columns
from beliefnest.belief.forest import Forest
from beliefnest.belief.grounds import PerceivedEvent, Source
from beliefnest.belief.initial import forked_forest
from beliefnest.belief.node_memory import paths_with_room
from beliefnest.belief.node_view import NodeView
from beliefnest.errors import BeliefNestError, InputError, PathError, WorldError
from beliefnest.nest.past.embodiable import embodiable, with_chests
from beliefnest.perception.percept import Perceptibles, gaze_from, percept
from beliefnest.perception.sight import Sight, SightLines
from beliefnest.skills.calls import Call
from beliefnest.world.frames import Frame
from beliefnest.world.paths import BeliefPath, normalised, path_text, paths_below
from beliefnest.world.registry import AIR, Registry
from beliefnest.world.terrain import BlockStates, Terrain
from beliefnest.world.values import AgentState, Event, Point, Position
from beliefnest.worlds.protocol import ProgramResult, RunRules
from beliefnest.worlds.scripted.footpaths import Ground, InReach
from beliefnest.worlds.scripted.hand import REACH, Doing, Hand
from beliefnest.worlds.scripted.powered import switches_in
from beliefnest.worlds.scripted.skills import perform
from beliefnest.worlds.scripted.world import ScriptedWorld

if TYPE_CHECKING:  # Programs take long to import, and few imaginations run one.
    from beliefnest.worlds.scripted.desk import Desk
    from beliefnest.worlds.scripted.ground_cache import Grounds

_MOST_GROUNDS = 64


@dataclass
class _News:
    """Events since a forest was forked."""

    happened: list[tuple[int, Event]] = field(default_factory=list)

    def events(self, count: int) -> Sequence[tuple[int, Event]]:
        """Return all events since the fork."""
        return self.happened

    def before(self, path: BeliefPath) -> Sequence[PerceivedEvent]:
        """Return no events: earlier events have had their effect on the forked beliefs."""
        return ()


class Performer:
    """Agent that makes calls of skills one after the other.

    Attributes:
        calls: The remaining calls, the present one first.
        failed: True if the latest call failed.
        doing: Generator of the present call, one step a tick; None: no call is under way.
        skips: Ticks that the present call asks to skip before its next step.
    """

    def __init__(self, calls: Iterable[Call] = ()) -> None:
        self.calls = list(calls)
        self.failed = False
        self.doing: Doing | None = None
        self.skips = 0

    @property
    def is_done(self) -> bool:
        """True if no call is left."""
        return not self.calls

    def again(self) -> "Performer":
        """Return a performer for a fork, which begins the present call from its start."""
        return Performer(self.calls)


class Imagination:
    """Belief as a world of its own, with the beliefs in it.

    Args:
        forest: The nodes, the believer's own first, used by this imagination alone. None: beliefs
            in this world are not followed.
        root: Path of the believer.
        believed: Block states that the believer believes at the start, -1 unknown. Agents can be in
            unknown blocks and stand on them.
        world: The world with the believed state.
        grounds: Cache of walkable ground by blocks, shared by forks.
        news: Events for the forest.
        sight: Options of sight.
        start: Agents that the believer does not see at the start, and all agents' feet then.
        speech_ticks: Ticks that an agent needs to say something.

    Attributes:
        root: Path of the believer.
        world: The world with the believed state.
        happened: All events in this imagination and in those from which it was forked: (tick,
            event).
    """

    def __init__(
        self,
        forest: Forest | None,
        root: BeliefPath,
        believed: Terrain,
        world: ScriptedWorld,
        grounds: dict[bytes, Ground],
        news: _News,
        sight: Sight,
        start: tuple[frozenset[str], Mapping[str, Point]],
        speech_ticks: int = 0,
    ) -> None:
        self.root = root
        self.world = world
        self.happened: list[tuple[int, Event]] = []
        self._forest = forest
        self._believed = believed
        self._grounds = grounds
        self._ground: tuple[Terrain, Ground] | None = None
        self._geometry: tuple[Terrain, SightLines] | None = None
        self._switches: tuple[Terrain, dict[Position, dict[Position, int] | None]] | None = None
        self._news = news
        self._sight = sight
        self._unseen, self._feet = start
        self._speech_ticks = speech_ticks
        self._columns: Columns | None = None
        self._held = 0
        self._stride = 1
        self._shared: list[tuple[Grounds, Desk]] = []
        if forest is not None:
            self._columns = forest.columns
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
        """Return a node of a forest as a world of its own.

        Args:
            source: Forest with the node and the nodes below it.
            root: Path of the node.
            depth: Number of levels below the node at which beliefs are followed.
            tick: Tick at which the imagination begins.
            grounds: As for the class.
            speech_ticks: As for the class; None: the number in the options of perception.
        """
        wanted = paths_with_room(source.context, root, depth)
        news = _News()
        forest = forked_forest(source, news, root, root, tick, further=wanted[1:])
        believed = NodeView(forest, root, tick)
        snapshot, registry = believed.snapshot(), source.context.registry
        blocks = with_chests(registry, snapshot.box, believed.terrain, snapshot.containers)
        possible = embodiable(registry, snapshot, blocks)
        world = ScriptedWorld.from_snapshot(replace(possible, tick=tick))
        kept = {} if grounds is None else grounds
        speech = source.context.options.speech_ticks if speech_ticks is None else speech_ticks
        sight = source.context.sight
        unseen = frozenset(name for name, each in believed.agents.items() if not each.current)
        start = (unseen, {name: state.position for name, state in world.agents.items()})
        return cls(forest, root, believed.terrain, world, kept, news, sight, start, speech)

    @property
    def tick(self) -> int:
        """The latest tick."""
        return self.world.now

    def is_unknown(self, place: Position) -> bool:
        """Return True if the believer does not know the block at a position of the box."""
        index = self.world.box.index(place)
        return self._believed[index] < 0 and self.world.terrain[index] == 0

    def may_reach(self, agent: str, place: Position) -> bool:
        """Return False if an agent certainly cannot get to where its hand reaches a block.

        True means that it may: ways back are not tested. It is False for an agent of unknown
        position. Doors that open by hand are no obstacle.
        """
        state = self.world.state_of(agent)
        if state is None:
            return False
        ground = self._standing().with_doors_opened
        return ground.may_lead(ground.cell_of(state.position), _in_reach(place))

    @property
    def switches(self) -> Sequence[Position]:
        """Positions of levers, buttons and pressure plates, in order."""
        return tuple(self._moved())

    def moved_by(self, switch: Position) -> Mapping[Position, int]:
        """Return the new states of blocks that the use of a switch would move."""
        moved = self._moved()
        of_switch = moved[switch]
        if of_switch is None:
            of_switch = moved[switch] = self.world.moved_by(switch)
        return of_switch

    def _moved(self) -> dict[Position, dict[Position, int] | None]:
        """Return what each switch would move, if computed; forks share it."""
        blocks = self.world.terrain
        if self._switches is None or self._switches[0] is not blocks:
            self._switches = (blocks, dict.fromkeys(switches_in(self.world.box, blocks)))
        return self._switches[1]

    def seen_by(self, agent: str) -> Mapping[str, AgentState]:
        """Return the other agents that an agent of this world sees at the latest tick."""
        agents = self.world.agents
        others = {name: state for name, state in agents.items() if name != agent}
        if agent not in agents or not others:
            return {}
        if self.root[-1:] == (agent,):
            others = {name: state for name, state in others.items() if not self._is_lost(name)}
        me, feet = agents[agent], {name: state.position for name, state in others.items()}
        gaze = gaze_from(me.position, me.yaw, me.pitch)
        seen = percept(self._looking(), gaze, Perceptibles(agents=feet)).agents
        return {name: others[name] for name in seen}

    def knows(self, path: BeliefPath) -> bool:
        """Return True if the beliefs of a path below the root are followed."""
        whole = normalised((*self.root, *path))
        return whole == self.root or (self._forest is not None and whole in self._forest)

    def view(self, path: BeliefPath = ()) -> NodeView:
        """Return the view of a node. Read it before time passes.

        Args:
            path: Agents below the root.

        Raises:
            PathError: The beliefs of the path are not followed.
        """
        whole = normalised((*self.root, *path))
        return NodeView(self._with(whole), whole)

    def print_of(self, agent: str, depth: int) -> tuple[object, ...] | None:
        """Return a key of everything that a plan of an agent depends on, for caches of plans.

        Equal keys lead to equal plans.

        Args:
            agent: Name of the agent, which plans in its own belief.
            depth: Number of levels below that belief that the plan considers.

        Returns:
            The key. None if the plan may depend on more, for example on the ticks at which agents
            last watched a place (`testimony: informed`).
        """
        forest = self._fold()
        root = normalised((*self.root, agent))
        if forest is None or (depth and forest.context.options.testimony == "informed"):
            return None
        nodes = paths_below(root, depth, forest.context.agents)
        return tuple(_print(NodeView(forest, node)) for node in nodes)

    def fork(self) -> "Imagination":
        """Return an independent copy, which can take another course."""
        forest, news = self._fold(), _News()
        if forest is not None:
            nodes = [path for path in forest.paths if path != self.root]
            forest = forked_forest(
                forest, news, self.root, self.root, self.world.now, further=nodes
            )
        return self._again(forest, news)

    def bare(self) -> "Imagination":
        """Return a copy in which no beliefs are followed, only the world of the believer."""
        return self._again(None, _News())

    def _again(self, forest: Forest | None, news: _News) -> "Imagination":
        made = Imagination(
            forest,
            self.root,
            self._believed,
            self.world.again(),
            self._grounds,
            news,
            self._sight,
            (self._unseen, self._feet),
            self._speech_ticks,
        )
        made.happened += self.happened
        # They hold as long as the blocks are the same.
        made._ground, made._geometry = self._ground, self._geometry
        made._switches = self._switches
        made._shared = self._shared
        return made

    def doubting(self, speakers: Collection[str]) -> tuple["Imagination", frozenset[Position]]:
        """Return a copy in which claims of some speakers about containers count as lies.

        Returns:
            The copy, and the positions of the containers that are empty in it for that reason.
        """
        made = self.fork()
        contents = {place: dict(items) for place, items in made.world.containers.items()}
        doubted = frozenset(
            place
            for place, content in made.view().containers.items()
            if content.basis.source is Source.HEARD and content.basis.speaker in speakers
        )
        for place in doubted & contents.keys():
            contents[place] = {}
        if doubted:
            made.world.set_state(replace(made.world.snapshot(), containers=contents))
        return made, doubted

    def below(self, agent: str, depth: int) -> "Imagination":
        """Return the belief of an agent in this world, as a world of its own.

        Raises:
            PathError: The beliefs of the agent are not followed.
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
        """Let agents act together, tick by tick.

        A performer whose call fails goes on with its next call. One whose agent is not in this
        world drops all its calls.

        Args:
            performers: Performers by agent.
            ticks: Greatest number of ticks to pass.
            stop: Function called before each tick; True ends the play.

        Returns:
            Number of ticks that passed.
        """
        passed = 0
        for name, performer in performers.items():
            self._begin(name, performer)
        # A single agent whom nobody watches can take many steps at once.
        is_alone = self._forest is None and len(performers) == 1
        while passed < ticks and not stop():
            self._stride = ticks - passed if is_alone and self.world.is_still else 1
            passed += 1
            with self.world.tick():
                ended = [name for name, each in performers.items() if _advance(each)]
            if is_alone and (skipped := _skipped(performers)):
                self.world.skip(skipped)
                passed += skipped
            for name in ended:
                performer = performers[name]
                performer.doing = None
                del performer.calls[0]
                self._begin(name, performer)
        return passed

    def run(
        self, agent: str, program: str, timeout_ticks: int = 1200, *, seed: int = 0
    ) -> ProgramResult:
        """Run a program of an agent in this world until it ends, as the scripted world does.

        The program changes this world: `fork` it first to try another one from here.

        Args:
            agent: Name of the agent.
            program: JavaScript, as for `Simulator.run`.
            timeout_ticks: Ticks after which the program is stopped.
            seed: Seed of its random numbers.

        Raises:
            WorldError: The believer does not know where the agent is.
            InputError: `timeout_ticks` is no whole number, at least 1.
        """
        from beliefnest.worlds.scripted.programs import run_programs

        if isinstance(timeout_ticks, bool) or not isinstance(timeout_ticks, int):
            raise InputError(f"timeout_ticks is {timeout_ticks!r}; give a whole number of ticks")
        if timeout_ticks < 1:
            raise InputError(f"timeout_ticks is {timeout_ticks}; give at least 1")
        if agent not in self.world.agents:
            there = ", ".join(sorted(self.world.agents)) or "nobody"
            raise WorldError(f"{agent} is not there: its pose is not known; there are {there}")
        rules = RunRules(self._speech_ticks)
        results = run_programs(
            self.world,
            {agent: program},
            timeout_ticks,
            {},
            rules,
            f"{seed} imagined",
            *self._tools(),
        )
        return results[agent]

    def _tools(self) -> "tuple[Grounds, Desk]":
        """Return the caches of running programs, which forks share; a new desk takes long."""
        from beliefnest.worlds.scripted.desk import Desk
        from beliefnest.worlds.scripted.ground_cache import Grounds

        if not self._shared:
            self._shared.append((Grounds(), Desk()))
        return self._shared[0]

    def _begin(self, name: str, performer: Performer) -> None:
        """Let an agent begin its next call. Calls that fail at once are dropped."""
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
                others=lambda: self.seen_by(name),
                signs=lambda: self.world.signs,
                ground=self._standing,
                speech_ticks=self._speech_ticks,
                stride=lambda: self._stride,
            )
            try:
                doing = perform(hand, call)
                next(doing)
                performer.doing = doing
                performer.failed = False
            except StopIteration:
                del performer.calls[0]
            except BeliefNestError:
                performer.failed = True
                del performer.calls[0]

    def _standing(self) -> Ground:
        blocks = self.world.terrain
        if self._ground is None or self._ground[0] is not blocks:
            joined = blocks.joined(self._believed, _where_unknown)
            if joined.key not in self._grounds:
                if len(self._grounds) >= _MOST_GROUNDS:
                    self._grounds.clear()
                self._grounds[joined.key] = Ground(Registry.load(), self.world.box, joined)
            self._ground = (blocks, self._grounds[joined.key])
        return self._ground[1]

    def _is_lost(self, name: str) -> bool:
        """Return True if the believer does not see an agent, and neither of them has moved."""
        if name not in self._unseen:
            return False
        agents = self.world.agents
        return all(agents[each].position == self._feet.get(each) for each in (name, self.root[-1]))

    def _looking(self) -> SightLines:
        blocks = self.world.terrain
        if self._geometry is None or self._geometry[0] is not blocks:
            self._geometry = (blocks, lines_of_sight(self._sight, self.world.box.low, blocks))
        return self._geometry[1]

    def _take(self, frame: Frame) -> None:
        if frame.is_empty:
            return
        events = [(frame.tick, event) for event in frame.events]
        self.happened += events
        if self._columns is not None:
            self._columns.add(frame)
            self._news.happened += events

    def _with(self, path: BeliefPath) -> Forest:
        """Return the forest with everything folded; raise PathError if it has no such node."""
        forest = self._fold()
        if forest is None or path not in forest:
            raise PathError(
                f"this imagination does not follow the beliefs of {path_text(path)}; make it with "
                "a greater depth"
            )
        return forest

    def _fold(self) -> Forest | None:
        forest, columns = self._forest, self._columns
        if forest is not None and columns is not None and forest.position < columns.end:
            forest.context.track(columns.held[self._held :])
            self._held = len(columns.held)
            forest.advance(columns.end)
        return forest


def _where_unknown(blocks: BlockStates, believed: BlockStates) -> BlockStates:
    """Return the blocks of a world, -1 where the believer knows none and the world has air."""
    return np.where((believed < 0) & (blocks == AIR), np.int32(-1), blocks)


@cache
def _in_reach(place: Position) -> InReach:
    return InReach(place, REACH)


def _print(view: NodeView) -> tuple[object, ...]:
    contents = [
        (place, tuple(sorted(each.items.items())), each.complete)
        for place, each in view.containers.items()
    ]
    agents = [
        (name, each.position, each.yaw, each.pitch, each.current, *sorted(each.inventory.items()))
        for name, each in view.agents.items()
    ]
    return (view.numbers.key, tuple(contents), tuple(agents))


def _skipped(performers: Mapping[str, Performer]) -> int:
    """Return the ticks that performers ask to skip, and count them as skipped."""
    total = 0
    for each in performers.values():
        total += each.skips
        each.skips = 0
    return total


def _advance(performer: Performer) -> bool:
    """Do one tick of the present call. Return True if the call has ended."""
    if performer.doing is None:
        return False
    try:
        performer.skips = next(performer.doing)
    except StopIteration:
        return True
    except BeliefNestError:
        performer.failed = True
        return True
    return False
