"""The key `terrain` of scenario files: all blocks of a box, compressed.

Files with many more cuboids than people would write have it in place of entries of `blocks`.
"""

import base64
import textwrap
from collections.abc import Sequence
from typing import Any

import numpy as np

from beliefnest.errors import InputError, StoreError
from beliefnest.scenarios.format import TerrainEntry
from beliefnest.world.memory import MEGABYTE, memory_limit
from beliefnest.world.packing import packed, unpacked
from beliefnest.world.registry import Registry
from beliefnest.world.terrain import VOLUME, Terrain

_WIDTH = 96
_LEVEL = 12
"""Level of compression: level 19 takes ten times as long for two thirds of the size."""
_CELL_BYTES = 8
"""Bytes of a cell of a different chunk while the blocks are read."""


def entry_of(blocks: Terrain, registry: Registry) -> dict[str, Any]:
    """Return the content of the key for the blocks of a box."""
    states = np.array(blocks.states)
    numbers = blocks.mapped(lambda chunk: np.searchsorted(states, chunk).clip(0, len(states) - 1))
    return packed_entry(numbers, [registry.text(state) for state in blocks.states])


def packed_entry(numbers: Terrain, states: Sequence[str]) -> dict[str, Any]:
    """Return the content of the key for blocks as numbers of the texts of states."""
    data, chunks = packed(numbers, _LEVEL)
    cells = textwrap.fill(base64.b64encode(data).decode(), _WIDTH)
    return {"states": list(states), "chunks": chunks, "cells": cells + "\n"}


def terrain_in(entry: TerrainEntry, shape: tuple[int, int, int], registry: Registry) -> Terrain:
    """Return the blocks of a box.

    Raises:
        InputError: The entry is damaged, belongs to a box of another shape, or needs too much
            memory.
        UnknownNameError: A block does not exist.
    """
    states = np.array([registry.state_id(text) for text in entry.states], dtype=np.int32)
    return numbers_in(entry, shape).mapped(lambda chunk: states[chunk])


def numbers_in(entry: TerrainEntry, shape: tuple[int, int, int]) -> Terrain:
    """Return the blocks of a box as numbers of the entry's states; InputError as above."""
    needed, limit = entry.chunks * VOLUME * _CELL_BYTES, memory_limit()
    if limit is not None and needed > limit.bytes:
        raise InputError(
            f"its {entry.chunks:,} chunks need {-(-needed // MEGABYTE):,} MB; this process may use "
            f"{limit.bytes // MEGABYTE:,} MB, {limit.source}: capture a smaller place"
        )
    try:
        numbers = unpacked(base64.b64decode(entry.cells), shape, entry.chunks)
    except (ValueError, StoreError) as fault:
        raise InputError(
            f"is damaged, or was captured with another box ({fault}); capture the place again"
        ) from None
    low, high = numbers.span
    if low < 0 or high >= len(entry.states):
        raise InputError(f"names the states {low} to {high}, but there are {len(entry.states)}")
    return numbers
