"""View of one node at one entry of a timeline, read from its forest on demand."""

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from typing import Any, Generic, TypeVar

import numpy as np
import numpy.typing as npt

from beliefnest.belief.arrays import NOBODY, READ, UNKNOWN
from beliefnest.belief.chunk_pool import cut_grids
from beliefnest.belief.columns import place_of
from beliefnest.belief.forest import Forest
from beliefnest.belief.grounds import AgentBelief, Basis, ContainerBelief, PerceivedEvent, Source
from beliefnest.perception.percept import gaze_from
from beliefnest.perception.sight import ChunkGeometry, Geometry, SightLines
from beliefnest.world.double_chests import ByEitherHalf, believed_container_at, states_in
from beliefnest.world.event_kinds import EventKind
from beliefnest.world.frames import BlockGrid, Snapshot
from beliefnest.world.paths import BeliefPath
from beliefnest.world.signs import sign_states
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import AgentState, DroppedItem, Position

T = TypeVar("T")

FULL = 20.0
"""Health and food assumed for an agent if they are unknown."""


class Part(Generic[T]):
    """Attribute of a view that is read once, in the reader's turn, and then kept.

    `functools.cached_property` of Python 3.11 locks each attribute before the reader can take its
    turn. A thread that folds the forest has its turn and reads all parts: both would wait forever.
    """

    def __init__(self, read: Callable[[Any], T]) -> None:
        self._read, self.__doc__ = read, read.__doc__

    def __set_name__(self, owner: type, name: str) -> None:
        self._name = name

    def __get__(self, view: Any, owner: type | None = None) -> T:
        kept: dict[str, T] = vars(view)
        with view.turn:
            if self._name not in kept:
                kept[self._name] = self._read(view)
            return kept[self._name]


