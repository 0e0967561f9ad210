"""Record of the events of a timeline that each node perceived."""

import numpy as np
import numpy.typing as npt


class PerceivedEventTable:
    """Bit table of perceived events: one row for each event, one bit for each node of a forest."""

    def __init__(self) -> None:
        self._bits = np.zeros((64, 1), dtype=np.uint8)

    def note(self, first: int, perceived: npt.NDArray[np.bool_]) -> None:
        """Store `perceived`, bool (events, nodes), for the events from number `first` on."""
        count, nodes = perceived.shape
        self._widen(first + count, nodes)
        packed = np.packbits(perceived, axis=1)
        self._bits[first : first + count, : packed.shape[1]] = packed

    def set(self, node: int, first: int, perceived: npt.NDArray[np.bool_]) -> None:
        """Store for one node which events it perceived, from number `first` on."""
        self._widen(first + len(perceived), node + 1)
        column = self._bits[first : first + len(perceived), node >> 3]
        bit = np.uint8(128 >> (node & 7))
        column &= ~bit
        column |= perceived.astype(np.uint8) * bit

    def of(self, node: int, count: int, first: int = 0) -> npt.NDArray[np.bool_]:
        """Return which events a node perceived, from number `first` to before `count`."""
        perceived = np.zeros(max(0, count - first), dtype=np.bool_)
        if node >> 3 < self._bits.shape[1]:
            noted = self._bits[first:count, node >> 3]
            perceived[: len(noted)] = (noted & np.uint8(128 >> (node & 7))) > 0
        return perceived

    def _widen(self, events: int, nodes: int) -> None:
        height, width = self._bits.shape
        needed = -(-nodes // 8)
        if events > height or needed > width:
            size = (max(height, 2 * events if events > height else 0), max(width, needed))
            grown = np.zeros(size, dtype=np.uint8)
            grown[:height, :width] = self._bits
            self._bits = grown
