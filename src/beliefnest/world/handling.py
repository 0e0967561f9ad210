"""Rules for using, breaking and placing blocks by hand in the scripted world.

Drops and times are the same as in the embedded world: `worlds/minecraft/node/handling.js` writes
its rules into a file when the package is built. The functions refuse acts whose result is random or
depends on the pose of the agent in the embedded world, and to break what holds another block.
"""

import functools
from collections.abc import Iterable, Mapping

import msgspec

from beliefnest.errors import WorldError
from beliefnest.world.bundled import Bundled, read_bundled
from beliefnest.world.double_chests import StateAt
from beliefnest.world.registry import Registry
from beliefnest.world.values import Items, Point, Position

_FORMAT = 1
_SIDES = ((0, -1, 0), (0, 1, 0), (0, 0, -1), (0, 0, 1), (-1, 0, 0), (1, 0, 0))
_HALF_WIDTH, _HEIGHT = 0.3, 1.8
_NEEDS_HOLDER = (
    *("lever", "torch", "ladder", "_button", "_carpet"),
    *("_sign", "_plate", "_wire", "rail"),
)
"""Ends of the names of blocks that need another block beside or below them."""


class _Breaking(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    tools: list[str]
    drops: dict[str, int]


class _File(Bundled, frozen=True, forbid_unknown_fields=True):
    breaking: dict[str, _Breaking]
    pressed: dict[str, int]


class Handling(msgspec.Struct, frozen=True, eq=False):
    """Results of using and breaking the blocks of one Minecraft version by hand."""

    _breaking: Mapping[str, _Breaking]
    _pressed: Mapping[str, int]

    @staticmethod
    def load(version: str = "1.20.4") -> "Handling":
        """Return the rules of a Minecraft version; each is read once per process.

        Raises:
            BodyError: The package was not built, or the file of the rules is damaged.
        """
        return _load(version)

    def pressed_ticks(self, name: str) -> int:
        """Return the ticks after which a pressed button comes out; 0 if the block is no button."""
        return self._pressed.get(name, 0)

    def is_pressed(self, registry: Registry, state: int) -> bool:
        """Return True if a block is a pressed button."""
        is_button = self.pressed_ticks(registry.name(state)) > 0
        return is_button and registry.properties(state)["powered"] == "true"

    def drops(self, name: str, tools: Iterable[str]) -> Items:
        """Return the items that a block drops when it is broken with one of the given tools.

        Raises:
            WorldError: The block cannot be broken, its drops are random, or it needs another
                tool.
        """
        how = self._breaking.get(name)
        if how is None:
            raise WorldError(
                f"a {name} cannot be mined in the scripted world: it is unbreakable, has several "
                'parts, or has random drops; open the nest with world="embedded" for that'
            )
        if how.tools and not set(how.tools) & set(tools):
            raise WorldError(f"{name} needs one of these tools: {', '.join(how.tools)}")
        return how.drops


def switched_lever(registry: Registry, state_at: StateAt, place: Position, *, powered: bool) -> int:
    """Return the state of a lever after it was switched.

    Raises:
        WorldError: There is no lever, or it has this state already.
    """
    text = registry.text(state_at(place))
    if registry.name(state_at(place)) != "lever":
        raise WorldError(f"there is no lever at {place}, but {text}")
    if (registry.properties(state_at(place))["powered"] == "true") is powered:
        raise WorldError(f"the lever at {place} is {'on' if powered else 'off'} already")
    return with_power(registry, state_at(place), powered=powered)


def pressed_button(
    registry: Registry, state_at: StateAt, place: Position, *, powered: bool = True
) -> int:
    """Return the state of a button after it was pressed or came out again.

    Raises:
        WorldError: There is no button, or it has this state already.
    """
    state = state_at(place)
    if not registry.name(state).endswith("_button"):
        raise WorldError(f"there is no button at {place}, but {registry.text(state)}")
    if (registry.properties(state)["powered"] == "true") is powered:
        raise WorldError(f"the button at {place} is {'in' if powered else 'out'} already")
    return with_power(registry, state, powered=powered)


def put_block(
    registry: Registry, state_at: StateAt, place: Position, name: str, bodies: Iterable[Point]
) -> int:
    """Return the state of a block that an agent places.

    Args:
        registry: Names and shapes.
        state_at: Function that returns the block state at a position.
        place: Position for the block.
        name: Name of the item, which is also the name of the block.
        bodies: Positions of the feet of all agents.

    Raises:
        WorldError: There is no such block, the place is taken, or no block supports it.
    """
    if not registry.has_block(name) or len(registry.state_ids(name)) != 1:
        raise WorldError(
            f"{name} cannot be put in the scripted world: it is no block, or its state depends on "
            'the pose of the agent; open the nest with world="embedded" for that'
        )
    around = (state_at(plus(place, side)) for side in _SIDES)
    is_held = any(registry.boxes(each) for each in around)
    if state_at(place) not in registry.airs or not is_held:
        raise WorldError(
            f"{name} cannot be put at {place}: {registry.text(state_at(place))} is there, or no "
            "solid block is beside it"
        )
    state = registry.state_id(name)
    if any(_overlaps(box, place, feet) for box in registry.boxes(state) for feet in bodies):
        raise WorldError(f"{name} cannot be put at {place}: somebody stands there")
    return state


def check_holds_nothing(registry: Registry, state_at: StateAt, place: Position) -> None:
    """Raise WorldError if a neighbour of a block may come off together with it."""
    for side in _SIDES:
        # The message does not name what the agent may not see.
        if registry.name(state_at(plus(place, side))).endswith(_NEEDS_HOLDER):
            raise WorldError(
                f"the block at {place} cannot be mined in the scripted world: what it may hold, "
                'such as a lever, would come off; open the nest with world="embedded" for that'
            )


def with_power(registry: Registry, state: int, *, powered: bool) -> int:
    """Return the state of a block after its property `powered` was set."""
    return registry.changed(state, powered=str(powered).lower())


def plus(place: Position, step: tuple[int, int, int]) -> Position:
    """Return the position one step from another."""
    return (place[0] + step[0], place[1] + step[1], place[2] + step[2])


def _overlaps(box: tuple[float, ...], place: Position, feet: Point) -> bool:
    low = [corner + at for corner, at in zip(box[:3], place, strict=True)]
    high = [corner + at for corner, at in zip(box[3:], place, strict=True)]
    body_low = (feet[0] - _HALF_WIDTH, feet[1], feet[2] - _HALF_WIDTH)
    body_high = (feet[0] + _HALF_WIDTH, feet[1] + _HEIGHT, feet[2] + _HALF_WIDTH)
    below = all(a < b for a, b in zip(body_low, high, strict=True))
    return below and all(a > b for a, b in zip(body_high, low, strict=True))


@functools.lru_cache(maxsize=4)
def _load(version: str) -> Handling:
    file = read_bundled("handling", version, _File, _FORMAT)
    return Handling(file.breaking, file.pressed)
