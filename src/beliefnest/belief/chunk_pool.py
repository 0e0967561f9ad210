"""Pool of the chunks of all nodes of a table, for boxes in which nodes hold no dense arrays."""

from collections.abc import Sequence
from typing import Any

import msgspec
import numpy as np
import numpy.typing as npt

from beliefnest.belief.arrays import UNKNOWN
from beliefnest.perception.codes import EMPTY, Reaches, code_grid
from beliefnest.perception.sight import ChunkGeometry, Sight, SightLines
from beliefnest.world.array_types import Codes, Ints, States
from beliefnest.world.terrain import SIDE, VOLUME, Terrain, chunks_of
from beliefnest.world.values import Position

Blocks = npt.NDArray[np.signedinteger[Any]]


class CutGrids(msgspec.Struct, frozen=True):
    """Grids of the box cut into chunks, each different chunk once.

    Attributes:
        blocks: int16 (n, VOLUME), numbers of blocks of each chunk.
        codes: uint16 (n, VOLUME), their geometry.
        rows: For each grid, the index of each of its chunks.
    """

    blocks: States
    codes: Codes
    rows: Sequence[Ints]


NOTHING = 0
"""Row of the chunk of which nothing is known. The pool itself counts as one of its users."""


class ChunkPool:
    """Blocks and codes of chunks, each chunk a row; `perception.chunks` describes their order.

    Equal chunks of several nodes are one row as long as nobody changes them.

    Args:
        shape: Shape of the box.

    Attributes:
        blocks: int16 (rows, VOLUME), numbers of blocks.
        codes: uint16 (rows, VOLUME), their geometry.
        shares: int32 (rows,), see `arrays.Nodes`.
        spare: int32 (rows + 2,), see `arrays.Nodes`.
    """

    def __init__(self, shape: tuple[int, int, int]) -> None:
        self._shape = shape
        x, y, z = shape
        self.chunks = chunks_of((x + 2, y + 2, z + 2))
        self.count = int(np.prod(self.chunks))
        self.blocks: States = np.full((1, VOLUME), UNKNOWN, dtype=np.int16)
        self.codes: Codes = np.zeros((1, VOLUME), dtype=np.uint16)
        self.shares: Ints = np.ones(1, dtype=np.int32)
        self.spare: Ints = np.array([0, 1, 0], dtype=np.int32)

    @property
    def used(self) -> int:
        """Number of rows that are or were in use."""
        return int(self.spare[1])

    def copy(self) -> "ChunkPool":
        """Return an independent copy, without room for more rows."""
        made, used = ChunkPool(self._shape), int(self.spare[1])
        made.blocks, made.codes = self.blocks[:used].copy(), self.codes[:used].copy()
        made.shares, made.spare = self.shares[:used].copy(), self.spare[: used + 2].copy()
        return made

    @property
    def bytes(self) -> int:
        """Memory of the chunks, without the room for more."""
        chunk: int = self.blocks[0].nbytes + self.codes[0].nbytes
        return int(self.spare[1]) * chunk

    def reserve(self, rows: int) -> bool:
        """Make room for some more rows; return True if the arrays are new ones then."""
        used, size = int(self.spare[1]), len(self.shares)
        if int(self.spare[0]) + size - used >= rows:
            return False
        # The system gives memory to pages when they are written, so spare rows cost nothing.
        wanted = used + used // 2 + 2 * rows
        self.blocks = _longer(self.blocks, used, wanted)
        self.codes = _longer(self.codes, used, wanted)
        self.shares = _longer(self.shares, used, wanted)
        self.spare = _longer(self.spare, len(self.spare), wanted + 2)
        return True

    def use(self, rows: Ints) -> None:
        """Count one more user of each row, for each time that it is listed."""
        counts = np.bincount(rows)
        self.shares[: len(counts)] += counts

    def leave(self, rows: Ints) -> None:
        """Count one user less of each row, for each time that it is listed; free unused ones."""
        counts = np.bincount(rows)
        shares = self.shares[: len(counts)]
        shares -= counts
        free = np.flatnonzero((counts > 0) & (shares == 0))
        count = int(self.spare[0])
        self.spare[2 + count : 2 + count + len(free)] = free
        self.spare[0] += len(free)

    def add(self, blocks: States, codes: Codes) -> Ints:
        """Add chunks, shape (n, VOLUME), that nobody uses yet, and return their rows."""
        self.reserve(len(blocks))
        # Rows that were freed are left to the kernel.
        first = int(self.spare[1])
        if first + len(blocks) > len(self.shares):
            self.reserve(int(self.spare[0]) + len(self.shares) - first + len(blocks))
        rows = np.arange(first, first + len(blocks), dtype=np.int32)
        self.blocks[rows], self.codes[rows], self.shares[rows] = blocks, codes, 0
        self.spare[1] += len(blocks)
        return rows

    def add_grids(self, cut: CutGrids) -> Sequence[Ints]:
        """Add the chunks of some grids, and return the rows of each grid.

        The caller counts as a user of them, and calls `leave` for each grid.
        """
        added = self.add(cut.blocks, cut.codes)
        grids = [added[rows] for rows in cut.rows]
        for rows in grids:
            self.use(rows)
        return grids

    def terrain(self, rows: Ints) -> Terrain:
        """Return the numbers of the blocks of a grid, as they are now."""
        used, numbers = self._used(rows)
        chunks = self.blocks[used].astype(np.int32).reshape(-1, SIDE, SIDE, SIDE)
        chunks.setflags(write=False)
        return Terrain(self._shape, numbers, list(chunks))

    def codes_of(self, rows: Ints) -> tuple[Codes, Ints]:
        """Return the codes of a grid's chunks, as they are now, and for each place its chunk."""
        used, numbers = self._used(rows)
        return self.codes[used], numbers

    def _used(self, rows: Ints) -> tuple[npt.NDArray[np.intp], Ints]:
        """Return the different rows of a grid, and for each place the index of its row in them."""
        is_used = np.zeros(self.used, dtype=np.bool_)
        is_used[rows] = True
        used = np.flatnonzero(is_used)
        numbers = np.empty(self.used, dtype=np.int32)
        numbers[used] = np.arange(len(used))
        return used, numbers[rows]


