"""Terrain: block states of a box, in chunks that several terrains share.

A box of up to `DENSE` cells is one chunk of its own shape. A larger one is cut into cubes of
`SIDE` cells. The cubes begin one cell before the box, so that they are also those of a grid of
shape codes with its margin (`perception.codes`); cells of a cube outside the box have no meaning.

An index is a tuple of cell numbers along x, y, z, counted from the lower corner of the box. Values
are block state ids; -1 is unknown.
"""

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from hashlib import blake2b
from itertools import product
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

SIDE = 8
"""Number of cells along an edge of a chunk, a power of 2."""
VOLUME = SIDE**3
"""Number of cells of a chunk."""

DENSE = 1 << 16
"""Greatest number of cells of a box that is one chunk."""

ChunkCounts = tuple[int, int, int]
"""Numbers of chunks along x, y, z."""

Index = tuple[int, int, int]

BlockStates = npt.NDArray[np.int32]
"""Block state ids along x, y, z."""

Layers = tuple[npt.NDArray[np.intp], npt.NDArray[np.intp], npt.NDArray[np.intp]]
"""Numbers of layers along x, y, z, each in order."""

Counts = Callable[[BlockStates, BlockStates], npt.NDArray[np.bool_]]
StateChange = Callable[[BlockStates, BlockStates], npt.NDArray[np.signedinteger[Any]]]

MARGIN = 1
"""Number of cells that chunks have before and behind the box on every side."""

_SPARE = 256
_MOST_LISTED = 1 << 16


