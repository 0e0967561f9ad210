"""Alternatives as worlds: forks of one simulator, and the views that distinguish them.

A percept contains everything that sight gives by semantics, section 3: visible blocks, agents and
dropped items, transparent contents, and the absence of such things. Two alternatives are alike from
a place if both give the same percept there. They differ in few elements, so the code compares only
the doubted elements and the cells behind blocks whose shapes are in doubt.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property, lru_cache

import msgspec
import numpy as np
import numpy.typing as npt

from beliefnest.belief.chunk_pool import changed_lines, lines_of_sight
from beliefnest.perception.percept import Gaze, Perceptibles, gaze_from, percept
from beliefnest.perception.sight import Sight, SightLines
from beliefnest.world.array_types import Cells
from beliefnest.world.terrain import SIDE, VOLUME, Terrain
from beliefnest.world.values import Box, DroppedItem, Items, Point, Position

AgentPose = tuple[Point, float, float]
"""Feet, yaw and pitch."""

# Radius of a block's cube, and of its shape, which may reach half a block out along one axis.
_CUBE, _SHAPE = 0.88, 1.25
# Radius of the cubes of all cells of a chunk.
_CHUNK = 7.0
_CHUNKS_AT_ONCE = 256

_AROUND = np.array([(0, 0, 0), *np.eye(3, dtype=np.int64), *-np.eye(3, dtype=np.int64)])
_IN_CHUNK = np.stack(np.unravel_index(np.arange(VOLUME), (SIDE, SIDE, SIDE)), axis=1)
_NO_CELLS = np.empty((0, 3), dtype=np.int64)


class AlternativeWorld(msgspec.Struct, frozen=True, eq=False):
    """One alternative at one moment.

    Attributes:
        blocks: Block states, -1 unknown.
        contents: Known contents of containers.
        agents: Feet, yaw and pitch of agents whose pose is known.
    """

    blocks: Terrain
    contents: Mapping[Position, Items]
    agents: Mapping[str, AgentPose]


@lru_cache(maxsize=8)
def _all_round(sight: Sight) -> Sight:
    return replace(sight, field_of_view=360.0)


class AlternativeWorlds:
    """All alternatives of a doubt at one moment.

    Args:
        sight: Rules of sight.
        box: The part of space.
        worlds: The alternatives; those with equal blocks share a terrain.
        items: Dropped items.
        agent: The agent that looks.
        transparent: True if agents that see a container perceive its contents.
    """

    def __init__(
        self,
        sight: Sight,
        box: Box,
        worlds: Sequence[AlternativeWorld],
        items: Mapping[int, DroppedItem],
        agent: str,
        *,
        transparent: bool,
    ) -> None:
        self.box, self.worlds, self.items, self.agent = box, tuple(worlds), items, agent
        self._sight, self._transparent = sight, transparent

    def geometry(self, actual: int) -> SightLines:
        """Return the blocks of an alternative, prepared for lines of sight."""
        return self._geometry_of[actual]

    def states(self, number: int) -> npt.NDArray[np.int32]:
        """Return the states of an alternative at the cells whose blocks differ."""
        return self.worlds[number].blocks.at_indices(self._doubted)

    @cached_property
    def _geometry_of(self) -> list[SightLines]:
        first = self.worlds[0].blocks
        plain = lines_of_sight(self._sight, self.box.low, first)
        by_blocks = {id(first): plain}
        by_codes = {plain.codes_at(self._near).tobytes(): plain}
        for blocks in (world.blocks for world in self.worlds):
            if id(blocks) not in by_blocks:
                made = changed_lines(plain, blocks, self._doubted)
                key = made.codes_at(self._near).tobytes()
                by_blocks[id(blocks)] = by_codes.setdefault(key, made)
        return [by_blocks[id(world.blocks)] for world in self.worlds]

    @cached_property
    def _round(self) -> dict[int, SightLines]:
        sight = _all_round(self._sight)
        return {id(each): replace(each, sight=sight) for each in self._geometry_of}

    @cached_property
    def has_one_view(self) -> bool:
        """Return True if lines of sight are the same in all alternatives."""
        return len({id(each) for each in self._geometry_of}) == 1

    @cached_property
    def _doubted(self) -> Cells:
        """Indices of the cells whose blocks differ, in order."""
        first = self.worlds[0].blocks
        others = {id(world.blocks): world.blocks for world in self.worlds[1:]}.values()
        differing = [first.differing(each) for each in others if each is not first]
        return np.unique(np.concatenate([_NO_CELLS, *differing]), axis=0)

    @cached_property
    def _near(self) -> Cells:
        """Indices of the cells whose shapes may differ, in order; they may lie in the margin."""
        return np.unique((self._doubted[:, None] + _AROUND).reshape(-1, 3), axis=0)

    @cached_property
    def _hiding(self) -> npt.NDArray[np.float64]:
        """Middles of the cells whose shapes differ."""
        geometries = {id(each): each for each in self._geometry_of}.values()
        first, *others = (each.codes_at(self._near) for each in geometries)
        differs = np.logical_or.reduce([each != first for each in others])
        inside = ((self._near >= 0) & (self._near < np.array(self.box.shape))).all(axis=1)
        return self._middles(self._near[differs & inside])

    def _middles(self, cells: Cells) -> npt.NDArray[np.float64]:
        middles: npt.NDArray[np.float64] = cells + 0.5 + np.array(self.box.low)
        return middles

    @cached_property
    def _doubted_contents(self) -> list[Position]:
        if not self._transparent:
            return []
        places = {place for world in self.worlds for place in world.contents}
        kept = [
            place
            for place in places
            if len({_items_key(world.contents.get(place)) for world in self.worlds}) > 1
        ]
        return sorted(kept)

    @cached_property
    def _doubted_agents(self) -> list[str]:
        names = {name for world in self.worlds for name in world.agents} - {self.agent}
        if not self.has_one_view:
            return sorted(names)
        poses = {name: {world.agents.get(name) for world in self.worlds} for name in names}
        return sorted(name for name, possible in poses.items() if len(possible) > 1)

    @property
    def can_differ(self) -> bool:
        """Return True if some view can distinguish alternatives."""
        return bool(len(self._doubted) or self._doubted_contents or self._doubted_agents)

    def alike(self, feet: Point, yaw: float, pitch: float, *, all_round: bool) -> list[int]:
        """Return, for each alternative, the set of those with the same percept from a pose.

        Args:
            feet: Position of the feet.
            yaw: Radians.
            pitch: Radians.
            all_round: True: ignore the field of view and look in all directions.
        """
        count = len(self.worlds)
        everyone = (1 << count) - 1
        if not self.can_differ:
            return [everyone] * count
        look = gaze_from(feet, yaw, pitch)
        if self.has_one_view and not self._doubted_contents and not self._doubted_agents:
            return self._alike_by_blocks(look, all_round)
        percepts = self._percepts(look, all_round)
        undecided = self._undecided(percepts)
        # Doubted elements look the same in these, but may hide different things.
        for cells in self._behind(look.eye) if undecided else ():
            for group in undecided:
                further = self._seen(look, cells, group, all_round)
                for number, seen in zip(group, further, strict=True):
                    percepts[number] = (percepts[number], seen.tobytes())
            undecided = self._undecided(percepts)
            if not undecided:
                break
        return _masks(percepts)

    def _undecided(self, percepts: Sequence[object]) -> list[list[int]]:
        """Return groups of alternatives with equal percepts but different lines of sight."""
        groups: dict[object, list[int]] = {}
        for number, each in enumerate(percepts):
            groups.setdefault(each, []).append(number)
        return [
            group
            for group in groups.values()
            if len({id(self._geometry_of[number]) for number in group}) > 1
        ]

    def _alike_by_blocks(self, look: Gaze, all_round: bool) -> list[int]:
        """Return the result of `alike` if only blocks differ, and all of them hide the same."""
        plain = self._geometry_of[0]
        seeing = self._round[id(plain)] if all_round else plain
        seen = seeing.sees_blocks(*look, self._doubted + np.array(self.box.low))
        key = seen.tobytes()
        if key not in self._by_seen:
            states = [self.states(number)[seen] for number in range(len(self.worlds))]
            self._by_seen[key] = _masks([each.tobytes() for each in states])
        return self._by_seen[key]

    @cached_property
    def _by_seen(self) -> dict[bytes, list[int]]:
        """Alternatives with the same percept, by which of the differing blocks are seen."""
        return {}

    def _percepts(self, look: Gaze, all_round: bool) -> list[object]:
        """Return the percepts of doubted blocks, of contents, agents and items."""
        everyone = range(len(self.worlds))
        return [
            self._percept(number, look, all_round, seen)
            for number, seen in zip(
                everyone, self._seen(look, self._doubted, everyone, all_round), strict=True
            )
        ]

    def _seen(
        self, look: Gaze, cells: Cells, which: Sequence[int], all_round: bool
    ) -> list[npt.NDArray[np.bool_]]:
        """Return a mask of the cells whose blocks are seen, for some alternatives."""
        seen: dict[int, npt.NDArray[np.bool_]] = {}
        places = cells + np.array(self.box.low, dtype=np.int64)
        for number in which:
            key = id(self._geometry_of[number])
            if key not in seen:
                seen[key] = self._seeing(number, all_round).sees_blocks(*look, places)
        return [seen[id(self._geometry_of[number])] for number in which]

    def _seeing(self, number: int, all_round: bool) -> SightLines:
        plain = self._geometry_of[number]
        return self._round[id(plain)] if all_round else plain

    def _behind(self, eye: Point) -> Iterator[Cells]:
        """Yield the indices of known cells whose sight from a place can depend on the alternative.

        In a box of several chunks they come in parts, the nearest first. Without a limit of
        distance they may lie anywhere in the box.
        """
        far, blocks = self._sight.max_visible_distance, self.worlds[0].blocks
        place = np.array(eye)
        hiding = self._hiding - place
        if far is not None:
            hiding = hiding[np.sqrt((hiding**2).sum(axis=1)) <= far + _SHAPE]
        if not len(hiding):
            return
        if blocks.is_dense:
            cells, middles = self._known_cells
            yield cells[_is_behind(middles - place, hiding, _CUBE, far)]
            return
        starts = self._chunks_around(place, far)
        away = starts + SIDE / 2 + np.array(self.box.low) - place
        kept = _is_behind(away, hiding, _CHUNK, None if far is None else far + _CHUNK)
        starts = starts[kept][np.argsort((away[kept] ** 2).sum(axis=1), kind="stable")]
        for first in range(0, len(starts), _CHUNKS_AT_ONCE):
            some = starts[first : first + _CHUNKS_AT_ONCE]
            cells = blocks.lattice.clipped((some[:, None] + _IN_CHUNK).reshape(-1, 3))
            cells = cells[_is_behind(self._middles(cells) - place, hiding, _CUBE, far)]
            yield cells[blocks.at_indices(cells) >= 0]

    @cached_property
    def _known_cells(self) -> tuple[Cells, npt.NDArray[np.float64]]:
        """Indices and middles of the cells of a box of one chunk that are known."""
        cells = np.argwhere(self.worlds[0].blocks.dense() >= 0)
        return cells, self._middles(cells)

    @cached_property
    def _is_known(self) -> npt.NDArray[np.bool_]:
        """By number of a chunk, True if a cell of it is known."""
        blocks = self.worlds[0].blocks
        is_known = np.array([bool((chunk >= 0).any()) for chunk in blocks.chunks], dtype=np.bool_)
        return is_known[blocks.rows]

    def _chunks_around(self, place: npt.NDArray[np.float64], far: float | None) -> Cells:
        """Return the indices of the first cells of the known chunks within a distance."""
        lattice = self.worlds[0].blocks.lattice
        spans = [(0, size) for size in self.box.shape]
        if far is not None:
            reach = math.ceil(far) + 1
            at = np.floor(place - self.box.low).astype(np.int64).tolist()
            spans = [
                (max(middle - reach, 0), min(middle + reach + 1, size))
                for middle, size in zip(at, self.box.shape, strict=True)
            ]
        numbers = lattice.within(*spans)
        return lattice.starts(numbers[self._is_known[numbers]])

    def _percept(
        self, number: int, look: Gaze, all_round: bool, seen: npt.NDArray[np.bool_]
    ) -> tuple[object, ...]:
        """Return a percept of an alternative as a value to compare; `seen` masks doubted cells."""
        world, seeing = self.worlds[number], self._seeing(number, all_round)
        states = self.states(number)
        blocks = np.where(seen & (states >= 0), states, -1).tobytes()
        seen_things = percept(
            seeing,
            look,
            Perceptibles(
                {place: world.contents.get(place) for place in self._doubted_contents},
                {n: world.agents[n][0] for n in self._doubted_agents if n in world.agents},
                {} if self.has_one_view else self.items,
            ),
        )
        contents = [(place, _items_key(items)) for place, items in seen_things.contents.items()]
        agents = [(name, world.agents[name]) for name in seen_things.agents]
        return blocks, tuple(contents), tuple(agents), tuple(seen_things.items)


def _is_behind(
    away: npt.NDArray[np.float64], hiding: npt.NDArray[np.float64], radius: float, far: float | None
) -> npt.NDArray[np.bool_]:
    """Return a mask of the balls whose sight can depend on what is in some cells.

    Args:
        away: Middles of the balls (n, 3), from the eye.
        hiding: Middles of the cells (m, 3), from the eye.
        radius: Radius of the balls.
        far: Greatest distance of middles; None: no limit.
    """
    wanted = np.zeros(len(away), dtype=np.bool_)
    distance = np.sqrt((away**2).sum(axis=1))
    for cell in hiding:
        length = float(np.sqrt((cell**2).sum()))
        if length <= _SHAPE:
            wanted[:] = True
            break
        # Lines from the eye to a ball that come near the hiding cell: within two cones.
        with np.errstate(divide="ignore", invalid="ignore"):
            cosine = np.clip(away @ cell / (distance * length), -1, 1)
        spread = math.asin(_SHAPE / length) + np.arcsin(radius / np.maximum(distance, radius))
        behind = distance >= length - _SHAPE - radius
        wanted |= (behind & (np.arccos(cosine) <= spread)) | (distance <= radius)
    if far is not None:
        wanted &= distance <= far + 1e-6
    return wanted


def _masks(percepts: Sequence[object]) -> list[int]:
    """Return for each percept the numbers of equal ones, as bits."""
    masks: dict[object, int] = {}
    for number, each in enumerate(percepts):
        masks[each] = masks.get(each, 0) | 1 << number
    return [masks[each] for each in percepts]


def _items_key(items: Items | None) -> object:
    return None if items is None else tuple(sorted(items.items()))