def lines_of_sight(sight: Sight, origin: Position, blocks: Terrain) -> SightLines:
    """Prepare block states for looks; `origin` is the position of the lower corner of the box."""
    if blocks.is_dense:
        return sight.geometry(blocks.dense(), origin)
    cut = cut_grids(sight.state_codes, sight.reaches, (blocks,))
    return ChunkGeometry(sight, origin, blocks.shape, cut.codes, cut.rows[0])


def changed_lines(lines: SightLines, blocks: Terrain, cells: npt.NDArray[np.int64]) -> SightLines:
    """Prepare block states that differ from those of `lines` in some cells (n, 3) at most."""
    sight = lines.sight
    if not isinstance(lines, ChunkGeometry):
        return lines_of_sight(sight, lines.origin, blocks)
    places = blocks.lattice.around(cells)
    made = [
        _with_neighbours(sight.state_codes, sight.reaches, blocks, place)[1].reshape(1, VOLUME)
        for place in places.tolist()
    ]
    rows = lines.rows.copy()
    rows[places] = len(lines.codes) + np.arange(len(places), dtype=np.int32)
    codes = np.concatenate([lines.codes, *made])
    return ChunkGeometry(sight, lines.origin, lines.shape, codes, rows)


def cut_grids(shape_codes: Codes, reaches: Reaches, grids: Sequence[Terrain]) -> CutGrids:
    """Cut grids of block numbers of the box into chunks, and compute their geometry.

    Args:
        shape_codes: Code of each number; the last entry is for unknown.
        reaches: Sides at which the shape of each code reaches out of its cell.
        grids: The grids.
    """
    numbers: dict[bytes, int] = {}
    kept: list[bytes] = []
    rows: list[Ints] = []
    for grid in grids:
        rows.append(_cut(shape_codes, reaches, grid, numbers, kept))
    size = VOLUME * np.dtype(np.int16).itemsize
    both = np.frombuffer(b"".join(kept), dtype=np.uint8).reshape(len(kept), 2 * size)
    blocks, codes = both[:, :size].copy(), both[:, size:].copy()
    return CutGrids(blocks.view(np.int16), codes.view(np.uint16), rows)


def _cut(
    shape_codes: Codes, reaches: Reaches, grid: Terrain, ids: dict[bytes, int], kept: list[bytes]
) -> Ints:
    """Return the numbers of the chunks of a grid, and add new ones to `known` and `kept`."""

    def number_of(blocks: States, codes: Codes) -> int:
        content = blocks.tobytes() + codes.tobytes()
        number = ids.setdefault(content, len(kept))
        if number == len(kept):
            kept.append(content)
        return number

    empty = np.full((SIDE, SIDE, SIDE), UNKNOWN, dtype=np.int16)
    rows = np.full(len(grid.rows), number_of(empty, _empty_codes()), dtype=np.int32)
    for chunk, places, inside in grid.kinds():
        blocks, codes = empty.copy(), _empty_codes()
        blocks[inside] = chunk[inside]
        codes[inside] = shape_codes[chunk[inside]]
        rows[places] = number_of(blocks, codes)
    # Shapes of some blocks reach into neighbouring cells, and so into neighbouring chunks.
    reaching = [state for state in grid.states if reaches[shape_codes[state]]]
    for place in grid.lattice.around(grid.find(reaching)).tolist() if reaching else ():
        rows[place] = number_of(*_with_neighbours(shape_codes, reaches, grid, place))
    return rows


def _empty_codes() -> Codes:
    """Return the codes of a chunk without shapes."""
    return np.full((SIDE, SIDE, SIDE), EMPTY, dtype=np.uint16)


def _with_neighbours(
    shape_codes: Codes, reaches: Reaches, grid: Terrain, place: int
) -> tuple[States, Codes]:
    """Return the blocks of a chunk, and their geometry with what reaches in from around it."""
    start = grid.lattice.start(place)
    low = [max(at - 1, 0) for at in start]
    high = [min(at + SIDE + 1, size) for at, size in zip(start, grid.shape, strict=True)]
    near = grid.cut((low[0], low[1], low[2]), (high[0], high[1], high[2]))
    wide = np.full([SIDE + 4] * 3, EMPTY, dtype=np.uint16)
    # A code grid has a margin of one cell.
    wide[tuple(slice(a - s + 1, b - s + 3) for a, b, s in zip(low, high, start, strict=True))] = (
        code_grid(near, shape_codes, reaches)
    )
    cells_around = np.full([SIDE + 2] * 3, UNKNOWN, dtype=np.int16)
    cells_around[
        tuple(slice(a - s + 1, b - s + 1) for a, b, s in zip(low, high, start, strict=True))
    ] = near
    return cells_around[1:-1, 1:-1, 1:-1], wide[2:-2, 2:-2, 2:-2]


def _longer(array: npt.NDArray[Any], used: int, size: int) -> npt.NDArray[Any]:
    longer = np.empty((size, *array.shape[1:]), dtype=array.dtype)
    longer[:used] = array[:used]
    return longer
