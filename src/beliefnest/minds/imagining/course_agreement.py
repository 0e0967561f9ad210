"""Agreement of a course with the percepts of an observer."""

from collections import Counter
from collections.abc import Collection, Sequence
from dataclasses import dataclass, field

import msgspec
import numpy as np

from beliefnest.belief.chunk_pool import lines_of_sight
from beliefnest.minds.imagining.courses import Course, Glimpse
from beliefnest.nest.past.percepts import Percept
from beliefnest.perception.percept import Gaze, gaze_from
from beliefnest.perception.sight import Sight, SightLines
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import Box, DroppedItem, Point, Position, block_at

_MOST_GRIDS = 4096
_DEEDS = "actions at containers"


class Tolerance(msgspec.Struct, frozen=True):
    """Allowed differences.

    Attributes:
        cells: Greatest distance of an agent from its seen place, in cells along each axis.
        ticks: Greatest shift of an event in time, in ticks.
    """

    cells: int = 0
    ticks: int = 0


class Witness(msgspec.Struct, frozen=True, eq=False):
    """Percepts of an observer, and the rules of their comparison.

    Attributes:
        owner: The observer; None: reality, where everything is perceived.
        percepts: Its percepts, oldest first.
        agents: The agents in question.
        ignored: Flat cells of blocks that are drawn and not compared.
        ignored_contents: Containers whose contents are drawn and not compared.
        items: Dropped items at the start of courses.
        box: The part of space.
        sight: Rules of sight.
        tolerance: Allowed differences.
    """

    owner: str | None
    percepts: Sequence[Percept]
    agents: Collection[str]
    ignored: frozenset[int]
    ignored_contents: frozenset[Position]
    items: Sequence[DroppedItem]
    box: Box
    sight: Sight
    tolerance: Tolerance


