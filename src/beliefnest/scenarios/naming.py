"""Texts for places and items, for people."""

from beliefnest.world.values import Items, Point

__all__ = ["items_text", "place_text"]


def place_text(point: Point) -> str:
    """Return a place such as `(2, -51, -4)`; other than whole numbers have one decimal."""
    return f"({', '.join(f'{round(value, 1):g}' for value in point)})"


def items_text(items: Items) -> str:
    """Return items as `1 diamond, 2 apple`; `nothing` if there are none."""
    return ", ".join(f"{count} {name}" for name, count in sorted(items.items())) or "nothing"
