"""What all nodes of one nest stand on: the box, its agents, and how they perceive."""

import math
from collections.abc import Collection, Iterable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import numpy.typing as npt

from beliefnest.belief.arrays import HEAR_ALL, HEAR_NEAR, HEAR_SEEN, Senses, Space
from beliefnest.belief.entries import SOURCES, Basis, Source
from beliefnest.perception.options import Perception, Radius
from beliefnest.perception.sight import Sight
from beliefnest.world.registry import Registry
from beliefnest.world.values import Box, EventKind

__all__ = ["BeliefContext"]


@dataclass(frozen=True, eq=False)
class BeliefContext:
    """What does not change in the life of a nest.

    Attributes:
        box: The part of space covered.
        agents: All agents, sorted; arrays count them in this order.
        options: What agents can perceive.
        registry: Names and shapes of blocks.
        sight: How agents see.
    """

    box: Box
    agents: tuple[str, ...]
    options: Perception
    registry: Registry
    sight: Sight
    _tracked: dict[int, None] = field(default_factory=dict)

    @property
    def tracked(self) -> Collection[int]:
        """Cells that ever hold a container in any node, in the order they were found."""
        return self._tracked.keys()

    def track(self, cells: Iterable[int]) -> None:
        """Note cells that hold a container."""
        self._tracked.update(dict.fromkeys(cells))

    @cached_property
    def cells(self) -> int:
        """Number of cells of the box."""
        nx, ny, nz = self.box.shape
        return nx * ny * nz

    @cached_property
    def numbers(self) -> dict[str, int]:
        """Number of each agent."""
        return {name: number for number, name in enumerate(self.agents)}

    @cached_property
    def holds(self) -> npt.NDArray[np.bool_]:
        """By block state, and at the end for unknown, whether it is a container."""
        holds = np.zeros(self.registry.states + 1, dtype=np.bool_)
        for name in self.registry.containers:
            ids = self.registry.state_ids(name)
            holds[ids.start : ids.stop] = True
        return holds

    @cached_property
    def space(self) -> Space:
        """The box and its shapes for the kernel."""
        # Compiled code takes its time to load; who only lists scenarios need not wait.
        from beliefnest.perception import beams, shadows

        tables = self.sight.tables()
        nx, ny, nz = self.box.shape
        return Space(
            (nx + 2, ny + 2, nz + 2),
            tables.starts,
            tables.boxes,
            tables.reaches,
            tables.codes,
            self.holds,
            1.0 - np.array(self.box.low, dtype=np.float64),
            self._senses,
            beams.beam_room(),
            shadows.no_shadows(),
        )

    @cached_property
    def _senses(self) -> Senses:
        """What agents can perceive, for the kernel."""
        options = self.options
        far = options.max_visible_distance
        angle = options.field_of_view
        hearing = {"global": HEAR_ALL, "sight": HEAR_SEEN}.get(str(options.hearing), HEAR_NEAR)
        return Senses(
            math.inf if far is None else float(far),
            -2.0 if angle >= 360 else math.cos(math.radians(angle) / 2),
            hearing,
            options.hearing.blocks if isinstance(options.hearing, Radius) else 0.0,
            options.negative_evidence,
            options.testimony == "informed",
        )

    def basis_code(self, basis: Basis) -> int:
        """The source of a basis as arrays hold it: a row of `SOURCES`, or who was heard."""
        if basis.speaker is not None:
            return len(SOURCES) + self.numbers[basis.speaker]
        return SOURCES.index(basis.source)

    def basis(self, tick: int, code: int) -> Basis:
        """The basis that arrays hold as a tick and a code."""
        if code < len(SOURCES):
            return Basis(tick, SOURCES[code])
        return Basis(tick, Source.HEARD, EventKind.CHAT, self.agents[code - len(SOURCES)])

    def container_name(self, state: int) -> str | None:
        """Name of the container block of a state; None if it is none, or unknown."""
        return self.registry.name(state) if state >= 0 and self.holds[state] else None

    def block_name(self, state: int) -> str | None:
        """Name of the block of a state; None if it is unknown."""
        return None if state < 0 else self.registry.name(state)
