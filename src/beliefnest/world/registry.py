"""Registry of Minecraft's blocks and items: names, state ids, collision shapes.

The data are from minecraft-data (MIT). `worlds/minecraft/node/registry.js` writes them into one
file when the package is built. The text of a block state is `name` or `name[a=b,c=d]`. A prefix
`minecraft:` is accepted in input and never written.
"""

import difflib
import functools
import itertools
import math
import re
from bisect import bisect_right
from collections.abc import Iterable, Mapping, Sequence
from types import MappingProxyType

import msgspec
import numpy as np
import numpy.typing as npt
from msgspec.structs import replace

from beliefnest.errors import BodyError, InputError, UnknownNameError
from beliefnest.world.bundled import Bundled, read_bundled
from beliefnest.world.texts import quoted

AIR = 0
"""State id of air; it is the same in every version of the protocol."""

CONTAINER_NAMES = frozenset(
    {"chest", "trapped_chest", "barrel", "furnace", "blast_furnace", "smoker"}
)
"""Blocks whose contents are part of the world state."""

BoxBounds = tuple[float, float, float, float, float, float]
"""A box in blocks, relative to the block's lower corner: x0, y0, z0, x1, y1, z1."""

_FORMAT = 1
_STATE_TEXT = re.compile(r"(?:minecraft:)?([a-z0-9_]+)(?:\[([^\[\]]*)\])?")
_PROPERTY_TEXT = re.compile(r"\s*([a-z0-9_]+)\s*=\s*([a-z0-9_]+)\s*")
_CLEAR_NAMES = frozenset({"glass", "tinted_glass", "glass_pane", "barrier", "ice"})
_CLEAR_SUFFIXES = ("_stained_glass", "_stained_glass_pane")


