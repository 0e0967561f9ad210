"""Findings of an inference: effects of evidence, impossible evidence, sampled courses."""

from collections.abc import Mapping
from typing import Any

import msgspec

from beliefnest.world.values import Position


class Impossible(msgspec.Struct, frozen=True):
    """The first piece of evidence that no hypothesis explains.

    Attributes:
        tick: Tick of the evidence.
        text: Action of the agent in words, with cells.
        why: The reason.
    """

    tick: int
    text: str
    why: str

    def __str__(self) -> str:
        return f"tick {self.tick}: the agent {self.text}, which no hypothesis explains: {self.why}"


class SampledPath(msgspec.Struct, frozen=True):
    """A course that agrees with the evidence.

    Attributes:
        hypothesis: Values of the factors that explain it, with their probability.
        cells: Cell of the agent by tick, at every tick from the first to the last with evidence.
    """

    hypothesis: Mapping[str, Any]
    cells: Mapping[int, Position]


class EvidenceEffect(msgspec.Struct, frozen=True):
    """Effect of one piece of evidence on the marginals.

    Attributes:
        tick: Tick of the evidence.
        text: The evidence in words.
        bits: By factor, the divergence of its marginal after the step from that before
            (Kullback and Leibler), in bits.
        is_action: True if the agent acted: it moved, stayed, opened a container or acted on a goal,
            in sight or not. False: it only perceived something.
        is_movement: True if the agent was seen to change its cell.
    """

    tick: int
    text: str
    bits: Mapping[str, float]
    is_action: bool = False
    is_movement: bool = False

    def __str__(self) -> str:
        # Rounded as told: last bits, which differ between machines, must not decide the order.
        effects = sorted(self.bits.items(), key=lambda pair: -round(pair[1], 2))
        words = ", ".join(f"{name} by {bits:.2f} bits" for name, bits in effects if bits >= 0.005)
        return f"tick {self.tick}: the agent {self.text}; this changes {words or 'nothing'}"