@dataclass(eq=False)
class Agreement:
    """Comparison of courses with percepts, tick by tick.

    Args:
        witness: The percepts.
    """

    witness: Witness
    _grids: dict[int, tuple[Terrain, bytes]] = field(default_factory=dict)
    _geometries: dict[bytes, SightLines] = field(default_factory=dict)
    _sees: dict[tuple[bytes, Point, float, float, Point], bool] = field(default_factory=dict)
    _blocks: dict[tuple[bytes, int], bool] = field(default_factory=dict)
    _lying: dict[tuple[bytes, Point, float, float], Counter[tuple[str, Position]]] = field(
        default_factory=dict
    )

    def __post_init__(self) -> None:
        percepts = self.witness.percepts
        ignored = np.array(sorted(self.witness.ignored), dtype=np.int64)
        self._numbers = {percept.tick: number for number, percept in enumerate(percepts)}
        self._keep = [~np.isin(percept.cells, ignored) for percept in percepts]
        self._number = 0

    def expected(self, tick: int) -> int:
        """Return the number of the percept that holds at a tick."""
        while (
            self._number + 1 < len(self.witness.percepts)
            and self.witness.percepts[self._number + 1].tick <= tick
        ):
            self._number += 1
        while self.witness.percepts[self._number].tick > tick and self._number:
            self._number -= 1
        return self._number

    def is_due(self, tick: int) -> bool:
        """Return True if a percept begins at a tick."""
        return tick in self._numbers

    def misfit(self, course: Course, glimpse: Glimpse) -> str | None:
        """Return what differs from the percept of a tick; None if a course agrees with it."""
        if course.contradiction is not None:
            return course.contradiction
        number = self.expected(glimpse.tick)
        percept = self.witness.percepts[number]
        if not glimpse.is_new and percept.tick != glimpse.tick:
            return None
        deeds = percept.deeds if percept.tick == glimpse.tick else ()
        reason = self._misfit(course, glimpse, number)
        return _DEEDS if reason is None and not self._deeds_fit(glimpse, percept, deeds) else reason

    def misfit_within(self, course: Course, glimpses: Sequence[Glimpse], tick: int) -> str | None:
        """Return what differs from the percept of a tick, at all of some ticks; None: nothing."""
        if course.contradiction is not None:
            return course.contradiction
        number = self._numbers[tick]
        percept = self.witness.percepts[number]
        seen = {deed for glimpse in glimpses for deed in self._witnessed(glimpse, percept)}
        mine = {deed for deed in percept.deeds if deed[1] in self.witness.agents}
        if not mine <= seen:
            return _DEEDS
        reason: str | None = None
        for glimpse in glimpses:
            reason = self._misfit(course, glimpse, number)
            if reason is None:
                break
        return reason

    def _misfit(self, course: Course, glimpse: Glimpse, number: int) -> str | None:
        """Return what facts of a course at a tick could not give a percept; None: all could."""
        percept = self.witness.percepts[number]
        if not percept.present:
            return None
        grid = self._grid(glimpse.blocks)
        if not self._blocks_fit(grid, glimpse.blocks, number):
            return "blocks"
        if not self._contents_fit(course, glimpse, percept):
            return "contents of containers"
        if not self._agents_fit(grid, glimpse, percept):
            return "places of agents"
        return None if self._items_fit(grid, glimpse, percept) else "dropped items"

    def _deeds_fit(self, glimpse: Glimpse, percept: Percept, deeds: Sequence[object]) -> bool:
        if not glimpse.deeds and not deeds:
            return True
        mine = tuple(deed for deed in percept.deeds if deed[1] in self.witness.agents)
        expected = mine if deeds else ()
        return self._witnessed(glimpse, percept) == expected

    def _witnessed(self, glimpse: Glimpse, percept: Percept) -> tuple[object, ...]:
        """Return the actions of a tick that the observer would have seen."""
        if not glimpse.deeds or not percept.present:
            return ()
        grid = self._grid(glimpse.blocks)
        return tuple(
            deed
            for deed in glimpse.deeds
            if deed[1] == self.witness.owner
            or self._sees_agent(grid, glimpse, glimpse.agents[deed[1]].position)
        )

    def _blocks_fit(self, grid: bytes, blocks: Terrain, number: int) -> bool:
        key = (grid, number)
        fits = self._blocks.get(key)
        if fits is None:
            percept, keep = self.witness.percepts[number], self._keep[number]
            if percept.known is None:
                there = blocks.at(percept.cells[keep])
                fits = bool(np.array_equal(there, percept.states[keep]))
            else:
                differs = percept.known.differing(blocks, lambda seen, _: seen >= 0)
                cells = np.ravel_multi_index(tuple(differs.T), blocks.shape)
                fits = self.witness.ignored.issuperset(cells.tolist())
            self._blocks[key] = fits
        return fits

    def _contents_fit(self, course: Course, glimpse: Glimpse, percept: Percept) -> bool:
        witness = self.witness
        for place, items in percept.contents.items():
            if place in witness.ignored_contents:
                continue
            if place in course.known and glimpse.containers.get(place, {}) != items:
                return False
        return True

    def _agents_fit(self, grid: bytes, glimpse: Glimpse, percept: Percept) -> bool:
        for name in self.witness.agents:
            state, seen = glimpse.agents.get(name), percept.agents.get(name)
            if state is None:
                if seen is not None:
                    return False
                continue
            is_seen = name == self.witness.owner or self._sees_agent(grid, glimpse, state.position)
            far = self.witness.tolerance.cells
            if seen is None:
                if is_seen:
                    return False
            elif not (is_seen or far) or not _near(state.position, seen[0], far):
                return False
        return True

    def _items_fit(self, grid: bytes, glimpse: Glimpse, percept: Percept) -> bool:
        witness = self.witness
        if not witness.items and not percept.items:
            return True
        if witness.owner is None:
            lying = Counter((item.name, block_at(item.position)) for item in witness.items)
            return lying == percept.items
        eye = _eye(glimpse, witness.owner)
        key = (grid, *eye)
        if key not in self._lying:
            geometry = self._geometry(grid, glimpse.blocks)
            places = [block_at(item.position) for item in witness.items]
            seen = geometry.sees_blocks(*eye, np.array(places, dtype=np.int64).reshape(-1, 3))
            self._lying[key] = Counter(
                (item.name, place)
                for item, place, is_seen in zip(witness.items, places, seen.tolist(), strict=True)
                if is_seen
            )
        return self._lying[key] == percept.items

    def _sees_agent(self, grid: bytes, glimpse: Glimpse, feet: Point) -> bool:
        owner = self.witness.owner
        if owner is None:
            return True
        eye = _eye(glimpse, owner)
        key = (grid, *eye, feet)
        sees = self._sees.get(key)
        if sees is None:
            geometry = self._geometry(grid, glimpse.blocks)
            sees = self._sees[key] = bool(geometry.sees_agents(*eye, [feet])[0])
        return sees

    def _grid(self, blocks: Terrain) -> bytes:
        kept = self._grids.get(id(blocks))
        if kept is None or kept[0] is not blocks:
            while len(self._grids) >= _MOST_GRIDS:
                del self._grids[next(iter(self._grids))]
            kept = self._grids[id(blocks)] = (blocks, blocks.key)
        return kept[1]

    def _geometry(self, grid: bytes, blocks: Terrain) -> SightLines:
        geometry = self._geometries.get(grid)
        if geometry is None:
            made = lines_of_sight(self.witness.sight, self.witness.box.low, blocks)
            geometry = self._geometries[grid] = made
        return geometry


def _eye(glimpse: Glimpse, owner: str) -> Gaze:
    state = glimpse.agents[owner]
    return gaze_from(state.position, state.yaw, state.pitch)


def _near(feet: Point, other: Point, cells: int) -> bool:
    pairs = zip(block_at(feet), block_at(other), strict=True)
    return max(abs(one - two) for one, two in pairs) <= cells