class _BlockFile(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    name: str
    first_state: int
    last_state: int
    default_state: int
    properties: list[tuple[str, list[str]]]
    shapes: list[int]
    solid: bool


class _RegistryFile(Bundled, frozen=True, forbid_unknown_fields=True):
    blocks: list[_BlockFile]
    shapes: list[list[BoxBounds]]
    items: list[tuple[str, int]]


class _Block(msgspec.Struct, frozen=True):
    """One block; its state ids enumerate the property values, the last property fastest."""

    name: str
    first_state: int
    default_values: tuple[str, ...]
    properties: tuple[tuple[str, tuple[str, ...]], ...]
    solid: bool

    def state_id(self, chosen: Mapping[str, str]) -> int:
        """Return the state id with the chosen values; other properties keep their defaults."""
        offset = 0
        for (name, values), default in zip(self.properties, self.default_values, strict=True):
            value = chosen.get(name, default)
            if value not in values:
                raise UnknownNameError(
                    f"block {quoted(self.name)} has no {name}={value}; "
                    f"{name} is one of {', '.join(values)}"
                )
            offset = offset * len(values) + values.index(value)
        return self.first_state + offset

    def values(self, state_id: int) -> tuple[str, ...]:
        """Return the property values of a state, in the order of `properties`."""
        offset = state_id - self.first_state
        chosen: list[str] = []
        for _, values in reversed(self.properties):
            offset, index = divmod(offset, len(values))
            chosen.append(values[index])
        return tuple(reversed(chosen))


class Registry(msgspec.Struct, frozen=True, eq=False):
    """Blocks and items of one Minecraft version.

    Attributes:
        version: Minecraft version, as `1.20.4`.
        states: Number of block states; ids are 0 to states - 1.
        airs: State ids of air, cave air and void air.
        default_transparent: bool (states,): glass of every kind, barrier, ice, and states
            without collision box.
        state_shape: int32 (states,): index of each state's collision shape.
        shape_start: int32 (shapes + 1,): the boxes of shape k are rows shape_start[k] to
            shape_start[k + 1] - 1 of `shape_boxes`.
        shape_boxes: float64 (n, 6): boxes as `BoxBounds`. They may reach out of the block: a
            fence is 1.5 high.
    """

    version: str
    states: int
    airs: tuple[int, ...]
    default_transparent: npt.NDArray[np.bool_]
    state_shape: npt.NDArray[np.int32]
    shape_start: npt.NDArray[np.int32]
    shape_boxes: npt.NDArray[np.float64]
    _blocks: Mapping[str, _Block]
    _first_states: Sequence[int]
    _block_order: Sequence[_Block]
    _items: Mapping[str, int]

    @staticmethod
    def load(version: str = "1.20.4") -> "Registry":
        """Return the registry of a Minecraft version; each is read once per process.

        Raises:
            BodyError: The package was not built, or its registry file is damaged.
        """
        return _load(version)

    @property
    def air(self) -> int:
        """State id of air."""
        return AIR

    def state_id(self, text: str) -> int:
        """Return the state id of a text such as `oak_slab[type=top]`.

        Raises:
            InputError: The text has not the form `name` or `name[a=b,c=d]`.
            UnknownNameError: No such block, property or value.
        """
        name, chosen = parse_state(text)
        block = self._block(name)
        names = [property_name for property_name, _ in block.properties]
        for property_name in chosen:
            if property_name not in names:
                has = f"it has {', '.join(names)}" if names else "it has none"
                raise UnknownNameError(
                    f"block {quoted(name)} has no property {quoted(property_name)}; {has}"
                )
        return block.state_id(chosen)

    @functools.cache  # noqa: B019 - a registry is loaded once per process
    def text(self, state_id: int) -> str:
        """Return the canonical text of a state: `name` or `name[a=b,c=d]`, sorted by property.

        Raises:
            UnknownNameError: There is no such state id.
        """
        properties = self.properties(state_id)
        if not properties:
            return self.name(state_id)
        inner = ",".join(f"{name}={properties[name]}" for name in sorted(properties))
        return f"{self.name(state_id)}[{inner}]"

    def name(self, state_id: int) -> str:
        """Return the name of a state's block, without properties.

        Raises:
            UnknownNameError: No such state id.
        """
        return self._block_of(state_id).name

    def properties(self, state_id: int) -> dict[str, str]:
        """Return the values of a state's properties by name, in the order of the version.

        Raises:
            UnknownNameError: There is no such state id.
        """
        block = self._block_of(state_id)
        names = (name for name, _ in block.properties)
        return dict(zip(names, block.values(state_id), strict=True))

    def changed(self, state_id: int, **properties: str) -> int:
        """Return the state id of the same block with other values of some properties.

        Raises:
            UnknownNameError: There is no such state id, property or value.
        """
        values = {**self.properties(state_id), **properties}
        inner = ",".join(f"{name}={value}" for name, value in values.items())
        return self.state_id(f"{self.name(state_id)}[{inner}]" if inner else self.name(state_id))

    def boxes(self, state_id: int) -> tuple[BoxBounds, ...]:
        """Return the collision boxes of a state, in blocks relative to the block's lower corner.

        Raises:
            UnknownNameError: There is no such state id.
        """
        self._block_of(state_id)
        shape = self.state_shape[state_id]
        rows = self.shape_boxes[self.shape_start[shape] : self.shape_start[shape + 1]]
        return tuple((x0, y0, z0, x1, y1, z1) for x0, y0, z0, x1, y1, z1 in rows.tolist())

    def is_full(self, state_id: int) -> bool:
        """Return True if the collision box of a state is a full cube.

        Raises:
            UnknownNameError: There is no such state id.
        """
        return self.boxes(state_id) == ((0.0, 0.0, 0.0, 1.0, 1.0, 1.0),)

    def is_solid(self, name: str) -> bool:
        """Return True if bots take a block for an obstacle, whatever its state.

        Raises:
            UnknownNameError: There is no such block.
        """
        return self._block(_bare(name)).solid

    def state_ids(self, name: str) -> range:
        """Return all state ids of a block.

        Raises:
            UnknownNameError: No such block.
        """
        block = self._block(_bare(name))
        count = math.prod(len(values) for _, values in block.properties)
        return range(block.first_state, block.first_state + count)

    def states_of(self, names: Iterable[str]) -> list[int]:
        """Return all state ids of some blocks.

        Raises:
            UnknownNameError: There is no block of a name.
        """
        return [state for name in names for state in self.state_ids(name)]

    @property
    def containers(self) -> frozenset[str]:
        """Names of the blocks whose contents are part of the world state."""
        return CONTAINER_NAMES & self._blocks.keys()

    def is_container(self, name: str) -> bool:
        """Return True if the contents of the block are part of the world state."""
        return _bare(name) in CONTAINER_NAMES

    def has_block(self, name: str) -> bool:
        """Return True if there is a block of that name, given without properties."""
        return _bare(name) in self._blocks

    @property
    def block_names(self) -> tuple[str, ...]:
        """Names of all blocks, in the order of their states."""
        return tuple(self._blocks)

    @property
    def item_names(self) -> tuple[str, ...]:
        """Names of all items, in the game's order."""
        return tuple(self._items)

    def has_item(self, name: str) -> bool:
        """Return True if there is an item of that name."""
        return _bare(name) in self._items

    def item_stack(self, name: str) -> int:
        """Return the number of items that fit in one slot.

        Raises:
            UnknownNameError: There is no such item.
        """
        bare = _bare(name)
        if bare not in self._items:
            raise UnknownNameError(
                f"no item {quoted(name)} in Minecraft {self.version}"
                f"{_nearest(bare, self._items) or _EXAMPLES}"
            )
        return self._items[bare]

    @functools.cache  # noqa: B019 - a registry is loaded once per process
    def check_property(self, name: str) -> None:
        """Raise UnknownNameError if no block has a property."""
        names = {each for block in self._block_order for each, _ in block.properties}
        if name not in names:
            examples = "; give one of the game, such as open, facing, powered or half"
            hint = _nearest(name, sorted(names)) or examples
            raise UnknownNameError(f"no block has the property {quoted(name)}{hint}")

    def _block(self, name: str) -> _Block:
        if name not in self._blocks:
            raise UnknownNameError(
                f"no block {quoted(name)} in Minecraft {self.version}{_nearest(name, self._blocks)}"
            )
        return self._blocks[name]

    def _block_of(self, state_id: int) -> _Block:
        if not 0 <= state_id < self.states:
            raise UnknownNameError(
                f"no block state {state_id} in Minecraft {self.version}; "
                f"ids are 0 to {self.states - 1} (-1 in a grid is unknown and has no name)"
            )
        return self._block_order[bisect_right(self._first_states, state_id) - 1]


_EXAMPLES = "; give one of the game, such as diamond, clock, book or oak_planks"


def _bare(name: str) -> str:
    return name.removeprefix("minecraft:")


def _nearest(name: str, names: Iterable[str]) -> str:
    close = difflib.get_close_matches(name, names, n=3)
    return f"; did you mean {' or '.join(close)}?" if close else ""


def block_name(text: str) -> str:
    """Return the name of a block state text: `lever` of `lever[powered=true]`."""
    return text.partition("[")[0]


def parse_state(text: str) -> tuple[str, dict[str, str]]:
    """Parse a block state text into name and chosen properties; InputError if it is invalid."""
    match = _STATE_TEXT.fullmatch(text.strip())
    if match is None:
        raise InputError(f"{quoted(text)} is not a block; write name or name[property=value,...]")
    name, inner = match.groups()
    chosen: dict[str, str] = {}
    for part in inner.split(",") if inner else ():
        pair = _PROPERTY_TEXT.fullmatch(part)
        if pair is None:
            raise InputError(f"{quoted(part)} in {quoted(text)} is not of the form property=value")
        if pair[1] in chosen:
            raise InputError(f"{quoted(text)} gives {quoted(pair[1])} twice; give it once")
        chosen[pair[1]] = pair[2]
    return name, chosen


@functools.lru_cache(maxsize=4)
def _load(version: str) -> Registry:
    return _build(read_bundled("registry", version, _RegistryFile, _FORMAT))


def _build(file: _RegistryFile) -> Registry:
    blocks = sorted((_block_from(entry) for entry in file.blocks), key=lambda b: b.first_state)
    by_name = {block.name: block for block in blocks}
    state_shape = _state_shapes(file)
    counts = np.array([len(boxes) for boxes in file.shapes], dtype=np.int32)
    shape_boxes = np.array(list(itertools.chain(*file.shapes)), dtype=np.float64).reshape(-1, 6)
    transparent = counts[state_shape] == 0
    for entry in file.blocks:
        if entry.name in _CLEAR_NAMES or entry.name.endswith(_CLEAR_SUFFIXES):
            transparent[entry.first_state : entry.last_state + 1] = True
    shape_start = np.concatenate([[0], np.cumsum(counts)]).astype(np.int32)
    for table in (transparent, state_shape, shape_start, shape_boxes):
        table.flags.writeable = False
    return Registry(
        version=file.minecraft,
        states=len(state_shape),
        airs=tuple(by_name[name].first_state for name in ("air", "cave_air", "void_air")),
        default_transparent=transparent,
        state_shape=state_shape,
        shape_start=shape_start,
        shape_boxes=shape_boxes,
        _blocks=MappingProxyType(by_name),
        _first_states=tuple(block.first_state for block in blocks),
        _block_order=tuple(blocks),
        _items=MappingProxyType(dict(file.items)),
    )


def _block_from(entry: _BlockFile) -> _Block:
    properties = tuple((name, tuple(values)) for name, values in entry.properties)
    plain = _Block(entry.name, entry.first_state, (), properties, entry.solid)
    return replace(plain, default_values=plain.values(entry.default_state))


def _state_shapes(file: _RegistryFile) -> npt.NDArray[np.int32]:
    shapes = np.full(max(entry.last_state for entry in file.blocks) + 1, -1, dtype=np.int32)
    for entry in file.blocks:
        shapes[entry.first_state : entry.last_state + 1] = entry.shapes
    if (shapes < 0).any():
        raise BodyError(
            f"the registry of Minecraft {file.minecraft} lacks block state "
            f"{int(np.argmin(shapes))}: build the package anew with `pip install .`"
        )
    return shapes
