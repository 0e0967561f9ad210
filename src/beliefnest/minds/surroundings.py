"""Scenes: what surrounds a modelled agent at one moment, from which stages are made."""

import hashlib
from collections import OrderedDict
from collections.abc import Mapping, Sequence
from functools import cached_property, lru_cache

import numpy as np
import numpy.typing as npt

from beliefnest.errors import TooLargeError
from beliefnest.geometry.free_lines import can_use, eye_in
from beliefnest.minds.alternatives import AlternativeWorlds
from beliefnest.minds.mind_model import PossibleGoal
from beliefnest.minds.stage import DIAGONALS, SIDES, Stage
from beliefnest.minds.ways import Floor, Ways, bodies_in, ways_from
from beliefnest.world.memory import MEGABYTE, memory_limit
from beliefnest.world.registry import Registry
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import Items, Position, feet_in

_MOST_STAGES = 64

_MOST_CELLS = 1 << 18
"""Most cells of a stage: that many were tried, and took 20 s and 700 MB with two alternatives."""

_OBJECTS = 500
"""Bytes of the Python objects of a cell of a stage: position and number."""


class Surroundings:
    """All alternatives at one moment, with the goals of an agent in them.

    Args:
        registry: Names and shapes of blocks.
        worlds: The alternatives.
        goals: Goals by name.
        doubted: Containers whose contents the alternatives set.
        diagonal: True if steps also lead to diagonal neighbours.
        key: Digest of all of these, and of the inputs of agents' sight.
    """

    def __init__(
        self,
        registry: Registry,
        worlds: AlternativeWorlds,
        goals: Mapping[str, PossibleGoal],
        doubted: Sequence[Position],
        *,
        diagonal: bool,
        key: bytes,
    ) -> None:
        self.worlds, self._registry, self._goals = worlds, registry, goals
        self._doubted, self._diagonal, self._key = tuple(doubted), diagonal, key
        self._stages: dict[Position, Stage] = {}
        self._lines: dict[tuple[int, Position, Position], bool] = {}

    def with_worlds(self, worlds: AlternativeWorlds, key: bytes) -> "Surroundings":
        """Return a scene of other alternatives, with a digest of how they differ from these."""
        return Surroundings(
            self._registry,
            worlds,
            self._goals,
            self._doubted,
            diagonal=self._diagonal,
            key=self._key + key,
        )

    def stage(self, *cells: Position) -> Stage:
        """Return the stage of all cells that can be got to from some.

        Raises:
            TooLargeError: The planner has no room for so many cells.
        """
        for stage in self._stages.values():
            if all(cell in stage.index for cell in cells):
                return stage
        limit, each = memory_limit(), self._cell_bytes
        most = _MOST_CELLS if limit is None else min(_MOST_CELLS, limit.bytes // each)
        ways = ways_from(self.worlds.box, self._floors, cells, diagonal=self._diagonal, most=most)
        if ways is None:
            why = f"It plans for at most {most:,}"
            if limit is not None and most < _MOST_CELLS:
                why = (
                    f"Each takes at least {each:,} bytes, and this process may use "
                    f"{limit.bytes // MEGABYTE:,} MB, {limit.source}"
                )
            raise TooLargeError(
                f"{self.worlds.agent} can get to more than {most:,} cells from {cells[0]}, too "
                f"many for the planner. {why}: use a smaller box, or end the floor with "
                "walls or gaps around the part that matters"
            )
        digest = hashlib.blake2b(self._key)
        digest.update(repr(ways.cells).encode())
        digest.update(ways.moves.tobytes())
        digest.update(ways.doors.tobytes())
        made = _stages().get(digest.digest())
        if made is None:
            made = self._made(ways)
            _stages().put(digest.digest(), made)
        self._stages[cells[0]] = made
        return made

    def can_stand(self, cell: Position) -> bool:
        """Return True if an agent can stand in a cell in any alternative."""
        place = np.array([self.worlds.box.index(cell)])
        return any(bool(floor.stands(place)[0]) for floor in self._floors)

    def in_reach(
        self, alternative: int, cell: Position, places: Sequence[Position]
    ) -> list[Position]:
        """Return those of some places that an agent reaches from a cell in an alternative."""
        blocks = self.worlds.worlds[alternative].blocks
        return [place for place in places if self._reached(blocks, [cell], [place])[0]]

    def has_unknown_floor(self, cell: Position) -> bool:
        """Return True if the block below a cell is unknown in all alternatives."""
        box, below = self.worlds.box, (cell[0], cell[1] - 1, cell[2])
        return below in box and all(
            world.blocks[box.index(below)] < 0 for world in self.worlds.worlds
        )

    @cached_property
    def _floors(self) -> list[Floor]:
        """The floor of each alternative; one for those that are alike to bodies."""
        made: dict[bytes, Floor] = {}
        return [
            made.setdefault(
                bodies_in(self._registry, self.worlds.states(number)).tobytes(),
                Floor(self._registry, world.blocks),
            )
            for number, world in enumerate(self.worlds.worlds)
        ]

    @property
    def _cell_bytes(self) -> int:
        """Bytes that a cell of a stage needs at least."""
        steps = len(SIDES) + (len(DIAGONALS) if self._diagonal else 0)
        return _OBJECTS + len(self.worlds.worlds) * (4 * steps + 8 + len(self._goals))

    def _made(self, ways: Ways) -> Stage:
        worlds = self.worlds
        count = len(worlds.worlds)
        if worlds.can_differ:
            looks = [worlds.alike(feet_in(cell), 0.0, 0.0, all_round=True) for cell in ways.cells]
            same = np.array(looks, dtype=np.int64).T.copy()
        else:
            same = np.full((count, len(ways.cells)), (1 << count) - 1, dtype=np.int64)
        boxes = tuple(
            place
            for place in self._doubted
            if len({_known(world.contents.get(place)) for world in worlds.worlds}) > 1
        )
        contents = [
            [_known(world.contents.get(place)) for world in worlds.worlds] for place in boxes
        ]
        content = [
            [sum(1 << b for b, other in enumerate(row) if other == mine) for mine in row]
            for row in contents
        ]
        return Stage(
            ways.cells,
            ways.moves,
            ways.doors,
            same,
            self._acts(ways.cells),
            np.array([goal.item is not None for goal in self._goals.values()], dtype=np.bool_),
            boxes,
            self._openings(ways.cells, boxes),
            np.array(content, dtype=np.int64).reshape(len(boxes), count),
        )

    def _acts(self, cells: Sequence[Position]) -> npt.NDArray[np.bool_]:
        worlds = self.worlds.worlds
        acts = np.zeros((len(worlds), len(self._goals), len(cells)), dtype=np.bool_)
        below = np.array(cells, dtype=np.int64) - np.array(self.worlds.box.low) - (0, 1, 0)
        shape = np.array(self.worlds.box.shape)
        inside = np.flatnonzero(((below >= 0) & (below < shape)).all(axis=1))
        for number, goal in enumerate(self._goals.values()):
            if goal.at is not None:
                acts[:, number] = [cell == goal.at for cell in cells]
            elif goal.block is not None:
                ids = self._registry.state_ids(goal.block)
                for a, world in enumerate(worlds):
                    states = world.blocks.at_indices(below[inside])
                    acts[a, number, inside] = (states >= ids.start) & (states < ids.stop)
            else:
                dropped = [
                    _cell_of(item.position)
                    for item in self.worlds.items.values()
                    if item.name == goal.item
                ]
                for a, world in enumerate(worlds):
                    sites = [p for p, items in world.contents.items() if items.get(goal.item or "")]
                    acts[a, number] = self._reached(world.blocks, cells, [*sites, *dropped])
        return acts

    def _openings(
        self, cells: Sequence[Position], boxes: Sequence[Position]
    ) -> npt.NDArray[np.bool_]:
        """Mark the cells from which containers can be opened in an alternative, a row for each."""
        distinct = {id(world.blocks): world.blocks for world in self.worlds.worlds}.values()
        reach = np.zeros((len(boxes), len(cells)), dtype=np.bool_)
        for number, place in enumerate(boxes):
            for blocks in distinct:
                reach[number] |= self._reached(blocks, cells, [place])
        return reach

    def _reached(
        self, blocks: Terrain, cells: Sequence[Position], places: Sequence[Position]
    ) -> npt.NDArray[np.bool_]:
        """Mark the cells that are, or neighbour, one of some places, with a free line to it."""
        reached = np.zeros(len(cells), dtype=np.bool_)
        for place in places:
            away = np.abs(np.array(cells, dtype=np.int64) - np.array(place))
            aside = (
                np.maximum(away[:, 0], away[:, 2]) if self._diagonal else away[:, 0] + away[:, 2]
            )
            for number in np.flatnonzero((aside <= 1) & (away[:, 1] <= 1) & ~reached).tolist():
                reached[number] = self._has_line(blocks, cells[number], place)
        return reached

    def _has_line(self, blocks: Terrain, cell: Position, place: Position) -> bool:
        asked = (id(blocks), cell, place)
        if asked not in self._lines:
            self._lines[asked] = can_use(self.worlds.box, blocks, eye_in(cell), place)
        return self._lines[asked]


class _Stages:
    """Stages by content, the oldest dropped."""

    def __init__(self) -> None:
        self._kept: OrderedDict[bytes, Stage] = OrderedDict()

    def get(self, key: bytes) -> Stage | None:
        stage = self._kept.get(key)
        if stage is not None:
            self._kept.move_to_end(key)
        return stage

    def put(self, key: bytes, stage: Stage) -> None:
        self._kept[key] = stage
        while len(self._kept) > _MOST_STAGES:
            self._kept.popitem(last=False)


@lru_cache(maxsize=1)
def _stages() -> _Stages:
    return _Stages()


def _known(items: Items | None) -> object:
    return None if items is None else tuple(sorted(items.items()))


def _cell_of(place: Sequence[float]) -> Position:
    return (int(np.floor(place[0])), int(np.floor(place[1])), int(np.floor(place[2])))
