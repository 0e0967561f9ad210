"""Terrain as compressed bytes, for files.

The bytes hold 32-bit integers, little endian, compressed by Zstandard: of a terrain of one chunk
the states of all cells, x slowest and z fastest; of others the number of the chunk at each place,
and then the states of each different chunk (see `world.terrain`).
"""

import math

import numpy as np

from beliefnest.world.compression import compressed, decompressed
from beliefnest.world.terrain import VOLUME, Lattice, Terrain


def packed(terrain: Terrain, level: int) -> tuple[bytes, int]:
    """Return the bytes of a terrain, and the number of its different chunks; 0: it is one chunk.

    Args:
        terrain: The terrain; equal ones have equal bytes.
        level: Level of compression, 1 to 22.
    """
    plain = terrain.canonical()
    parts = [chunk.ravel() for chunk in plain.chunks]
    numbers = np.concatenate(parts if plain.is_dense else [plain.rows, *parts])
    data = compressed(numbers.astype("<i4").tobytes(), level)
    return data, 0 if plain.is_dense else len(plain.chunks)


def unpacked(data: bytes, shape: tuple[int, int, int], chunks: int) -> Terrain:
    """Return the terrain in some bytes.

    Args:
        data: The bytes.
        shape: Shape of its box.
        chunks: Number of its different chunks; 0: it is one chunk.

    Raises:
        StoreError: The bytes are damaged.
        ValueError: They hold no such terrain.
    """
    places = math.prod(Lattice(shape, is_one=False).counts)
    size = 4 * (places + chunks * VOLUME if chunks else math.prod(shape))
    if not 0 <= chunks <= places or len(body := decompressed(data, size)) != size:
        raise ValueError(f"{len(data)} bytes with {chunks} chunks do not fill {shape}")
    numbers = np.frombuffer(body, "<i4").astype(np.int32)
    if not chunks:
        return Terrain.of(numbers.reshape(shape))
    return Terrain.of_cubes(shape, numbers[:places], numbers[places:])
