"""Doors, trapdoors, fence gates and switches: which blocks they are, and their use."""

from collections.abc import Callable

from beliefnest.errors import WorldError
from beliefnest.world.registry import Registry
from beliefnest.world.values import Position

_KINDS = ("_door", "_trapdoor", "_fence_gate")
_BY_POWER = "iron_"
_WAYS = ("_door", "_fence_gate")
_SWITCHES = ("lever", "_button")


def is_door(name: str) -> bool:
    """Return True if a block name is that of a door, a trapdoor or a fence gate."""
    return name.endswith(_KINDS)


def is_doorway(name: str) -> bool:
    """Return True if agents can walk through the block when it is open: door or fence gate."""
    return name.endswith(_WAYS)


def is_switch(name: str) -> bool:
    """Return True if a block name is that of a lever or a button."""
    return name.endswith(_SWITCHES)


def moves_by_hand(name: str) -> bool:
    """Return True if a door, trapdoor or gate can be moved by hand, not only by redstone power."""
    return is_door(name) and not name.startswith(_BY_POWER)


def passage(registry: Registry, state: int) -> tuple[int, int]:
    """Return the horizontal direction through a door or gate: (1, 0) along x, (0, 1) along z."""
    return (0, 1) if registry.properties(state)["facing"] in ("north", "south") else (1, 0)


def is_open(registry: Registry, state: int) -> bool | None:
    """Return True if a door, trapdoor or gate is open; None if the block is none of them."""
    return registry.properties(state)["open"] == "true" if is_door(registry.name(state)) else None


def used_door(
    registry: Registry, state_at: Callable[[Position], int], place: Position, *, opens: bool
) -> dict[Position, int]:
    """Return the new block states after a door was used; the first is the door's position.

    Args:
        registry: Names and properties of states.
        state_at: Function that returns the block state at a position; air outside the world.
        place: Position of the door; either half.
        opens: True to open the door, False to shut it.

    Raises:
        WorldError: There is no door, it has this state already, or only power moves it.
    """
    text = registry.text(state_at(place))
    name = registry.name(state_at(place))
    stands_open = is_open(registry, state_at(place))
    if stands_open is None:
        raise WorldError(f"there is no door, trapdoor or gate at {place}, but {text}")
    if not moves_by_hand(name):
        raise WorldError(
            f"the {name} at {place} is not moved by hand; use the lever, button or plate that "
            "powers it"
        )
    if stands_open is opens:
        raise WorldError(f"the {name} at {place} is {'open' if opens else 'shut'} already")
    parts = [place]
    if name.endswith("_door"):
        x, y, z = place
        lower = registry.properties(state_at(place))["half"] == "lower"
        parts = [place, (x, y + 1, z)] if lower else [(x, y - 1, z), place]
    return {
        part: registry.changed(state_at(part), open=str(opens).lower())
        for part in parts
        if registry.name(state_at(part)) == name
    }
