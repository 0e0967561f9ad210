"""Cache of first perceptions, for scenes that begin alike.

Nodes that are new perceive once with nothing happening. The conditions and repeats of a scenario
often begin with the same scene, so the result is kept by a digest of everything it depends on. The
kernel is deterministic and reads nothing else, so the same input gives the same output. Shapes of
blocks are not part of the digest: each cache belongs to one set of shapes (`perception.sight`).
"""

import hashlib
from collections.abc import Sequence
from threading import Lock
from typing import Any

import msgspec
import numpy as np
import numpy.typing as npt

from beliefnest.belief.arrays import Changes, EntryFacts, Nodes, Poses, Space, Span, Weighing

_MOST_BYTES = 16 << 20
"""Bytes that the cache holds at most; the oldest results are dropped first."""
_LARGEST = 1 << 20
"""Bytes of node arrays above which nothing is cached: the digest would cost more than it saves."""

_Array = npt.NDArray[Any]


class _Seen(msgspec.Struct, frozen=True):
    """Result of a first perception: the nodes' arrays, and rows of changes."""

    nodes: Sequence[_Array]
    rows: _Array

    @property
    def bytes(self) -> int:
        return sum(each.nbytes for each in (*self.nodes, self.rows))


class FirstPerceptions:
    """Cached first perceptions of nests with the same shapes of blocks."""

    def __init__(self) -> None:
        self._seen: dict[bytes, _Seen] = {}
        self._bytes = 0
        self._turn = Lock()

    def keeps(self, nodes: Nodes, weighing: Weighing | None) -> bool:
        """Return True if the scene is small enough to be kept."""
        arrays: Sequence[_Array] = (*nodes, *(weighing or ()))
        return sum(each.nbytes for each in arrays) <= _LARGEST

    def perceive(
        self,
        space: Space,
        poses: Poses,
        facts: EntryFacts,
        nodes: Nodes,
        weighing: Weighing | None,
        changes: Changes,
        below: npt.NDArray[np.bool_],
    ) -> None:
        """Let the nodes that `below` marks perceive, as `kernel.fold` of an entry without events.

        The nodes hold dense arrays. Arrays of `nodes` and `weighing` and rows of `changes` are
        written in place.
        """
        from beliefnest.belief import kernel  # loads compiled code, which listing does not need

        arrays: Sequence[_Array] = (*nodes, *(weighing or ()))
        span = Span(0, 1, False, 0)
        key = _digest(space, (*poses, facts.tick, *arrays, below))
        seen = self._seen.get(key)
        if seen is None:
            kernel.fold(space, poses, facts, nodes, weighing, changes, span, below, None)
            rows = changes.rows[: changes.used[0]].copy()
            self._keep(key, _Seen([each.copy() for each in arrays], rows))
            return
        for row, kept in zip(arrays, seen.nodes, strict=True):
            np.copyto(row, kept)
        changes.used[0] = len(seen.rows)
        changes.rows[: len(seen.rows)] = seen.rows

    def _keep(self, key: bytes, seen: _Seen) -> None:
        with self._turn:
            if key in self._seen:
                return
            self._seen[key] = seen
            self._bytes += seen.bytes
            while self._bytes > _MOST_BYTES:
                self._bytes -= self._seen.pop(next(iter(self._seen))).bytes


def _digest(space: Space, arrays: Sequence[_Array]) -> bytes:
    """Return a digest of all that a perception depends on but the shapes of blocks.

    Shapes and types of the arrays are part of it, so that equal bytes of unequal arrays differ.
    """
    hashed = hashlib.blake2b(digest_size=16)
    plain = (space.sizes, tuple(space.senses), [(each.shape, each.dtype.str) for each in arrays])
    hashed.update(repr(plain).encode())
    for each in (space.origin, *arrays):
        hashed.update(np.ascontiguousarray(each).data)
    return hashed.digest()
