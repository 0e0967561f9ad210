"""Double chests: two blocks that are one container.

Two chests of one name and facing, one of `type=left` and one of `type=right`, are one container.
Its position is that of its right half, whose slots come first in the window (to a person in front
of the chest, this half is on the left). The left half is a block without contents of its own. A
half without the other one is a single chest.
"""

from collections.abc import Callable, Iterator, Mapping
from functools import cache
from typing import Any, TypeVar

from beliefnest.world.registry import Registry
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import Box, Position

StateAt = Callable[[Position], int]
"""Function that returns the block state at a position: air outside the world, -1 if unknown."""

T = TypeVar("T")
_NOTHING = object()

CHESTS = ("chest", "trapped_chest")
"""Containers that can be double, and have lids."""
_TYPES = {"left": "right", "right": "left"}
_TO_RIGHT = {"north": (1, 0, 0), "east": (0, 0, 1), "south": (-1, 0, 0), "west": (0, 0, -1)}
"""Step from a left half to its right half, by the direction that both face."""


@cache
def holds_items(registry: Registry, state: int) -> bool:
    """Return True if a block is a container of its own; no left half is."""
    return registry.is_container(registry.name(state)) and not is_left_half(registry, state)


def is_left_half(registry: Registry, state: int) -> bool:
    """Return True for the left half of a double chest."""
    return registry.name(state) in CHESTS and registry.properties(state)["type"] == "left"


def other_half(registry: Registry, state: int, place: Position) -> tuple[Position, int] | None:
    """Return position and state of the other half of a half at a place; None if it is none."""
    if (other := _other_half(registry, state)) is None:
        return None
    (x, y, z), half = other
    return (place[0] + x, place[1] + y, place[2] + z), half


@cache
def _other_half(registry: Registry, state: int) -> tuple[Position, int] | None:
    if state < 0 or registry.name(state) not in CHESTS:
        return None
    properties = registry.properties(state)
    if (kind := properties["type"]) not in _TYPES:
        return None
    x, y, z = _TO_RIGHT[properties["facing"]]
    step = (x, y, z) if kind == "left" else (-x, -y, -z)
    # What else differs, such as water in one half, does not part them.
    return step, registry.changed(state, type=_TYPES[kind], waterlogged="false")


def is_double(registry: Registry, state_at: StateAt, place: Position) -> bool:
    """Return True if the block at a place is a half of a double chest."""
    other = other_half(registry, state_at(place), place)
    if other is None:
        return False
    there = state_at(other[0])
    back = other_half(registry, there, other[0])
    return (
        back is not None
        and back[0] == place
        and registry.name(there) == registry.name(other[1])
        and registry.properties(there)["facing"] == registry.properties(other[1])["facing"]
    )


def halves_at(registry: Registry, state_at: StateAt, place: Position) -> tuple[Position, ...]:
    """Return the positions of the container to which a block belongs: its right half first."""
    if not is_double(registry, state_at, place):
        return (place,)
    other = other_half(registry, state_at(place), place)
    assert other is not None  # it is double
    return (other[0], place) if is_left_half(registry, state_at(place)) else (place, other[0])


def container_at(registry: Registry, state_at: StateAt, place: Position) -> Position:
    """Return the position of the container to which a block belongs: that of its right half."""
    return halves_at(registry, state_at, place)[0]


def believed_container_at(registry: Registry, state_at: StateAt, place: Position) -> Position:
    """Return the position of the container to which a block belongs, if states may be unknown.

    The state of either half tells where the other one is.
    """
    own = other_half(registry, state_at(place), place)
    if own is not None and not holds_items(registry, state_at(place)):
        return own[0]
    for x, y, z in _TO_RIGHT.values():
        near = (place[0] + x, place[1] + y, place[2] + z)
        other = other_half(registry, state_at(near), near)
        if other is not None and other[0] == place and holds_items(registry, state_at(near)):
            return near
    return place


def left_half_of(registry: Registry, state_at: StateAt, place: Position) -> Position | None:
    """Return the position of the left half whose right half is at a place; None: there is none."""
    for x, y, z in _TO_RIGHT.values():
        near = (place[0] - x, place[1] - y, place[2] - z)
        state = state_at(near)
        if state >= 0 and is_left_half(registry, state):
            other = other_half(registry, state, near)
            if other is not None and other[0] == place:
                return near
    return None


def states_in(box: Box, blocks: Terrain, outside: int) -> StateAt:
    """Return the function that returns the block state at a position of a terrain."""
    return lambda place: int(blocks[box.index(place)]) if place in box else outside


def whole_chests(registry: Registry, box: Box, blocks: Terrain) -> Terrain:
    """Return blocks in which halves without their other half are single chests.

    Halves whose other half lies at an unknown block stay as they are.
    """
    state_at = states_in(box, blocks, registry.air)
    made = None
    for place, state in halves_in(registry, box, blocks):
        other = other_half(registry, state, place)
        if (
            other is not None
            and state_at(other[0]) >= 0
            and not is_double(registry, state_at, place)
        ):
            made = made or blocks.draft()
            made[box.index(place)] = registry.changed(state, type="single")
    return blocks if made is None else made.terrain()


class ByEitherHalf(dict[Position, T]):
    """Values by position of a container, which are found at either half of a double chest.

    Iteration and length count each container once.

    Args:
        found: Values by position of the container.
        whole: Function that returns the position of the container to which a block belongs.
    """

    def __init__(self, items: Mapping[Position, T], whole: Callable[[Position], Position]) -> None:
        super().__init__(items)
        self._whole = whole

    def __reduce__(self) -> tuple[type, tuple[dict[Position, T]]]:
        return dict, (dict(self.items()),)

    def __missing__(self, place: Position) -> T:
        whole = self._whole(place)
        if whole != place and dict.__contains__(self, whole):
            return dict.__getitem__(self, whole)
        raise KeyError(place)

    def __contains__(self, place: object) -> bool:
        return bool(self.get(place, _NOTHING) is not _NOTHING)  # type: ignore[arg-type] # any key may be asked for

    def get(self, place: Position, default: Any = None) -> Any:
        """Return the value at a position, or a default."""
        try:
            return self[place]
        except KeyError:
            return default


def halves_in(registry: Registry, box: Box, blocks: Terrain) -> Iterator[tuple[Position, int]]:
    """Yield position and state of all halves of a terrain."""
    here = {int(state) for state in blocks.states if state >= 0}
    halves = [s for s in here if other_half(registry, s, (0, 0, 0)) is not None]
    x, y, z = box.low
    for i, j, k in blocks.find(halves).tolist() if halves else ():
        yield (x + i, y + j, z + k), int(blocks[i, j, k])
