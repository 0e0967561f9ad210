"""Table of what each block state is to a body: room, floor, liquid, ladder or doorway.

The table is computed from the game's collision shapes (`world.registry`). `geometry.steps` has the
rules of steps between cells. Both say what bots do in Minecraft: they follow the rules of
mineflayer-pathfinder (MIT), by which bots plan, and `tests/worlds/test_geometry.py` compares them
with walks of real bots for all shapes.

A code of a state is a sum of the bits below, with the height of its shape above them. Some blocks
are both room and floor: a body steps into a ladder or a thin layer, or onto it.
"""

import itertools
from enum import Enum
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from beliefnest.world.doors import is_doorway, is_open, moves_by_hand, passage
from beliefnest.world.registry import Registry

BodyCodes = npt.NDArray[np.uint32]


class Doorways(Enum):
    """Doors and gates that count as doorways; the others are walls."""

    NONE = "none"
    """None with a leaf: bots look for another way first, since a leaf stops them easily."""
    OPEN = "open"
    BY_HAND = "by hand"
    """Open ones, and shut ones that open by hand."""


ROOM = 1
"""A body moves through the block."""
FLOOR = 2
"""The block holds a body up."""
LIQUID = 4
LADDER = 8
UNKNOWN = 16
"""The block is not known: room at the height of a body, floor below it."""
ALONG_X, ALONG_Z = 32, 64
"""Directions in which a body passes through a door or gate."""
OPENS = 128
"""The door or gate is shut and opens by hand: it takes an act to pass."""
UPPER = 256
"""The block is the upper half of a door, in which there is room for a head only."""
SIDES = ((1, 0, 512), (0, 1, 1024), (-1, 0, 2048), (0, -1, 4096))
"""Sides on which the plate of a ladder is: change of x and z, and the bit."""
TOP_SHIFT = 16
"""Position of the bits with the height of a shape."""
FULL = 64
"""Height of a full block, in the unit of heights."""

HARMFUL = frozenset(
    {"lava", "fire", "soul_fire", "magma_block", "cactus", "campfire", "soul_campfire"}
)
"""Blocks that hurt; no body is placed beside them."""

_LADDERS = frozenset({"ladder"})
_LIQUIDS = frozenset({"water", "lava"})
_AVOIDED = frozenset({"lava", "fire", "cobweb"})
"""Blocks without a shape into which bots do not walk."""
_LAYER = 0.1
"""Height below which a block is a layer on the floor, such as a carpet."""


@lru_cache(maxsize=8)
def body_codes(registry: Registry, doors: Doorways, *, guesses: bool) -> BodyCodes:
    """Return the codes of all states, counted from -1: unknown, then the states of the registry.

    Args:
        registry: Names and shapes of states.
        doors: The doorways.
        guesses: True if an unknown block counts as floor; False: only known blocks hold a body.
    """
    boxes = [
        registry.shape_boxes[start:end]
        for start, end in itertools.pairwise(registry.shape_start.tolist())
    ]
    tops = np.array([max((box[4] for box in part), default=0.0) for part in boxes])
    is_empty = np.array([len(part) == 0 for part in boxes])[registry.state_shape]
    heights = np.round(np.maximum(tops, 0.0)[registry.state_shape] * FULL).astype(np.uint32)
    codes = (heights << TOP_SHIFT).astype(np.uint32)
    for name in registry.block_names:
        ids = registry.state_ids(name)
        codes[ids.start : ids.stop] |= _kind(registry, name)
        if is_doorway(name):
            for state in ids:
                codes[state] |= _doorway(registry, state, doors)
        if name in _LADDERS:
            for state in ids:
                codes[state] |= _plate(registry, state)
    # Bots take these for obstacles, but there is nothing to stand on.
    phantoms = is_empty & (codes & FLOOR != 0)
    codes[phantoms] ^= np.uint32(FLOOR)
    codes[phantoms & (codes & (ALONG_X | ALONG_Z) == 0)] |= np.uint32(ALONG_X | ALONG_Z)
    unknown = ROOM | ((UNKNOWN | FULL << TOP_SHIFT) if guesses else 0)
    all_codes = np.concatenate([np.array([unknown], dtype=np.uint32), codes])
    all_codes.flags.writeable = False
    return all_codes


def _kind(registry: Registry, name: str) -> int:
    """Return the bits that all states of a block share.

    Bots judge a kind of block by its first state.
    """
    boxes = registry.boxes(registry.state_ids(name).start)
    height = boxes[0][4] if boxes else 0.0
    solid = registry.is_solid(name)
    ladder = name in _LADDERS
    room = (not solid or ladder or (bool(boxes) and height < _LAYER)) and name not in _AVOIDED
    floor = solid and height <= 1
    bits = (ROOM if room else 0) | (FLOOR if floor else 0) | (LADDER if ladder else 0)
    return bits | (LIQUID if name in _LIQUIDS else 0)


def _doorway(registry: Registry, state: int, doors: Doorways) -> int:
    if doors is Doorways.NONE and registry.boxes(state):
        return 0
    way = ALONG_X if passage(registry, state) == (1, 0) else ALONG_Z
    if registry.properties(state).get("half") == "upper":
        way |= UPPER
    if is_open(registry, state):
        return way
    by_hand = doors is Doorways.BY_HAND and moves_by_hand(registry.name(state))
    return way | OPENS if by_hand else 0


def _plate(registry: Registry, state: int) -> int:
    """Return the bit of the side on which a ladder's plate is."""
    ((x0, _, z0, x1, _, z1),) = registry.boxes(state)
    middle = (x0 + x1 - 1, z0 + z1 - 1)
    return next(bit for dx, dz, bit in SIDES if middle[0] * dx + middle[1] * dz > 0)
