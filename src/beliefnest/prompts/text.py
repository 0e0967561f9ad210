"""Formats of values in prompts, as in the paper's appendix."""

import difflib
import json
from collections.abc import Iterable, Mapping
from typing import Final

from beliefnest.world.values import Point, Position

NO_DATA: Final = "No data"
CANNOT_BE_SEEN: Final = "Cannot be seen"
NOT_OBSERVED: Final = "Not observed"
NO_CHATS: Final = "No chats"
NO_THOUGHT: Final = "No thought"
EMPTY: Final = "Empty"


def number(value: float) -> str:
    """Return a number with at most three decimals, without trailing zeros or `-0`."""
    text = f"{value:.3f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def point(value: Point) -> str:
    """Return a point as `[x, y, z]`."""
    return f"[{', '.join(number(part) for part in value)}]"


def position(value: Position) -> str:
    """Return a block position as `(x, y, z)`."""
    return f"({', '.join(number(part) for part in value)})"


def mapping(values: Mapping[str, object]) -> str:
    """Return names and values as `{'diamond': 1}`, sorted by name."""
    return repr(dict(sorted(values.items())))


def as_json(value: object) -> str:
    """Return a value as JSON on several lines, indented by two spaces."""
    return json.dumps(value, indent=2, ensure_ascii=False)


def nearest(name: str, names: Iterable[str]) -> str:
    """Return the end of a message about an unknown name: similar names, or else all names."""
    candidates = sorted(names)
    close = difflib.get_close_matches(name, candidates, n=3, cutoff=0.5)
    if close:
        return f"; did you mean {' or '.join(close)}?"
    return f"; there is {', '.join(candidates)}" if candidates else ""
