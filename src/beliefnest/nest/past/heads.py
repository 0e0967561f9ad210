"""Forests at the heads of timelines, as many as memory is meant for.

Branches are cheap to make, and most are never looked at again. Their forests are dropped, the least
recently used first, once all forests together are large. A dropped forest is folded again when
somebody asks for it.
"""

from collections.abc import Callable, ItemsView

from beliefnest.belief.forest import Forest
from beliefnest.timeline.journal import TimelineKey

_BYTES = 128_000_000
"""Bytes that forests may take together."""
_FEW = 8
"""Number of forests that are kept whatever they take."""


class Heads:
    """Forests by timeline, in order of their last use.

    Args:
        on_drop: Function that is called with a timeline and its forest before this is dropped for
            lack of memory.
        most: Bytes that forests may take together, unless they are few; None: `_BYTES`.
    """

    def __init__(
        self, on_drop: Callable[[TimelineKey, Forest], object], most: int | None = None
    ) -> None:
        self._on_drop, self._most = on_drop, _BYTES if most is None else most
        self._forests: dict[TimelineKey, Forest] = {}
        self._bytes: dict[TimelineKey, int] = {}
        self._latest: TimelineKey | None = None

    def get(self, key: TimelineKey) -> Forest | None:
        """Return the forest of a timeline; None if there is none."""
        forest = self._forests.get(key)
        if forest is not None and key != self._latest:
            self._use(key, forest)
        return forest

    def put(self, key: TimelineKey, forest: Forest) -> None:
        """Keep the forest of a timeline. Drop others if all together are too large."""
        self._use(key, forest)
        while len(self._forests) > _FEW and sum(self._bytes.values()) > self._most:
            oldest = next(iter(self._forests))
            self._on_drop(oldest, self._forests[oldest])
            self.pop(oldest)

    def items(self) -> ItemsView[TimelineKey, Forest]:
        """Return timelines and their forests."""
        return self._forests.items()

    def pop(self, key: TimelineKey) -> None:
        """Forget the forest of a timeline, if there is one."""
        self._forests.pop(key, None)
        self._bytes.pop(key, None)

    def clear(self) -> None:
        """Forget all forests."""
        self._forests.clear()
        self._bytes.clear()

    def _use(self, key: TimelineKey, forest: Forest) -> None:
        latest = self._latest
        if latest is not None and latest in self._forests:
            # It may have grown while it was used.
            self._bytes[latest] = self._forests[latest].bytes
        self._forests.pop(key, None)
        self._forests[key], self._bytes[key] = forest, forest.bytes
        self._latest = key
