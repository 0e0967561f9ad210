"""The part that all nodes of one nest share: box, agents, blocks, and options of perception."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from beliefnest.belief.arrays import NOBODY, Space
from beliefnest.belief.first_perceptions import FirstPerceptions
from beliefnest.belief.grounds import SOURCES, Basis, Source
from beliefnest.errors import InputError
from beliefnest.perception.options import Perception
from beliefnest.perception.sight import Sight
from beliefnest.world import terrain
from beliefnest.world.claims import Claim, claims_from_plain
from beliefnest.world.double_chests import holds_items
from beliefnest.world.event_kinds import EventKind
from beliefnest.world.memory import MemoryLimit, memory_limit
from beliefnest.world.registry import Registry
from beliefnest.world.signs import block_words, plain_state
from beliefnest.world.terrain import Terrain, chunks_of
from beliefnest.world.values import Block, Box, Position, Sign

_NUMBERS = 2**15 - 1
"""Limit of block numbers, as arrays are int16: block states first, then signs with texts."""


Writing = tuple[Sign, tuple[Claim, ...]]
"""A sign with its text, and the claims on it."""

SavedWriting = tuple[Sign, tuple[Mapping[str, Any], ...]]
"""A `Writing` as plain data."""


@dataclass(frozen=True, eq=False)
class BeliefContext:
    """Box, agents, blocks and options of a nest, which do not change while it lives.

    Only two lists grow: tracked cells, and the signs with texts that have been met so far.

    Attributes:
        box: The part of space covered.
        agents: All agents, sorted; arrays count them in this order.
        options: Options of perception.
        registry: Names and shapes of blocks.
        sight: How agents see.
        first_perceptions: Cache of first perceptions with these shapes, shared with other nests.
        unique: Items of which everybody knows that there is only one (semantics, section 3).
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
        """The cells for which nodes keep a basis, in the order in which they were found.

        These are cells that ever hold a container in any node, and those that claims are about.
        """
        return self._tracked.keys()

    def track(self, cells: Iterable[int]) -> None:
        """Add cells to those that are tracked."""
        self._tracked.update(dict.fromkeys(cells))

    @cached_property
    def cells(self) -> int:
        """The number of cells of the box."""
        nx, ny, nz = self.box.shape
        return nx * ny * nz

    @property
    def is_dense(self) -> bool:
        """True if nodes hold dense arrays of the box; otherwise they share chunks."""
        return self.cells <= terrain.DENSE

    @cached_property
    def memory(self) -> MemoryLimit | None:
        """The greatest memory of this process; None: the system tells none."""
        return memory_limit()

    @cached_property
    def numbers(self) -> dict[str, int]:
        """The number of each agent by name."""
        return {name: number for number, name in enumerate(self.agents)}

    @cached_property
    def holds(self) -> npt.NDArray[np.bool_]:
        """Bool by block number, and at the end for unknown: whether it is a container.

        The left half of a double chest is none: its right half is the container.
        """
        holds = np.zeros(_NUMBERS + 1, dtype=np.bool_)
        for state in self.registry.states_of(self.registry.containers):
            holds[state] = holds_items(self.registry, state)
        return holds

    @cached_property
    def shows(self) -> npt.NDArray[np.bool_]:
        """Bool by block number, as `holds`: a container, or the left half that belongs to one."""
        shows = self.holds.copy()
        shows[self.registry.states_of(self.registry.containers)] = True
        return shows

    @cached_property
    def space(self) -> Space:
        """The box and its shapes for the kernel."""
        # Imported here because compiled code loads slowly and listing scenarios does without it.
        from beliefnest.perception import beams

        sight, registry = self.sight, self.registry
        codes = np.empty(_NUMBERS + 1, dtype=np.uint16)
        codes[: registry.states], codes[-1] = sight.state_codes[:-1], sight.state_codes[-1]
        for (sign, _), number in self._signs.items():
            codes[number] = codes[sign.state]
        nx, ny, nz = self.box.shape
        sizes = (nx + 2, ny + 2, nz + 2)
        return Space(
            sizes,
            None if self.is_dense else chunks_of(sizes),
            registry.shape_start,
            registry.shape_boxes,
            sight.reaches,
            codes,
            self.shows,
            1.0 - np.array(self.box.low, dtype=np.float64),
            self.options.limits,
            beams.beam_room(),
            None if self.is_dense else np.zeros(0, dtype=np.int32),
        )

    @property
    def weighs(self) -> bool:
        """True if hearers weigh claims (semantics, section 8), so that what they watch counts."""
        return self.options.testimony == "informed"

    def heard_from(self, tick: int, speaker: int) -> Basis:
        """Return the basis of a claim of a speaker; `NOBODY`: a sign of unknown writer."""
        if speaker == NOBODY:
            return Basis(tick, Source.HEARD)
        return Basis(tick, Source.HEARD, EventKind.CHAT, self.agents[speaker])

    def basis_code(self, basis: Basis) -> int:
        """Return the code of a basis's source: an index of `SOURCES`, or above these a speaker."""
        if basis.speaker is not None:
            return len(SOURCES) + self.numbers[basis.speaker]
        return SOURCES.index(basis.source)

    def basis(self, tick: int, code: int) -> Basis:
        """Return the basis of a tick and a code of `basis_code`."""
        if code < len(SOURCES):
            return Basis(tick, SOURCES[code])
        return Basis(tick, Source.HEARD, EventKind.CHAT, self.agents[code - len(SOURCES)])

    @property
    def sign_cells(self) -> Collection[int]:
        """The cells of signs that ever carry text in any node, in the order they were found."""
        return self._sign_cells.keys()

    def note_signs(self, cells: Iterable[int]) -> None:
        """Add cells of signs with text. They are tracked too if claims can change beliefs."""
        new_cells = dict.fromkeys(cells)
        self._sign_cells.update(new_cells)
        if self.options.testimony != "none":
            self.track(new_cells)

    def number(self, block: Block, claims: tuple[Claim, ...] = ()) -> int:
        """Return the number of a block in arrays: its state, or a higher number for a written sign.

        A sign with a text or claims that were not met before gets a new number.

        Args:
            block: The block.
            claims: Claims on the sign.

        Raises:
            InputError: There are more different texts than numbers.
        """
        if isinstance(block, int):
            return block
        writing = (block, claims)
        if writing not in self._signs:
            number = self.registry.states + len(self._signs)
            if number == _NUMBERS:
                raise InputError(
                    f"this run has more than {len(self._signs)} different texts on signs, which is "
                    "the limit: write fewer different texts"
                )
            self._signs[writing] = number
            # The kernel's array exists already: a new sign has the shape of its block state.
            self.space.codes[number] = self.space.codes[block.state]
        return self._signs[writing]

    def claims_on(self, number: int) -> tuple[Claim, ...]:
        """Return the claims on the block of a number."""
        if number < self.registry.states:
            return ()
        return list(self._signs)[number - self.registry.states][1]

    @property
    def saved_signs(self) -> tuple[SavedWriting, ...]:
        """The signs with texts as plain data, in order of their numbers."""
        return tuple((sign, tuple(c.plain() for c in claims)) for sign, claims in self._signs)

    def block(self, number: int) -> Block:
        """Return the block of a number; -1 is unknown."""
        return number if number < self.registry.states else self.signs[number]

    @property
    def signs(self) -> Mapping[int, Sign]:
        """The signs with texts by number."""
        return {number: sign for (sign, _), number in self._signs.items()}

    def states(self, numbers: Terrain) -> Terrain:
        """Return the block states of numbers. A sign's text is dropped."""
        first = self.registry.states
        if not self._signs or numbers.span[1] < first:
            return numbers
        plain = np.array([sign.state for sign, _ in self._signs], dtype=np.int32)
        return numbers.mapped(
            lambda part: np.where(part < first, part, plain[np.maximum(part - first, 0)])
        )

    def texts(self, numbers: Terrain) -> Mapping[Position, str]:
        """Return the texts of signs by position, in order."""
        if not self._signs:
            return {}
        x, y, z = self.box.low
        return {
            (x + i, y + j, z + k): self.signs[numbers[i, j, k]].text
            for i, j, k in numbers.find(self.signs.keys()).tolist()
        }

    def renumbered(
        self, numbers: npt.NDArray[np.int16], signs: Sequence[SavedWriting]
    ) -> npt.NDArray[np.int16]:
        """Translate block numbers of another context into numbers of this one.

        Args:
            numbers: Numbers of the other context.
            signs: Signs with texts of the other context, in order of their numbers.
        """
        first = self.registry.states
        here = [self.number(sign, claims_from_plain(claims)) for sign, claims in signs]
        if here == list(range(first, first + len(here))):
            return numbers
        table = np.array([*range(first), *here], dtype=np.int16)
        return np.where(numbers < 0, numbers, table[numbers])

    def block_text(self, number: int) -> str | None:
        """Return the block of a number in words, with the text of a sign; None: unknown."""
        return block_words(self.registry, self.block(number))

    def container_name(self, state: int) -> str | None:
        """Return the name of the container block of a state; None if it is none, or unknown."""
        return self.registry.name(state) if state >= 0 and self.holds[state] else None

    def block_name(self, state: int) -> str | None:
        """Return the name of the block of a state; None if it is unknown."""
        return None if state < 0 else self.registry.name(plain_state(self.block(state)))