class NodeView:
    """State of a node. It stays as it is when the forest folds further entries.

    Attributes that are not described here are those of `State`.

    Args:
        forest: The forest, which is at the wanted entry.
        path: Path of the node.
        tick: Tick of the view, at or after that of the last entry; None: the tick of that entry.

    Attributes:
        turn: Lock of the thread that reads the forest.
        count_of_events: Number of events of the timeline before it.
    """

    turn: AbstractContextManager[object] = nullcontext()

    def __init__(self, forest: Forest, path: BeliefPath, tick: int | None = None) -> None:
        self.path, self.box = path, forest.context.box
        self.tick = forest.tick if tick is None else tick
        self._forest = forest
        self._node = forest.node(path)
        self.count_of_events = forest.count_of_events
        self._is_left = False
        forest.read_by(self)

    def keep(self) -> None:
        """Read all parts that the forest will overwrite; called before it folds further."""
        self.numbers, self.agents, self.containers, self.items  # noqa: B018 - kept when read
        self._is_left = True

    @property
    def owner(self) -> str | None:
        """The agent whose belief this is; None in the real world."""
        return self.path[-1] if self.path else None

    @Part
    def grid(self) -> BlockGrid:
        """The believed block states as a dense array, shape of the box, -1 unknown."""
        return self.terrain.dense()

    @Part
    def terrain(self) -> Terrain:
        """The believed block states, -1 unknown."""
        return self._forest.context.states(self.numbers)

    @Part
    def numbers(self) -> Terrain:
        """The numbers of the believed blocks; signs with different texts have different numbers.

        See `BeliefContext.number`.
        """
        return self._forest.table.blocks(self._node)

    @Part
    def texts(self) -> Mapping[Position, str]:
        """The believed texts of signs that carry text, in order of position."""
        return self._forest.context.texts(self.numbers)

    @Part
    def signs(self) -> Mapping[Position, str]:
        """The texts of known signs, in order of position; empty for a blank sign."""
        x, y, z = self.box.low
        offsets = self.terrain.find(sign_states(self._forest.context.registry)).tolist()
        places = ((x + i, y + j, z + k) for i, j, k in offsets)
        return {place: self.texts.get(place, "") for place in places}

    @Part
    def geometry(self) -> SightLines:
        """The believed blocks prepared for lines of sight."""
        forest = self._forest
        if forest.table.pool is None:
            return self._dense_geometry
        if self._is_left:
            space = forest.context.space
            cut = cut_grids(space.codes, space.reaches, (self.numbers,))
            codes, rows = cut.codes, cut.rows[0]
        else:
            codes, rows = forest.table.codes(self._node)
        return ChunkGeometry(forest.context.sight, self.box.low, self.box.shape, codes, rows)

    @Part
    def _dense_geometry(self) -> Geometry:
        return self._forest.context.sight.geometry(self.grid, self.box.low)

    @Part
    def containers(self) -> Mapping[Position, ContainerBelief]:
        """The known contents, in order of position; found at either half of a double chest."""
        forest = self._forest
        beliefs = {}
        for cell in sorted(forest.holdings.of(self._node).containers):
            content = forest.holdings.content(self._node, cell).at(self.tick)
            beliefs[place_of(self.box, cell)] = ContainerBelief(
                content.items, content.complete, content.basis, content.current
            )
        return ByEitherHalf(beliefs, self.container_at)

    @Part
    def container_at(self) -> Callable[[Position], Position]:
        """Function of a block: the position of its container, as far as is believed."""
        # A function of the view would be a cycle of references: the forest would keep the view, and
        # read all of it before each entry, until Python's collector of cycles came along.
        registry = self._forest.context.registry
        state_at = states_in(self.box, self.terrain, UNKNOWN)
        return lambda place: believed_container_at(registry, state_at, place)

    @Part
    def agents(self) -> Mapping[str, AgentBelief]:
        """The beliefs about every agent, by name."""
        names = self._forest.context.agents
        return {name: self._agent(number) for number, name in enumerate(names)}

    @Part
    def items(self) -> Mapping[int, DroppedItem]:
        """The dropped items last seen, by number."""
        return dict(self._forest.holdings.of(self._node).items)

    @Part
    def perceived(self) -> tuple[PerceivedEvent, ...]:
        """All perceived events, oldest first."""
        return tuple(self._forest.heard(self._node, self.count_of_events))

    @property
    def events(self) -> tuple[PerceivedEvent, ...]:
        """The perceived events other than speech and thought, in order."""
        return tuple(event for event in self.perceived if not event.kind.is_speech)

    @property
    def chat(self) -> Sequence[tuple[int, str, str]]:
        """The utterances heard: (tick, speaker, text)."""
        return self._said(EventKind.CHAT)

    @property
    def addressees(self) -> Sequence[str | None]:
        """The addressee of each line of `chat` that was whispered; None: it was said aloud."""
        return [e.detail.get("to") for e in self.perceived if e.kind is EventKind.CHAT]

    @property
    def thoughts(self) -> Sequence[tuple[int, str, str]]:
        """The owner's thoughts: (tick, thinker, text)."""
        return self._said(EventKind.THINK)

    def events_since(self, count: int) -> tuple[PerceivedEvent, ...]:
        """Return perceived events except those among the timeline's first `count`, oldest first."""
        return tuple(self._forest.heard(self._node, self.count_of_events, count))

    def perceived_since(self, count: int) -> npt.NDArray[np.bool_]:
        """Return a mask of the timeline's events after the first `count`: those perceived."""
        return self._forest.perceived_events.of(self._node, self.count_of_events, count)

    def agents_in_sight(self) -> Mapping[str, AgentState]:
        """Return what is seen in this tick of others, by name; call it before the forest folds on.

        It spares the reader all else that is believed of them.
        """
        forest, node, poses = self._forest, self._node, self._forest.poses
        seen = {}
        with self.turn:
            for number, pose in forest.table.in_sight(node):
                name, posed = forest.context.agents[number], poses.details(pose)
                if name != self.owner:
                    worn = poses.details(forest.table.equipment(node, number))
                    seen[name] = AgentState(
                        poses.position(pose),
                        *poses.angles(pose),
                        posed is None or posed.on_ground,
                        {} if worn is None else worn.equipment,
                    )
        return seen

    def visible_from(self, agent: str) -> npt.NDArray[np.bool_]:
        """Return a mask of the blocks that an agent sees from its believed pose.

        The mask is all False if the pose is unknown.
        """
        viewer = self.agents[agent]
        if viewer.position is None:
            return np.zeros(self.box.shape, dtype=np.bool_)
        gaze = gaze_from(viewer.position, viewer.yaw, viewer.pitch)
        return self._dense_geometry.visible_blocks(*gaze)

    def snapshot(self) -> Snapshot:
        """Return the snapshot with which a body of this state is filled.

        Unknown blocks become air and agents of unknown pose are left out. An agent that was seen to
        wear or hold an item has it in its inventory.
        """
        agents = {
            name: AgentState(
                position=agent.position,
                yaw=agent.yaw,
                pitch=agent.pitch,
                on_ground=agent.on_ground,
                equipment=dict(agent.equipment or {}),
                inventory=_with_equipment(agent),
                health=FULL if agent.health is None else agent.health,
                food=FULL if agent.food is None else agent.food,
            )
            for name, agent in self.agents.items()
            if agent.position is not None
        }
        return Snapshot(
            tick=self.tick,
            box=self.box,
            blocks=self.terrain.mapped(lambda part: np.maximum(part, 0)),
            containers={place: dict(c.items) for place, c in self.containers.items()},
            agents=agents,
            items=dict(self.items),
            signs=dict(self.texts),
        )

    def _said(self, kind: EventKind) -> list[tuple[int, str, str]]:
        events = (event for event in self.perceived if event.kind is kind)
        return [(e.tick, e.actor or "", e.detail["text"]) for e in events]

    def _agent(self, number: int) -> AgentBelief:
        forest, node = self._forest, self._node
        table, poses = forest.table, forest.table.poses
        inventory, complete = forest.holdings.inventory(node, number)
        seen = poses.details(table.equipment(node, number))
        health, food = forest.holdings.vitals(node, number)
        pose = table.pose(node, number)
        if pose < 0:
            return AgentBelief(
                equipment=None if seen is None else seen.equipment,
                inventory=inventory,
                inventory_complete=complete,
            )
        posed = poses.details(pose)
        yaw, pitch = poses.angles(pose)
        current = table.is_current(node, number)
        return AgentBelief(
            position=poses.position(pose),
            yaw=yaw,
            pitch=pitch,
            on_ground=posed is None or posed.on_ground,
            equipment=None if seen is None else seen.equipment,
            inventory=inventory,
            inventory_complete=complete,
            health=health,
            food=food,
            basis=self._basis(pose, self.tick if current else table.seen_at(node, number)),
            current=current,
        )

    def _basis(self, pose: int, tick: int) -> Basis:
        """Return the basis of a believed pose."""
        poses = self._forest.poses
        speaker = poses.speaker(pose)
        if speaker != NOBODY:
            return self._forest.context.heard_from(tick, NOBODY if speaker == READ else speaker)
        return Basis(tick, Source.PRIOR if poses.details(pose) is None else Source.SEEN)


def _with_equipment(agent: AgentBelief) -> dict[str, int]:
    worn = Counter((agent.equipment or {}).values())
    names = [*agent.inventory, *(worn.keys() - agent.inventory.keys())]
    return {name: max(agent.inventory.get(name, 0), worn[name]) for name in names}
