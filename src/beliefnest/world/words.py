"""Places, items and events in words, for everything that people read."""

from collections.abc import Iterable

from beliefnest.world.values import Items

__all__ = ["counted", "items_words", "point_words"]


def point_words(point: Iterable[float], digits: int = 1) -> str:
    """Return a point or position such as `(2, -51, -4.5)`.

    Args:
        point: Coordinates in blocks.
        digits: Greatest number of decimals.
    """
    return f"({', '.join(f'{round(value, digits):.10g}' for value in point)})"


def items_words(items: Items, joint: str = ", ", *, ids: bool = False) -> str:
    """Return items as `1 diamond, 2 oak planks`, sorted by name; empty if there are none.

    Args:
        items: Counts by item name.
        joint: Text between two items.
        ids: True to keep names as Minecraft writes them, such as `oak_planks`.
    """
    return joint.join(
        f"{count} {name if ids else name.replace('_', ' ')}"
        for name, count in sorted(items.items())
    )


def counted(number: int, noun: str) -> str:
    """Return a number with its noun: `1 round`, `2 rounds`."""
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"
