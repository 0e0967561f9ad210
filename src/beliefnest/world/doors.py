"""Doors, trapdoors, fence gates and switches: which blocks are, and what using a door does."""

from collections.abc import Callable

from beliefnest.errors import WorldError
from beliefnest.world.registry import Registry
from beliefnest.world.values import Position

__all__ = ["is_door", "is_doorway", "is_open", "is_switch", "moves_by_hand", "passage", "used_door"]

_KINDS = ("_door", "_trapdoor", "_fence_gate")
_BY_POWER = "iron_"
_WAYS = ("_door", "_fence_gate")
_SWITCHES = ("lever", "_button")


def is_door(name: str) -> bool:
    """Return True if the block of that name opens and shuts: a door, a trapdoor or a fence gate."""
    return name.endswith(_KINDS)


def is_doorway(name: str) -> bool:
    """Whether one walks through the block of that name where it is open: a door or a fence gate."""
    return name.endswith(_WAYS)


def is_switch(name: str) -> bool:
    """Return True if the block of that name is switched by hand: a lever or a button."""
    return name.endswith(_SWITCHES)


def moves_by_hand(name: str) -> bool:
    """Return True if the door, trapdoor or gate of that name is not moved by power alone."""
    return is_door(name) and not name.startswith(_BY_POWER)


def passage(registry: Registry, state: int) -> tuple[int, int]:
    """Along which of x and z a door or gate is gone through: (1, 0) or (0, 1)."""
    return (0, 1) if registry.properties(state)["facing"] in ("north", "south") else (1, 0)


def is_open(registry: Registry, state: int) -> bool | None:
    """Return True if a door, trapdoor or gate stands open; None: the block is none."""
    return registry.properties(state)["open"] == "true" if is_door(registry.name(state)) else None


def used_door(
    registry: Registry, state_at: Callable[[Position], int], place: Position, *, opens: bool
) -> dict[Position, int]:
    """Return the new states of a door that is used by hand; it is where the first of them is.

    Args:
        registry: Names and properties of states.
        state_at: Block state at a position; air outside the world.
        place: Where the door is, either of its halves.
        opens: Whether it is opened or shut.

    Raises:
        WorldError: There is no door, it is so already, or it moves by power alone.
    """
    text = registry.text(state_at(place))
    name = registry.name(state_at(place))
    stands_open = is_open(registry, state_at(place))
    if stands_open is None:
        raise WorldError(f"there is no door, trapdoor or gate at {place}, but {text}")
    if not moves_by_hand(name):
        raise WorldError(f"the {name} at {place} is not moved by hand; set_block() changes it")
    if stands_open is opens:
        raise WorldError(f"the {name} at {place} is {'open' if opens else 'shut'} already")
    parts = [place]
    if name.endswith("_door"):
        x, y, z = place
        lower = registry.properties(state_at(place))["half"] == "lower"
        parts = [place, (x, y + 1, z)] if lower else [(x, y - 1, z), place]
    return {
        part: _moved(registry, state_at(part), opens)
        for part in parts
        if registry.name(state_at(part)) == name
    }


def _moved(registry: Registry, state: int, opens: bool) -> int:
    properties = {**registry.properties(state), "open": str(opens).lower()}
    inner = ",".join(f"{name}={value}" for name, value in properties.items())
    return registry.state_id(f"{registry.name(state)}[{inner}]")
