"""Alternatives as worlds: forks of one simulator, and the views that distinguish them.

A percept contains everything that sight gives by semantics, section 3: visible blocks, agents and
dropped items, transparent contents, and the absence of such things. Two alternatives are alike from
a place if both give the same percept there. They differ in few elements, so the code compares only
the doubted elements and the cells behind blocks whose shapes are in doubt.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np
import numpy.typing as npt

from beliefnest.perception.sight import Geometry, Sight
from beliefnest.world.frames import BlockGrid
from beliefnest.world.values import EYE_HEIGHT, Box, DroppedItem, Items, Point, Position

__all__ = ["Pose", "World", "Worlds"]

Pose = tuple[Point, float, float]
"""Feet, yaw and pitch."""

# Radius of a block's cube, and of its shape, which may reach half a block out along one axis.
_CUBE, _SHAPE = 0.88, 1.25


@dataclass(frozen=True, eq=False)
class World:
    """One alternative at one moment.

    Attributes:
        blocks: Block states, -1 unknown.
        contents: Known contents of containers.
        agents: Feet, yaw and pitch of agents whose pose is known.
    """

    blocks: BlockGrid
    contents: Mapping[Position, Items]
    agents: Mapping[str, Pose]


@lru_cache(maxsize=8)
def _all_round(sight: Sight) -> Sight:
    return replace(sight, field_of_view=360.0)


class Worlds:
    """All alternatives of a doubt at one moment.

    Args:
        sight: Rules of sight.
        box: The part of space.
        worlds: The alternatives; those with equal blocks share a grid.
        items: Dropped items.
        agent: The agent that looks.
        transparent: True if agents that see a container perceive its contents.
    """

    def __init__(
        self,
        sight: Sight,
        box: Box,
        worlds: Sequence[World],
        items: Mapping[int, DroppedItem],
        agent: str,
        *,
        transparent: bool,
    ) -> None:
        self.box, self.worlds, self.items = box, tuple(worlds), items
        self._sight, self._agent, self._transparent = sight, agent, transparent

    def geometry(self, actual: int) -> Geometry:
        """Return the blocks of an alternative, prepared for lines of sight."""
        return self._geometry_of[actual]

    @cached_property
    def _geometry_of(self) -> list[Geometry]:
        by_grid: dict[int, Geometry] = {}
        by_codes: dict[bytes, Geometry] = {}
        found = []
        for world in self.worlds:
            key = id(world.blocks)
            if key not in by_grid:
                made = self._sight.geometry(world.blocks, self.box.low)
                by_grid[key] = by_codes.setdefault(made.codes.tobytes(), made)
            found.append(by_grid[key])
        return found

    @cached_property
    def _round(self) -> dict[int, Geometry]:
        sight = _all_round(self._sight)
        return {id(each): Geometry(sight, each.origin, each.codes) for each in self._geometry_of}

    @cached_property
    def has_one_view(self) -> bool:
        """Return True if lines of sight are the same in all alternatives."""
        return len({id(each) for each in self._geometry_of}) == 1

    @cached_property
    def _doubted(self) -> npt.NDArray[np.int64]:
        """Indices of the cells whose blocks differ."""
        first = self.worlds[0].blocks
        others = {id(world.blocks): world.blocks for world in self.worlds}.values()
        differs = np.logical_or.reduce([each != first for each in others])
        return np.argwhere(differs)

    @cached_property
    def _hiding(self) -> npt.NDArray[np.float64]:
        """Middles of the cells whose shapes differ."""
        first = self._geometry_of[0].codes
        others = {id(each): each.codes for each in self._geometry_of}.values()
        differs = np.logical_or.reduce([each != first for each in others])
        cells = np.argwhere(differs[1:-1, 1:-1, 1:-1])
        middles: npt.NDArray[np.float64] = cells + 0.5 + np.array(self.box.low)
        return middles

    @cached_property
    def _middles(self) -> npt.NDArray[np.float64]:
        cells = np.argwhere(np.ones(self.box.shape, dtype=np.bool_))
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
        names = {name for world in self.worlds for name in world.agents} - {self._agent}
        if not self.has_one_view:
            return sorted(names)
        poses = {name: {world.agents.get(name) for world in self.worlds} for name in names}
        return sorted(name for name, known in poses.items() if len(known) > 1)

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
        look: Pose = ((feet[0], feet[1] + EYE_HEIGHT, feet[2]), yaw, pitch)
        if self.has_one_view and not self._doubted_contents and not self._doubted_agents:
            return self._alike_by_blocks(look, all_round)
        percepts: list[object] = self._percepts(look, self._doubted, range(count), all_round)
        by_percept: dict[object, list[int]] = {}
        for number, percept in enumerate(percepts):
            by_percept.setdefault(percept, []).append(number)
        for percept, group in by_percept.items():
            if len({id(self._geometry_of[number]) for number in group}) > 1:
                # Doubted elements look the same in these, but may hide different things.
                behind = self._percepts(look, self._candidates(look[0]), group, all_round)
                for number, further in zip(group, behind, strict=True):
                    percepts[number] = (percept, further)
        return _masks(percepts)

    def _alike_by_blocks(self, look: Pose, all_round: bool) -> list[int]:
        """Return the result of `alike` if only blocks differ, and all of them hide the same."""
        plain = self._geometry_of[0]
        seeing = self._round[id(plain)] if all_round else plain
        seen = seeing.sees_blocks(*look, self._doubted + np.array(self.box.low))
        key = seen.tobytes()
        if key not in self._by_seen:
            cells = tuple(self._doubted[seen].T)
            self._by_seen[key] = _masks([world.blocks[cells].tobytes() for world in self.worlds])
        return self._by_seen[key]

    @cached_property
    def _by_seen(self) -> dict[bytes, list[int]]:
        """Alternatives with the same percept, by which of the differing blocks are seen."""
        return {}

    def _percepts(
        self, look: Pose, cells: npt.NDArray[np.int64], which: Sequence[int], all_round: bool
    ) -> list[object]:
        """Return the percepts of cells, agents and items in some alternatives."""
        seen: dict[int, npt.NDArray[np.bool_]] = {}
        percepts: list[object] = []
        for number in which:
            plain = self._geometry_of[number]
            seeing = self._round[id(plain)] if all_round else plain
            if id(plain) not in seen:
                places = cells + np.array(self.box.low, dtype=np.int64)
                seen[id(plain)] = seeing.sees_blocks(*look, places)
            percepts.append(
                self._percept(self.worlds[number], seeing, look, cells, seen[id(plain)])
            )
        return percepts

    def _candidates(self, eye: Point) -> npt.NDArray[np.int64]:
        """Return the indices of cells whose sight from a place can depend on the alternative."""
        far = self._sight.max_visible_distance
        middles, place = self._middles, np.array(eye)
        wanted = np.zeros(len(middles), dtype=np.bool_)
        away = middles - place
        distance = np.sqrt((away**2).sum(axis=1))
        for hiding in self._hiding - place:
            length = float(np.sqrt((hiding**2).sum()))
            if far is not None and length > far + _SHAPE:
                continue
            if length <= _SHAPE:
                wanted[:] = True
                break
            # Lines from the eye to a cell that come near the hiding one: within two cones.
            with np.errstate(divide="ignore", invalid="ignore"):
                cosine = np.clip(away @ hiding / (distance * length), -1, 1)
            spread = math.asin(_SHAPE / length) + np.arcsin(_CUBE / np.maximum(distance, _CUBE))
            behind = distance >= length - _SHAPE - _CUBE
            wanted |= (behind & (np.arccos(cosine) <= spread)) | (distance <= _CUBE)
        if far is not None:
            wanted &= distance <= far + 1e-6
        found: npt.NDArray[np.int64] = np.argwhere(wanted.reshape(self.box.shape))
        return found

    def _percept(
        self,
        world: World,
        seeing: Geometry,
        look: Pose,
        cells: npt.NDArray[np.int64],
        seen: npt.NDArray[np.bool_],
    ) -> tuple[object, ...]:
        """Return the percept of candidates in an alternative, as a value to compare."""
        states = world.blocks[tuple(cells.T)]
        blocks = np.where(seen & (states >= 0), states, -1).tobytes()
        contents: list[object] = []
        if self._doubted_contents:
            sees = seeing.sees_blocks(*look, np.array(self._doubted_contents, dtype=np.int64))
            contents = [
                (place, _items_key(world.contents.get(place)))
                for place, is_seen in zip(self._doubted_contents, sees.tolist(), strict=True)
                if is_seen
            ]
        names = [name for name in self._doubted_agents if name in world.agents]
        agents: list[object] = []
        if names:
            sees = seeing.sees_agents(*look, [world.agents[name][0] for name in names])
            agents = [
                (name, world.agents[name])
                for name, is_seen in zip(names, sees.tolist(), strict=True)
                if is_seen
            ]
        items = b""
        if self.items and not self.has_one_view:
            places = [item.position for item in self.items.values()]
            items = seeing.sees_points(*look, places).tobytes()
        return blocks, tuple(contents), tuple(agents), items


def _masks(percepts: Sequence[object]) -> list[int]:
    """Return for each percept the numbers of equal ones, as bits."""
    masks: dict[object, int] = {}
    for number, percept in enumerate(percepts):
        masks[percept] = masks.get(percept, 0) | 1 << number
    return [masks[percept] for percept in percepts]


def _items_key(items: Items | None) -> object:
    return None if items is None else tuple(sorted(items.items()))
