"""Small worlds the tests of the nest play in.

The box is 11 x 3 x 11. Its full-height walls lie in the plane x = 5, so that `WEST` and
`EAST` of a closed wall see nothing of each other. Behind a wall with a gap (`CORNER`)
`WEST` and `EAST` do not see each other, and both see what is in `GAP` and `CHEST`.
"""

from collections.abc import Iterable, Mapping

import beliefnest as bn
from beliefnest.world.values import Position

BOX = ((0, 0, 0), (10, 2, 10))
WEST = (2.5, 0.0, 1.5)
EAST = (8.5, 0.0, 1.5)
MEETING = (4.5, 0.0, 9.5)
GAP = (5.5, 0.0, 10.5)
CHEST = (5, 0, 9)


def wall(zs: Iterable[int], x: int = 5, block: str = "stone") -> dict[Position, str]:
    """Return a wall as high as the box, along z."""
    return {(x, y, z): block for y in range(3) for z in zs}


OPEN: dict[Position, str] = {}
CORNER = wall(range(8))
CLOSED = wall(range(11))


def nest_of(
    agents: Mapping[str, tuple[float, float, float]],
    blocks: Mapping[Position, str] = OPEN,
    *,
    chests: Mapping[Position, Mapping[str, int]] | None = None,
    inventories: Mapping[str, Mapping[str, int]] | None = None,
    static_blocks: Iterable[str] = (),
    initial_beliefs: Iterable[bn.InitialBelief] = (),
    **perception: object,
) -> tuple[bn.ScriptedWorld, bn.Nest]:
    """Return a world in `BOX` and its nest; `perception` are options of `bn.Perception`."""
    world = bn.ScriptedWorld(BOX, blocks, agents, inventories=inventories, containers=chests or {})
    nest = bn.Nest(
        world,
        bn.Perception(**perception),  # type: ignore[arg-type]  # options of any type
        static_blocks=static_blocks,
        initial_beliefs=initial_beliefs,
    )
    return world, nest
