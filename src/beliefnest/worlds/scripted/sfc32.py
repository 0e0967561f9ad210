"""Random numbers of programs of the scripted world: sfc32, the generator of the embedded world.

`worlds/minecraft/node/src/time/sfc32.js` is its twin; both return equal numbers.
"""

import hashlib
import struct

_WORD = 0xFFFF_FFFF


class Sfc32:
    """Generator of random numbers.

    Args:
        seed: Text from whose SHA-256 it begins.

    Attributes:
        draws: Number of numbers drawn.
    """

    def __init__(self, seed: str) -> None:
        self.draws = 0
        self.reseed(seed)

    def reseed(self, seed: str) -> None:
        """Begin anew, with another seed."""
        self._words: tuple[int, ...] = struct.unpack(
            "<4I", hashlib.sha256(seed.encode()).digest()[:16]
        )

    def fraction(self) -> float:
        """Return the next number, 0 <= n < 1, with 53 random bits."""
        self.draws += 1
        high, low = self._bits() >> 5, self._bits() >> 6
        return (high * 67_108_864 + low) / 9_007_199_254_740_992

    def _bits(self) -> int:
        a, b, c, d = self._words
        total = (a + b + d) & _WORD
        turned = ((c << 21) | (c >> 11)) & _WORD
        words = (b ^ (b >> 9), c + (c << 3), turned + total, d + 1)
        self._words = tuple(word & _WORD for word in words)
        return total
