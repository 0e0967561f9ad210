"""What all nodes of one nest stand on: the box, its agents, and how they perceive."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from beliefnest.belief.arrays import HEAR_ALL, HEAR_NEAR, HEAR_SEEN, NOBODY, Senses, Space
from beliefnest.belief.entries import SOURCES, Basis, Source
from beliefnest.belief.first_perceptions import FirstPerceptions
from beliefnest.errors import InputError
from beliefnest.perception.options import Perception, Radius
from beliefnest.perception.sight import Sight
from beliefnest.world.claims import Claim, claims_from_plain
from beliefnest.world.frames import BlockGrid
from beliefnest.world.registry import Registry
from beliefnest.world.signs import block_words, is_sign, plain_state
from beliefnest.world.values import Block, Box, EventKind, Position, Sign

__all__ = ["BeliefContext", "SavedWriting"]

_NUMBERS = 2**15 - 1
"""Numbers of blocks that arrays have room for: states, then signs with texts."""


Writing = tuple[Sign, tuple[Claim, ...]]
"""A sign that is written on, and what is claimed on it."""

SavedWriting = tuple[Sign, tuple[Mapping[str, Any], ...]]
"""A `Writing` as plain data."""


@dataclass(frozen=True, eq=False)
class BeliefContext:
    """What does not change in the life of a nest.

    Attributes:
        box: The part of space covered.
        agents: All agents, sorted; arrays count them in this order.
        options: What agents can perceive.
        registry: Names and shapes of blocks.
        sight: How agents see.
        first_perceptions: Of that sight, in this nest and others.
        unique: Items of which everybody knows that there is one (semantics, section 3).
    """

    box: Box
    agents: tuple[str, ...]
    options: Perception
    registry: Registry
    sight: Sight
    first_perceptions: FirstPerceptions = field(default_factory=FirstPerceptions)
    unique: tuple[str, ...] = ()
    _tracked: dict[int, None] = field(default_factory=dict)
    _signs: dict[Writing, int] = field(default_factory=dict)
    _sign_cells: dict[int, None] = field(default_factory=dict)

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
        """By block number, and at the end for unknown, whether it is a container."""
        holds = np.zeros(_NUMBERS + 1, dtype=np.bool_)
        for name in self.registry.containers:
            ids = self.registry.state_ids(name)
            holds[ids.start : ids.stop] = True
        return holds

    @cached_property
    def space(self) -> Space:
        """The box and its shapes for the kernel."""
        # Compiled code takes its time to load; who only lists scenarios need not wait.
        from beliefnest.perception import beams, shadows

        sight, registry = self.sight, self.registry
        codes = np.empty(_NUMBERS + 1, dtype=np.uint16)
        codes[: registry.states], codes[-1] = sight.state_codes[:-1], sight.state_codes[-1]
        for (sign, _), number in self._signs.items():
            codes[number] = codes[sign.state]
        nx, ny, nz = self.box.shape
        return Space(
            (nx + 2, ny + 2, nz + 2),
            registry.shape_start,
            registry.shape_boxes,
            sight.reaches,
            codes,
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
        cos_half, far = self.sight.limits
        hearing = {"global": HEAR_ALL, "sight": HEAR_SEEN}.get(str(options.hearing), HEAR_NEAR)
        return Senses(
            far,
            cos_half,
            hearing,
            options.hearing.blocks if isinstance(options.hearing, Radius) else 0.0,
            options.negative_evidence,
            options.testimony == "informed",
        )

    def heard_from(self, tick: int, speaker: int) -> Basis:
        """The basis of a claim; `NOBODY`: it was read, and nobody is known to have written it."""
        if speaker == NOBODY:
            return Basis(tick, Source.HEARD)
        return Basis(tick, Source.HEARD, EventKind.CHAT, self.agents[speaker])

    def basis_code(self, basis: Basis) -> int:
        """Return the source of a basis as arrays hold it: a row of `SOURCES`, or who was heard."""
        if basis.speaker is not None:
            return len(SOURCES) + self.numbers[basis.speaker]
        return SOURCES.index(basis.source)

    def basis(self, tick: int, code: int) -> Basis:
        """Return the basis that arrays hold as a tick and a code."""
        if code < len(SOURCES):
            return Basis(tick, SOURCES[code])
        return Basis(tick, Source.HEARD, EventKind.CHAT, self.agents[code - len(SOURCES)])

    @property
    def sign_cells(self) -> Collection[int]:
        """Cells of signs that were ever written on in any node, in the order they were found."""
        return self._sign_cells.keys()

    def note_signs(self, cells: Iterable[int]) -> None:
        """Note cells of signs that are written on, which are tracked if claims change beliefs."""
        found = dict.fromkeys(cells)
        self._sign_cells.update(found)
        if self.options.testimony != "none":
            self.track(found)

    def number(self, block: Block, claims: tuple[Claim, ...] = ()) -> int:
        """The number by which arrays know a block: its state, or one for a sign and its text.

        Args:
            block: The block.
            claims: What is claimed on it.

        Raises:
            InputError: More different texts were written than there are numbers for.
        """
        if isinstance(block, int):
            return block
        writing = (block, claims)
        if writing not in self._signs:
            number = self.registry.states + len(self._signs)
            if number == _NUMBERS:
                raise InputError(
                    f"there are more than {len(self._signs)} different texts on signs in this run; "
                    "no more can be told apart: write fewer"
                )
            self._signs[writing] = number
            # Whoever looks has them already.
            self.space.codes[number] = self.space.codes[block.state]
        return self._signs[writing]

    def claims_on(self, number: int) -> tuple[Claim, ...]:
        """What is claimed on the block of a number."""
        if number < self.registry.states:
            return ()
        return list(self._signs)[number - self.registry.states][1]

    @property
    def saved_signs(self) -> tuple[SavedWriting, ...]:
        """The signs with their texts in order of their numbers, as plain data."""
        return tuple((sign, tuple(c.plain() for c in claims)) for sign, claims in self._signs)

    def block(self, number: int) -> Block:
        """Return the block of a number; -1 is unknown."""
        return number if number < self.registry.states else self.signs[number]

    @cached_property
    def sign_states(self) -> npt.NDArray[np.int32]:
        """All block states of signs."""
        registry = self.registry
        names = [name for name in registry.block_names if is_sign(name)]
        return np.array([state for name in names for state in registry.state_ids(name)], np.int32)

    @property
    def signs(self) -> Mapping[int, Sign]:
        """The signs with their texts by number."""
        return {number: sign for (sign, _), number in self._signs.items()}

    def states(self, numbers: BlockGrid) -> BlockGrid:
        """Return the block states of numbers, without what is written."""
        if not self._signs or numbers.max(initial=-1) < self.registry.states:
            return numbers
        plain = np.array([sign.state for sign, _ in self._signs], dtype=np.int32)
        first = self.registry.states
        return np.where(numbers < first, numbers, plain[np.maximum(numbers - first, 0)])

    def texts(self, numbers: BlockGrid) -> Mapping[Position, str]:
        """What is written on the signs among the numbers of all blocks, in order of position."""
        if not self._signs:
            return {}
        x, y, z = self.box.low
        signs = self.signs
        found = np.argwhere(numbers >= self.registry.states).tolist()
        return {(x + i, y + j, z + k): signs[int(numbers[i, j, k])].text for i, j, k in found}

    def renumbered(
        self, numbers: npt.NDArray[np.int16], signs: Sequence[SavedWriting]
    ) -> npt.NDArray[np.int16]:
        """Numbers of another context as those of this one; `signs` are the other's, in order."""
        first = self.registry.states
        here = [self.number(sign, claims_from_plain(claims)) for sign, claims in signs]
        if here == list(range(first, first + len(here))):
            return numbers
        table = np.array([*range(first), *here], dtype=np.int16)
        return np.where(numbers < 0, numbers, table[numbers])

    def block_text(self, number: int) -> str | None:
        """A block of a number as people read it, with what is written on it; None: unknown."""
        return block_words(self.registry, self.block(number))

    def container_name(self, state: int) -> str | None:
        """Return the name of the container block of a state; None if it is none, or unknown."""
        return self.registry.name(state) if state >= 0 and self.holds[state] else None

    def block_name(self, state: int) -> str | None:
        """Return the name of the block of a state; None if it is unknown."""
        return None if state < 0 else self.registry.name(plain_state(self.block(state)))
