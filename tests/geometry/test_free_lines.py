"""Free lines for hands: the scripted world's rule is that of the embedded world's server."""

import itertools
import json
import subprocess
from pathlib import Path
from random import Random

import beliefnest
from beliefnest.geometry.free_lines import can_touch, can_use
from beliefnest.world.registry import Registry
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import Box
from beliefnest.worlds.minecraft.node_files import node_path

SIGHT = Path(beliefnest.__file__).parent / "skills" / "code" / "lib" / "sight.js"
SHAPES = ("stone", "glass", "oak_fence", "stone_slab[type=bottom]", "oak_door[open=true]", "lever")
PROGRAM = """
const { sees } = require(process.argv[1])
const scenes = JSON.parse(require('fs').readFileSync(0, 'utf8'))
console.log(JSON.stringify(scenes.map(({ shapes, eye, block }) => {
  const [ex, ey, ez] = eye, [x, y, z] = block
  return sees((...cell) => shapes[cell.join()] ?? [], { x: ex, y: ey, z: ez }, { x, y, z })
})))
"""


def test_a_hand_touches_what_the_servers_rule_lets_it_touch() -> None:
    registry, random = Registry.load(), Random(0)
    states = [registry.state_id(name) for name in SHAPES]
    box = Box((-3, -1, 4), (3, 3, 10))
    cells = list(
        itertools.product(*(range(a, b + 1) for a, b in zip(box.low, box.high, strict=True)))
    )
    scenes, found, easy = [], [], []
    for _ in range(400):
        there = {
            cell: random.choice(states)
            for cell in cells
            if random.random() < random.choice((0.1, 0.3, 0.6))
        }
        grid = Terrain.full(box.shape, 0).draft()
        for cell, state in there.items():
            grid[box.index(cell)] = state
        blocks = grid.terrain()
        block = random.choice(cells)
        eye = tuple(random.uniform(a, b + 1) for a, b in zip(box.low, box.high, strict=True))
        found.append(can_touch(box, blocks, eye, block))
        easy.append(can_use(box, blocks, eye, block))
        shapes = {",".join(map(str, cell)): registry.boxes(state) for cell, state in there.items()}
        scenes.append({"shapes": shapes, "eye": eye, "block": block})
    told = subprocess.run(
        [node_path(), "-e", PROGRAM, str(SIGHT)],
        input=json.dumps(scenes),
        capture_output=True,
        text=True,
        check=True,
    )
    assert found == json.loads(told.stdout)
    assert {True, False} == set(found)
    # Whatever is easy to use can be touched.
    assert all(touches for touches, uses in zip(found, easy, strict=True) if uses)
    assert sum(easy) < sum(found)


def test_unknown_blocks_obstruct_nothing() -> None:
    box = Box((0, 0, 0), (4, 3, 0))
    eye, block = (0.5, 1.6, 0.5), (4, 1, 0)
    for state, is_free in ((-1, True), (0, True), (Registry.load().state_id("glass"), False)):
        blocks = Terrain.full(box.shape, state)
        assert can_use(box, blocks, eye, block) is is_free
        assert can_touch(box, blocks, eye, block) is is_free
