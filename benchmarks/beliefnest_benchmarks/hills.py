"""Hills with houses and many agents that walk about: a world that is large to look at."""

import math
import random

import numpy as np
import numpy.typing as npt

from beliefnest.world.frames import BlockGrid, Snapshot
from beliefnest.world.registry import Registry
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import AgentState, Box, Point, Position
from beliefnest.worlds.scripted.world import ScriptedWorld

__all__ = ["LARGE", "Hills"]

LARGE = (200, 64, 200)
"""Width, height and depth of the world that the page and pictures must show fluently."""

_STEP = 0.2158
"""Blocks a player walks in one tick."""
_HOUSE = (9, 5, 7)
"""Width, height and depth of a house, walls included."""
_EDGE = 14
"""Least distance in blocks between the middle of a house and the edge of the world."""
_POND = 0.28
"""Height of the water, as a share of the height of the world."""


class Hills:
    """Hills of stone and dirt, ponds, houses with a door and a chest, and agents.

    A quarter of the agents begins at each of four houses. They walk along the ground, turn at
    random and stop at what is steep. Now and then one opens a chest, uses a door or says
    something. The same arguments give the same world and the same course.

    Args:
        shape: Width, height and depth of the world in blocks.
        agents: Number of agents.
        houses: Number of houses.
    """

    def __init__(
        self, shape: tuple[int, int, int] = LARGE, agents: int = 16, houses: int = 12
    ) -> None:
        self._chance = random.Random(agents)
        self._shape = shape
        self._ground = _heights(shape)
        middles = self._middles(houses)
        self._blocks = self._landscape()
        self.doors: list[Position] = []
        self.chests: list[Position] = []
        for middle in middles:
            self._build(middle)
        self._yaws = {f"agent{n}": self._chance.uniform(-math.pi, math.pi) for n in range(agents)}
        self._feet = {
            name: self._start(middles[number % min(4, len(middles))])
            for number, name in enumerate(self._yaws)
        }
        poses = {name: AgentState(self._feet[name], yaw) for name, yaw in self._yaws.items()}
        width, height, depth = shape
        box = Box((0, 0, 0), (width - 1, height - 1, depth - 1))
        chests = {place: {"apple": 1 + n} for n, place in enumerate(self.chests)}
        self.world = ScriptedWorld.from_snapshot(
            Snapshot(0, box, Terrain.of(self._blocks), chests, poses)
        )

    def tick(self) -> None:
        """Let all agents take a step, and sometimes act."""
        with self.world.tick():
            for name in self._yaws:
                self._walk(name)
            if self._chance.random() < 0.2:
                self._act(self._chance.choice(sorted(self._yaws)))

    def _middles(self, houses: int) -> list[tuple[int, int]]:
        """Choose columns for houses, in rows and evenly spread, and flatten the ground there."""
        width, _, depth = self._shape
        across = math.ceil(math.sqrt(houses))
        found = []
        for number in range(houses):
            share = [(at + 0.5) / across for at in (number % across, number // across)]
            x = round(_EDGE + share[0] * (width - 2 * _EDGE)) + self._chance.randint(-3, 3)
            z = round(_EDGE + share[1] * (depth - 2 * _EDGE)) + self._chance.randint(-3, 3)
            yard = (slice(x - 8, x + 9), slice(z - 8, z + 9))
            pond = round(_POND * self._shape[1])
            self._ground[yard] = max(pond + 1, int(np.median(self._ground[yard])))
            found.append((x, z))
        return found

    def _landscape(self) -> BlockGrid:
        state = Registry.load().state_id
        width, height, depth = self._shape
        level = np.arange(height)[None, :, None]
        ground = self._ground[:, None, :]
        blocks = np.full((width, height, depth), state("air"), dtype=np.int32)
        blocks[level <= ground] = state("dirt")
        blocks[level < ground - 2] = state("stone")
        blocks[(level == ground) & (ground > round(_POND * height))] = state("grass_block")
        blocks[(level > ground) & (level <= round(_POND * height))] = state("water")
        return blocks

    def _build(self, middle: tuple[int, int]) -> None:
        """Build a house around a column: walls with windows, a door, a roof, a chest."""
        state = Registry.load().state_id
        wide, high, deep = _HOUSE
        x, z = middle[0] - wide // 2, middle[1] - deep // 2
        y = int(self._ground[middle]) + 1
        blocks = self._blocks
        blocks[x : x + wide, y : y + high, z : z + deep] = state("oak_planks")
        blocks[x + 1 : x + wide - 1, y : y + high - 1, z + 1 : z + deep - 1] = state("air")
        blocks[x : x + wide : wide - 1, y + 1, z + 2 : z + deep - 2] = state("glass")
        blocks[x : x + wide, y + high, z : z + deep] = state("cobblestone_slab")
        door = (x + wide // 2, y, z + deep - 1)
        for half, at in (("lower", y), ("upper", y + 1)):
            blocks[door[0], at, door[2]] = state(f"oak_door[half={half},facing=south]")
        chest = (x + 2, y, z + 2)
        blocks[chest] = state("chest")
        blocks[x + wide - 3, y, z + 2] = state("crafting_table")
        self.doors.append(door)
        self.chests.append(chest)

    def _start(self, middle: tuple[int, int]) -> Point:
        x, z = middle[0] + self._chance.uniform(-6, 6), middle[1] + self._chance.uniform(4.6, 7.5)
        return x, float(self._ground[int(x), int(z)] + 1), z

    def _walk(self, name: str) -> None:
        x, y, z = self._feet[name]
        yaw = self._yaws[name]
        to = (x - math.sin(yaw) * _STEP, z - math.cos(yaw) * _STEP)
        if self._is_free(to, y) and self._chance.random() > 0.01:
            level = float(self._ground[int(to[0]), int(to[1])] + 1)
            self._feet[name] = (to[0], level, to[1])
        else:
            self._yaws[name] = self._chance.uniform(-math.pi, math.pi)
        self.world.place_agent(name, self._feet[name], self._yaws[name])

    def _is_free(self, to: tuple[float, float], y: float) -> bool:
        width, _, depth = self._shape
        if not (1 < to[0] < width - 1 and 1 < to[1] < depth - 1):
            return False
        column = int(to[0]), int(to[1])
        level = int(self._ground[column]) + 1
        air = Registry.load().air
        body = self._blocks[column[0], level : level + 2, column[1]]
        return abs(level - y) <= 1 and bool((body == air).all())

    def _act(self, name: str) -> None:
        deed = self._chance.random()
        if deed < 0.4:
            self.world.say(name, "Look at the hills.")
        elif deed < 0.7:
            self.world.open(name, self._chance.choice(self.chests))
        else:
            door = self._chance.choice(self.doors)
            is_open = "open=true" in self.world.block_text(door)
            self.world.use_door(name, door, open=not is_open)


def _heights(shape: tuple[int, int, int]) -> npt.NDArray[np.int64]:
    """Return the height of the ground by column: waves of several lengths, added up."""
    width, height, depth = shape
    x, z = np.mgrid[:width, :depth].astype(np.float64)
    waves = (
        np.sin(x / 31 + 0.6) * np.cos(z / 27 + 0.2)
        + 0.5 * np.sin(x / 13 + z / 17)
        + 0.25 * np.sin(x / 5.3 - z / 7.1)
    )
    share = 0.38 + 0.2 * waves / 1.75
    ground: npt.NDArray[np.int64] = np.clip(share * height, 2, height - 9).astype(np.int64)
    return ground