def chunks_of(sizes: tuple[int, int, int]) -> ChunkCounts:
    """Return the numbers of chunks of a grid of these sizes, its margin included."""
    x, y, z = sizes
    return -(-x // SIDE), -(-y // SIDE), -(-z // SIDE)


@dataclass(frozen=True)
class Lattice:
    """Chunks of a box by number, z fastest.

    Attributes:
        shape: Shape of the box.
        is_one: True if the box is one chunk.
    """

    shape: tuple[int, int, int]
    is_one: bool

    @classmethod
    def of(cls, shape: tuple[int, int, int]) -> "Lattice":
        """Return the division of a box of this shape."""
        x, y, z = shape
        return cls(shape, x * y * z <= DENSE)

    @cached_property
    def counts(self) -> ChunkCounts:
        """Numbers of chunks along x, y, z."""
        if self.is_one:
            return (1, 1, 1)
        x, y, z = self.shape
        return chunks_of((x + 2 * MARGIN, y + 2 * MARGIN, z + 2 * MARGIN))

    def slot(self, index: Index) -> tuple[int, Index]:
        """Return the number of a cell's chunk and the cell's index in the chunk."""
        if self.is_one:
            return 0, index
        i, j, k = (part + MARGIN for part in index)
        _, ny, nz = self.counts
        number = ((i // SIDE) * ny + j // SIDE) * nz + k // SIDE
        return number, (i % SIDE, j % SIDE, k % SIDE)

    def start(self, number: int) -> Index:
        """Return the index of the first cell of a chunk, which may lie in the margin."""
        if self.is_one:
            return (0, 0, 0)
        _, ny, nz = self.counts
        i, j, k = number // (ny * nz), number // nz % ny, number % nz
        return i * SIDE - MARGIN, j * SIDE - MARGIN, k * SIDE - MARGIN

    def starts(self, numbers: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
        """Return the indices (n, 3) of the first cells of some chunks of a box in chunks."""
        return np.stack(np.unravel_index(numbers, self.counts), axis=1) * SIDE - MARGIN

    def within(
        self, x: tuple[int, int], y: tuple[int, int], z: tuple[int, int]
    ) -> npt.NDArray[np.int64]:
        """Return the numbers of the chunks with some cells of a box in chunks, in order.

        Args:
            x: Index of the first cell along x, and the index after the last one.
            y: The same along y.
            z: The same along z.
        """
        low, high = (x[0], y[0], z[0]), (x[1], y[1], z[1])
        axes = [
            np.array([number for number, _, _ in axis], dtype=np.int64)
            for axis in self.ranges(low, high)
        ]
        numbers = np.meshgrid(*axes, indexing="ij")
        return np.ravel_multi_index([each.reshape(-1) for each in numbers], self.counts)

    def ranges(self, low: Index, high: Index) -> list[list[tuple[int, int, int]]]:
        """Return by axis the chunks with cells from `low` to before `high`.

        Each is the number of the chunk along the axis, its first cell, and the cell after its last.
        """
        if self.is_one:
            return [[(0, a, b)] if a < b else [] for a, b in zip(low, high, strict=True)]
        ranges = []
        for a, b in zip(low, high, strict=True):
            first, last = a + MARGIN, b + MARGIN
            numbers = range(first // SIDE, -(-last // SIDE)) if a < b else range(0)
            ranges.append(
                [(n, max(first - n * SIDE, 0), min(last - n * SIDE, SIDE)) for n in numbers]
            )
        return ranges

    def around(self, cells: npt.NDArray[np.intp]) -> npt.NDArray[np.intp]:
        """Return the numbers of the chunks, margins included, that hold cells or touch them."""
        steps = np.array([(0, 0, 0), *np.eye(3, dtype=int), *-np.eye(3, dtype=int)])
        near = (cells[:, None] + steps + MARGIN).reshape(-1, 3) // SIDE
        return np.unique(np.ravel_multi_index(tuple(near.T), self.counts))

    def clipped(self, cells: npt.NDArray[np.intp]) -> npt.NDArray[np.intp]:
        """Return those of some indices (n, 3) that lie in the box, in order."""
        inside = ((cells >= 0) & (cells < np.array(self.shape))).all(axis=1)
        cells = cells[inside]
        return cells[np.lexsort(cells.T[::-1])]


class Slabs(Protocol):
    """Grid of block states that computes slabs along x when they are asked for."""

    @property
    def shape(self) -> tuple[int, int, int]:
        """Shape of the grid."""

    def __getitem__(self, layers: slice, /) -> npt.NDArray[np.signedinteger[Any]]:
        """Return the states of some layers along x."""


class Terrain:
    """Block states of a box; it never changes.

    Args:
        shape: Shape of the box.
        rows: By chunk, its place in `chunks`; int32 (number of chunks,).
        chunks: Block states of the chunks, int32, read-only.
    """

    def __init__(
        self,
        shape: tuple[int, int, int],
        rows: npt.NDArray[np.int32],
        chunks: Sequence[BlockStates],
    ) -> None:
        self.shape = shape
        self.rows, self.chunks = rows, chunks
        # A tiny box that is cut into chunks lies in one of them, which is larger.
        self.lattice = Lattice(shape, len(rows) == 1 and chunks[0].shape == shape)

    @classmethod
    def full(cls, shape: tuple[int, int, int], state: int) -> "Terrain":
        """Return the terrain of a box filled with one block state."""
        lattice = Lattice.of(shape)
        size = shape if lattice.is_one else (SIDE, SIDE, SIDE)
        chunk = np.full(size, state, dtype=np.int32)
        chunk.setflags(write=False)
        return cls(shape, np.zeros(int(np.prod(lattice.counts)), dtype=np.int32), [chunk])

    @classmethod
    def of(cls, grid: "npt.NDArray[np.signedinteger[Any]] | Slabs") -> "Terrain":
        """Return the terrain of a grid of states (nx, ny, nz); it is read in slabs along x."""
        nx, ny, nz = grid.shape
        lattice = Lattice.of((nx, ny, nz))
        if lattice.is_one:
            chunk = np.array(grid[:nx], dtype=np.int32, order="C")
            chunk.setflags(write=False)
            return cls(lattice.shape, np.zeros(1, dtype=np.int32), [chunk])
        numbers: dict[bytes, int] = {}
        chunks: list[BlockStates] = []
        rows: list[int] = []
        for layer in _layers(lattice, grid):
            for cube in layer:
                row = numbers.setdefault(cube.tobytes(), len(chunks))
                if row == len(chunks):
                    chunk = cube.reshape(SIDE, SIDE, SIDE).copy()
                    chunk.setflags(write=False)
                    chunks.append(chunk)
                rows.append(row)
        return cls(lattice.shape, np.array(rows, dtype=np.int32), chunks)

    @classmethod
    def of_cubes(
        cls, shape: tuple[int, int, int], rows: npt.NDArray[np.int32], states: BlockStates
    ) -> "Terrain":
        """Return the terrain of a box that is cut into cubes, also if it would be one chunk.

        Args:
            shape: Shape of the box.
            rows: By chunk of `Lattice(shape, is_one=False)`, the number of its cube.
            states: States of the cubes, one cube after the other; they must not change any more.

        Raises:
            ValueError: The cubes do not fill the box.
        """
        places = int(np.prod(Lattice(shape, is_one=False).counts))
        if len(rows) != places or len(states) % VOLUME:
            raise ValueError(f"{len(rows)} cubes do not fill a box with {places} places for them")
        if rows.min() < 0 or rows.max() >= len(states) // VOLUME:
            raise ValueError("some places name cubes that are not there")
        states.setflags(write=False)
        terrain = cls(shape, rows, list(states.reshape(-1, SIDE, SIDE, SIDE)))
        return cls.of(terrain.dense()) if Lattice.of(shape).is_one else terrain

    @classmethod
    def of_one(cls, grid: BlockStates) -> "Terrain":
        """Return the terrain of a dense grid as one chunk; the grid must not change any more."""
        nx, ny, nz = grid.shape
        return cls((nx, ny, nz), np.zeros(1, dtype=np.int32), [grid])

    @property
    def size(self) -> int:
        """Number of cells of the box."""
        x, y, z = self.shape
        return x * y * z

    @property
    def is_dense(self) -> bool:
        """True if the box is one chunk."""
        return self.lattice.is_one

    def __getitem__(self, index: Index) -> int:
        number, within = self.lattice.slot(index)
        return int(self.chunks[self.rows[number]][within])

    def cut(self, low: Index, high: Index) -> BlockStates:
        """Return the states of the cells from index `low` to before `high`, read-only.

        A terrain of one chunk returns a view.
        """
        if self.is_dense:
            return self.chunks[0][low[0] : high[0], low[1] : high[1], low[2] : high[2]]
        x, y, z = (max(b - a, 0) for a, b in zip(low, high, strict=True))
        states = np.empty((x, y, z), dtype=np.int32)
        _, ny, nz = self.lattice.counts
        shift = [MARGIN + part for part in low]
        for (i, a, b), (j, c, d), (k, e, f) in product(*self.lattice.ranges(low, high)):
            at = (i * SIDE - shift[0], j * SIDE - shift[1], k * SIDE - shift[2])
            states[at[0] + a : at[0] + b, at[1] + c : at[1] + d, at[2] + e : at[2] + f] = (
                self.chunks[self.rows[(i * ny + j) * nz + k]][a:b, c:d, e:f]
            )
        states.setflags(write=False)
        return states

    def at(self, cells: npt.NDArray[np.integer[Any]]) -> BlockStates:
        """Return the states of the cells with some numbers (n,), counted as in a dense array."""
        states: BlockStates
        if self.is_dense:
            states = self.chunks[0].reshape(-1)[cells]
            return states
        (_, ny, nz), (_, high, deep) = self.shape, self.lattice.counts
        i, j, k = (
            part.astype(np.int64) + MARGIN
            for part in (cells // (ny * nz), cells // nz % ny, cells % nz)
        )
        rows = self.rows[(i // SIDE * high + j // SIDE) * deep + k // SIDE]
        used, places = np.unique(rows, return_inverse=True)
        chunks = np.array([self.chunks[row] for row in used.tolist()], dtype=np.int32)
        states = chunks.reshape(-1, SIDE, SIDE, SIDE)[
            places.reshape(-1), i % SIDE, j % SIDE, k % SIDE
        ]
        return states

    def at_indices(self, cells: npt.NDArray[np.integer[Any]]) -> BlockStates:
        """Return the states of the cells with some indices (n, 3)."""
        return self.at(np.ravel_multi_index(tuple(cells.T), self.shape))

    def slabs(self) -> Iterator[tuple[int, BlockStates]]:
        """Yield the box in parts along x: number of the first layer, and states of the layers."""
        _, y, z = self.shape
        for number, first, last in self.lattice.ranges((0, 0, 0), self.shape)[0]:
            start = self._begin(number)
            yield start + first, self.cut((start + first, 0, 0), (start + last, y, z))

    def sampled(self, layers: Layers) -> BlockStates:
        """Return the states of the cells that lie in one of some layers along each axis."""
        x, y, z = layers
        states = np.empty((len(x), len(y), len(z)), dtype=np.int32)
        for first, part in self.slabs():
            wanted = np.flatnonzero((x >= first) & (x < first + len(part)))
            states[wanted] = part[np.ix_(x[wanted] - first, y, z)]
        return states

    @cached_property
    def borders(self) -> Layers:
        """The layers along x, y, z that differ from the layer before; the first one is there."""
        changed = [np.zeros(size, dtype=np.bool_) for size in self.shape]
        counts = self.lattice.counts
        # Numbers of the first and of the last layer of each chunk along each axis; equal ones are
        # equal layers.
        sides = np.full((3, 2, int(np.prod(counts))), -1, dtype=np.int64)
        numbers: dict[bytes, int] = {}
        for chunk, places, inside in self.kinds():
            at = np.unravel_index(places, counts)
            for axis in range(3):
                part = np.moveaxis(chunk[inside], axis, 0)
                layers = part.reshape(len(part), -1)
                differs = (layers[1:] != layers[:-1]).any(axis=1)
                for number in np.unique(at[axis]).tolist():
                    first = self._begin(number) + inside[axis].start
                    changed[axis][first + 1 : first + len(layers)] |= differs
                for side in (0, 1):
                    layer = layers[-side].tobytes()
                    sides[axis, side, places] = numbers.setdefault(layer, len(numbers))
        for axis, parts in enumerate(self.lattice.ranges((0, 0, 0), self.shape)):
            first, last = (np.moveaxis(each.reshape(counts), axis, 0) for each in sides[axis])
            for number, start, _ in parts:
                differ = number == 0 or (first[number] != last[number - 1]).any()
                changed[axis][self._begin(number) + start] = differ
        x, y, z = (np.flatnonzero(each) for each in changed)
        return x, y, z

    def _begin(self, number: int) -> int:
        """Return the layer of the box at which the chunks of a number along an axis begin."""
        return 0 if self.is_dense else number * SIDE - MARGIN

    def dense(self) -> BlockStates:
        """Return the states of all cells, read-only; takes 4 bytes for each cell of the box."""
        return self.chunks[0] if self.is_dense else self.cut((0, 0, 0), self.shape)

    def __array__(
        self, dtype: npt.DTypeLike | None = None, copy: bool | None = None
    ) -> npt.NDArray[Any]:
        if dtype is None and not copy:
            return self.dense()
        return np.array(self.dense(), dtype=dtype)

    @cached_property
    def span(self) -> tuple[int, int]:
        """The least and the greatest state that occurs."""
        parts = [chunk[inside] for chunk, _, inside in self.kinds()]
        return int(min(part.min() for part in parts)), int(max(part.max() for part in parts))

    @cached_property
    def states(self) -> tuple[int, ...]:
        """The block states that occur, in order."""
        states: set[int] = set()
        for chunk, _, inside in self.kinds():
            states.update(np.unique(chunk[inside]).tolist())
        return tuple(sorted(states))

    def kinds(
        self,
    ) -> Iterator[tuple[BlockStates, npt.NDArray[np.int64], tuple[slice, slice, slice]]]:
        """Yield each different chunk once, with the numbers of its places and its cells in the box.

        A chunk whose places at the edge of the box differ is yielded for each kind of place.
        """
        spans = self.lattice.ranges((0, 0, 0), self.shape)
        rows = self.rows.reshape(self.lattice.counts).astype(np.int64)
        codes = [
            {span: code for code, span in enumerate(sorted({(a, b) for _, a, b in axis}))}
            for axis in spans
        ]
        parts = [
            np.array([codes[axis][a, b] for _, a, b in spans[axis]], dtype=np.int64)
            for axis in range(3)
        ]
        # The last chunk along an axis may lie in the margin alone.
        x, y, z = map(len, parts)
        key = rows[:x, :y, :z]
        for axis, part in enumerate(parts):
            form = [1, 1, 1]
            form[axis] = -1
            key = key * len(codes[axis]) + part.reshape(form)
        order = np.argsort(key, axis=None, kind="stable")
        _, firsts = np.unique(key.reshape(-1)[order], return_index=True)
        _, ny, nz = self.lattice.counts
        for members in np.split(order, firsts[1:]):
            i, j, k = members // (y * z), members // z % y, members % z
            inside = [slice(*spans[axis][int(at[0])][1:]) for axis, at in enumerate((i, j, k))]
            chunk = self.chunks[rows[i[0], j[0], k[0]]]
            yield chunk, (i * ny + j) * nz + k, (inside[0], inside[1], inside[2])

    def canonical(self) -> "Terrain":
        """Return the equal terrain that depends on the states in the box alone.

        Its chunks all differ, are in the order of their first places, and are 0 outside the box.
        """
        if self.is_dense:
            return self
        x, y, z = self.lattice.counts
        kinds, insides = self._edge_kinds()
        keys = (self.rows.reshape(x, y, z) * np.int64(len(insides)) + kinds).reshape(-1)
        firsts = np.full(len(self.chunks) * len(insides), -1, dtype=np.int64)
        # Of several values written to an element, the last one stays: that of the first place.
        firsts[keys[::-1]] = np.arange(len(keys))[::-1]
        present = np.flatnonzero(firsts >= 0)
        numbers = np.zeros(len(firsts), dtype=np.int32)
        new_numbers: dict[bytes, int] = {}
        chunks: list[BlockStates] = []
        for key in present[np.argsort(firsts[present])].tolist():
            row, kind = divmod(key, len(insides))
            chunk = np.zeros((SIDE, SIDE, SIDE), dtype=np.int32)
            chunk[insides[kind]] = self.chunks[row][insides[kind]]
            numbers[key] = new_numbers.setdefault(chunk.tobytes(), len(chunks))
            if numbers[key] == len(chunks):
                chunk.setflags(write=False)
                chunks.append(chunk)
        return Terrain(self.shape, numbers[keys], chunks)

    def _edge_kinds(self) -> tuple[npt.NDArray[np.int64], list[tuple[slice, slice, slice]]]:
        """Return for each place the kind of its cells in the box, and the cells of each kind.

        The kinds are of the shape of `Lattice.counts`.
        """
        kinds = np.zeros((1, 1, 1), dtype=np.int64)
        axes: list[list[tuple[int, int]]] = []
        for axis, parts in enumerate(self.lattice.ranges((0, 0, 0), self.shape)):
            # The last chunk along an axis may lie in the margin alone.
            spans = [(0, 0)] * self.lattice.counts[axis]
            for number, first, last in parts:
                spans[number] = (first, last)
            axes.append(sorted(set(spans)))
            form = [1, 1, 1]
            form[axis] = -1
            codes = np.array([axes[axis].index(span) for span in spans], dtype=np.int64)
            kinds = kinds * len(axes[axis]) + codes.reshape(form)
        insides = [(slice(*a), slice(*b), slice(*c)) for a, b, c in product(*axes)]
        return kinds, insides

    @cached_property
    def key(self) -> bytes:
        """Bytes that are equal for equal terrains of one box, and differ for others.

        They are the states of a terrain of one chunk, and otherwise a digest.
        """
        if self.is_dense:
            return self.chunks[0].tobytes()
        plain = self.canonical()
        digest = blake2b(plain.rows.tobytes(), digest_size=32)
        for chunk in plain.chunks:
            digest.update(chunk.tobytes())
        return digest.digest()

    def count(self, states: Collection[int]) -> int:
        """Return the number of cells with one of some states."""
        wanted = list(states)
        counts = [np.isin(chunk[part], wanted).sum() * len(at) for chunk, at, part in self.kinds()]
        return int(sum(counts))

    def find(self, states: Collection[int]) -> npt.NDArray[np.intp]:
        """Return the indices (n, 3) of the cells with one of some states, in order."""
        wanted = np.array([*states], dtype=np.int64)
        if self.is_dense:
            return np.argwhere(np.isin(self.chunks[0], wanted, kind="table"))
        masks: npt.NDArray[np.bool_] = np.isin(np.stack(self.chunks), wanted, kind="table")
        offsets = [np.empty((0, 3), dtype=np.intp)]
        has = masks.reshape(len(masks), -1).any(axis=1)
        for number in np.flatnonzero(np.asarray(has)[self.rows]).tolist():
            cells = np.argwhere(masks[self.rows[number]])
            offsets.append(cells + np.array(self.lattice.start(number)))
        return self.lattice.clipped(np.concatenate(offsets))

    def differing(self, other: "Terrain", counts: Counts | None = None) -> npt.NDArray[np.intp]:
        """Return the indices (n, 3) of the cells in which another terrain of the box differs.

        Args:
            other: The other terrain.
            counts: Function of states of this and of the other terrain that returns a mask of the
                cells that count; None: all count.
        """
        if self.is_dense is not other.is_dense:
            raise AssertionError("the terrains are cut differently")
        mine, theirs = (
            np.array([id(chunk) for chunk in each.chunks], dtype=np.int64)[each.rows]
            for each in (self, other)
        )
        offsets = [np.empty((0, 3), dtype=np.intp)]
        numbers = np.flatnonzero(mine != theirs)
        if not len(numbers):
            return offsets[0]
        # Many places have the same pair of chunks, which are compared once.
        pairs = self.rows[numbers].astype(np.int64) * len(other.chunks) + other.rows[numbers]
        each, places = _distinct(pairs, len(self.chunks) * len(other.chunks))
        apart = []
        for pair in each.tolist():
            own, its = (
                self.chunks[pair // len(other.chunks)],
                other.chunks[pair % len(other.chunks)],
            )
            mask = own != its
            apart.append(np.argwhere(mask if counts is None else mask & counts(own, its)))
        differs = np.array([len(cells) > 0 for cells in apart], dtype=np.bool_)
        for at in np.flatnonzero(differs[places]).tolist():
            start = self.lattice.start(int(numbers[at]))
            offsets.append(apart[places[at]] + np.array(start))
        return self.lattice.clipped(np.concatenate(offsets))

    def mapped(
        self, change: Callable[[BlockStates], npt.NDArray[np.signedinteger[Any]]]
    ) -> "Terrain":
        """Return the terrain after a change of each cell that depends on its state alone.

        The two share the chunks that stay as they are.
        """
        chunks = []
        for chunk in self.chunks:
            changed = change(chunk).astype(np.int32, copy=False)
            changed.setflags(write=False)
            chunks.append(chunk if np.array_equal(changed, chunk) else changed)
        if all(a is b for a, b in zip(chunks, self.chunks, strict=True)):
            return self
        return Terrain(self.shape, self.rows, chunks)

    def joined(self, other: "Terrain", change: StateChange) -> "Terrain":
        """Return the terrain with states that depend on those of the cell here and in another."""
        if self.is_dense is not other.is_dense:
            raise AssertionError("the terrains are cut differently")
        count = len(other.chunks)
        # Many places have the same pair of chunks, which are joined once.
        pairs = self.rows.astype(np.int64) * count + other.rows
        each, places = _distinct(pairs, len(self.chunks) * count)
        chunks = []
        for pair in each.tolist():
            made = change(self.chunks[pair // count], other.chunks[pair % count])
            made = made.astype(np.int32, copy=False)
            made.setflags(write=False)
            chunks.append(made)
        return Terrain(self.shape, places.astype(np.int32), chunks)

    def draft(self) -> "Draft":
        """Return a copy that can be changed."""
        return Draft(self)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Terrain):
            return NotImplemented
        return self.shape == other.shape and len(self.differing(other)) == 0

    __hash__ = None  # type: ignore[assignment]  # compared by value, and values are large

    def __repr__(self) -> str:
        return f"<terrain of {' x '.join(map(str, self.shape))} blocks>"


class Draft:
    """Terrain that can be changed; it copies a chunk of its terrain before a change in it."""

    def __init__(self, terrain: Terrain) -> None:
        self._terrain = terrain
        self._lattice = terrain.lattice
        self._rows, self._chunks = terrain.rows, list(terrain.chunks)
        self._own: set[int] = set()
        self._is_shared = True
        self._kept = len(self._chunks)

    @property
    def shape(self) -> tuple[int, int, int]:
        """Shape of the box."""
        return self._lattice.shape

    def __getitem__(self, index: Index) -> int:
        number, within = self._lattice.slot(index)
        return int(self._chunks[self._rows[number]][within])

    def __setitem__(self, index: Index, state: int) -> None:
        number, within = self._lattice.slot(index)
        row = int(self._rows[number])
        if row not in self._own:
            row = self._add(self._chunks[row].copy())
            self._own.add(row)
            self._write_rows()[number] = row
        self._chunks[row][within] = state

    def fill(self, low: Index, high: Index, state: int) -> None:
        """Set the cells from index `low` to before `high`."""
        _, ny, nz = self._lattice.counts
        self._compact()
        rows = self._write_rows()
        made: dict[tuple[int, ...], int] = {}
        for (i, a, b), (j, c, d), (k, e, f) in product(*self._lattice.ranges(low, high)):
            number = (i * ny + j) * nz + k
            # Equal parts of equal chunks stay one chunk.
            part = (int(rows[number]), a, b, c, d, e, f)
            if part not in made:
                chunk = self._chunks[part[0]].copy()
                chunk[a:b, c:d, e:f] = state
                chunk.setflags(write=False)
                self._own.discard(part[0] if self._lattice.is_one else -1)
                made[part] = self._add(chunk)
            rows[number] = made[part]

    def terrain(self) -> Terrain:
        """Return the terrain as it is now; later changes of the draft do not change it."""
        if self._own or not self._is_shared:
            for row in self._own:
                self._chunks[row].setflags(write=False)
            self._compact()
            self._terrain = Terrain(self.shape, self._rows, tuple(self._chunks))
            self._own.clear()
            self._is_shared = True
        return self._terrain

    def _add(self, chunk: BlockStates) -> int:
        if self._lattice.is_one:
            self._chunks = [chunk]
            return 0
        self._chunks.append(chunk)
        return len(self._chunks) - 1

    def _compact(self) -> None:
        """Drop the chunks that no place uses, if there may be many."""
        if len(self._chunks) <= 2 * self._kept + _SPARE:
            return
        used, rows = np.unique(self._rows, return_inverse=True)
        self._rows, self._is_shared = rows.reshape(-1).astype(np.int32), False
        self._own = {new for new, old in enumerate(used.tolist()) if old in self._own}
        self._chunks = [self._chunks[row] for row in used.tolist()]
        self._kept = len(self._chunks)

    def _write_rows(self) -> npt.NDArray[np.int32]:
        if self._is_shared:
            self._rows, self._is_shared = self._rows.copy(), False
        return self._rows


def _distinct(
    numbers: npt.NDArray[np.int64], end: int
) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]:
    """Return the different ones of some numbers below `end`, sorted, and the index of each."""
    if end > _MOST_LISTED + 8 * len(numbers):
        distinct, places = np.unique(numbers, return_inverse=True)
        return distinct, places.reshape(-1)
    # Faster than sorting.
    occurs = np.zeros(end, dtype=np.bool_)
    occurs[numbers] = True
    distinct = np.flatnonzero(occurs)
    table = np.empty(end, dtype=np.int64)
    table[distinct] = np.arange(len(distinct))
    return distinct, table[numbers]


def _layers(
    lattice: Lattice, grid: npt.NDArray[np.signedinteger[Any]] | Slabs
) -> Iterator[npt.NDArray[np.int32]]:
    """Yield the chunks of each layer along x as rows of `VOLUME` states."""
    (nx, ny, nz), (count, high, deep) = lattice.shape, lattice.counts
    for layer in range(count):
        cells = np.zeros((SIDE, high * SIDE, deep * SIDE), dtype=np.int32)
        first = layer * SIDE - MARGIN
        begin, end = max(first, 0), min(first + SIDE, nx)
        if begin < end:
            inner = cells[begin - first : end - first, MARGIN:, MARGIN:]
            inner[:, :ny, :nz] = grid[begin:end]
        cubes = cells.reshape(SIDE, high, SIDE, deep, SIDE).transpose(1, 3, 0, 2, 4)
        yield cubes.reshape(-1, VOLUME)
