"""Names of places of a scenario, for people."""

from beliefnest.nest.past.setting import Setting
from beliefnest.world.near import names_near
from beliefnest.world.texts import on_one_line
from beliefnest.world.values import Point, Position

__all__ = ["container_name", "named_place", "point_text", "titled"]


def container_name(place: Position, setting: Setting) -> str:
    """Return the label of a container, or its position if it has none."""
    return on_one_line(setting.labels.get(place, f"({', '.join(map(str, place))})"))


def named_place(point: Point, setting: Setting) -> str:
    """Return a point as text: `at` with a named place near it, or with its coordinates."""
    names = names_near(point, {at: name for name, at in setting.places.items()})
    return f"at {names[0] if names else point_text(point)}"


def point_text(point: Point) -> str:
    """Return a point as text with exactly one decimal, as in tables."""
    return f"({', '.join(f'{value:.1f}' for value in point)})"


def titled(name: str) -> str:
    """Return an agent's name with a capital letter, for the start of a sentence."""
    return name[:1].upper() + name[1:]
