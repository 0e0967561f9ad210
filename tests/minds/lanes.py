"""Floors with walls, and agents who walk on them."""

import beliefnest as bn

STONE = "stone"


def lane(length, depth=1, walls=(), marks=None, agents=None, **further):
    """Return a floor with walls two high; `marks` are blocks of the floor."""
    blocks = {(x, 0, z): STONE for x in range(length) for z in range(depth)}
    for x, z in walls:
        blocks[x, 1, z] = blocks[x, 2, z] = STONE
    for (x, z), block in (marks or {}).items():
        blocks[x, 0, z] = block
    feet = {name: (x + 0.5, 1, z + 0.5) for name, (x, z) in (agents or {"bob": (0, 0)}).items()}
    return bn.ScriptedWorld(((0, 0, 0), (length - 1, 3, depth - 1)), blocks, feet, **further)


def walk(world, *cells, agent="bob"):
    for x, z in cells:
        world.place_agent(agent, (x + 0.5, 1, z + 0.5))
