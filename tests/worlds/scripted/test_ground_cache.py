"""Blocks that programs of the scripted world read, in boxes of one chunk and of several."""

import numpy as np
import pytest

from beliefnest.world.registry import Registry
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import Box
from beliefnest.worlds.scripted.engines import Engines
from beliefnest.worlds.scripted.ground_cache import Grounds
from beliefnest.worlds.scripted.javascript_program import JavaScriptProgram

LOW = (-3, 60, 5)
READ_ALL = """
const read = []
for (let x = -4; x <= 38; x += 1) {
  for (let y = 59; y <= 110; y += 1) {
    for (let z = 4; z <= 50; z += 3) {
      const block = bot.blockAt(new Vec3(x, y, z))
      read.push(block && block.name + (block.getProperties().powered ?? ''))
    }
  }
}
let digest = 7
const text = JSON.stringify(read)
for (const letter of text) digest = (digest * 31 + letter.charCodeAt(0)) % 1000000007
console.log(digest)
"""


def grid_of(seed: int) -> np.ndarray:
    """Return levers, stone, unknown blocks and air, mostly air."""
    registry = Registry.load()
    lever = registry.state_id("lever[powered=true]")
    kinds = [0, 0, 0, registry.state_id("stone"), registry.state_id("lever"), lever, -1]
    chance = np.random.default_rng(seed)
    grid = np.zeros((40, 50, 44), dtype=np.int32)
    grid[:, :20] = chance.choice(kinds, (40, 20, 44))
    return grid


def box_of(grid: np.ndarray) -> Box:
    """Return the box of a grid."""
    x, y, z = (a + size - 1 for a, size in zip(LOW, grid.shape, strict=True))
    return Box(LOW, (x, y, z))


def read_by_a_program(text: str) -> str:
    """Return what a program reads of all blocks and some cells beside the box."""
    program = JavaScriptProgram("anna", [], READ_ALL, "seed", Engines())
    program.see({"agents": {}, "signs": {}, "ms": 0}, text)
    program.start()
    assert program.fault is None
    return program.log[0]


@pytest.mark.parametrize("seed", range(3))
def test_programs_read_the_same_blocks_of_chunks_as_of_one_grid(seed: int) -> None:
    grid = grid_of(seed)
    box, chunked = box_of(grid), Terrain.of(grid)
    assert not chunked.is_dense
    grounds = Grounds()
    texts = grounds.of(box, Terrain.of_one(grid)).text, grounds.of(box, chunked).text
    assert texts[0] != texts[1]
    assert read_by_a_program(texts[0]) == read_by_a_program(texts[1])
    draft = chunked.draft()
    draft[6, 7, 8] = Registry.load().state_id("glass")
    changed = grounds.of(box, draft.terrain()).text
    assert read_by_a_program(changed) != read_by_a_program(texts[1])


def test_the_text_of_a_large_box_follows_what_is_in_it() -> None:
    box = Box((0, 0, 0), (999, 99, 999))
    draft = Terrain.full(box.shape, 0).draft()
    draft.fill((0, 0, 0), (1000, 1, 1000), 1)
    blocks = draft.terrain()
    grounds = Grounds()
    assert len(grounds.of(box, blocks).text) < 1_000_000
    assert grounds.of(box, blocks) is grounds.of(box, blocks)


def test_small_boxes_with_equal_blocks_share_their_data() -> None:
    grid = grid_of(0)[:20, :20, :20]
    box, grounds = box_of(grid), Grounds()
    first, second = Terrain.of(grid), Terrain.of(grid)
    assert grounds.of(box, first) is grounds.of(box, second)
    assert grounds.of(box, first) is grounds.of(box, Terrain.of_one(np.ascontiguousarray(grid)))
