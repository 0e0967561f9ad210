"""States in short words for terminals and `repr`, and as escaped HTML for notebooks."""

from collections.abc import Iterable, Sequence
from html import escape

from beliefnest.belief.view import State
from beliefnest.pictures.palette import age_text
from beliefnest.world.signs import is_sign
from beliefnest.world.texts import visible
from beliefnest.world.values import Items, Point, Position

__all__ = [
    "html_lines",
    "html_table",
    "items_words",
    "place_words",
    "point_words",
    "state_words",
    "told_apart",
]

_MOST = 6
"""Number of containers that are listed; further ones are only counted."""


def point_words(point: Point | None) -> str:
    """Return a point in words."""
    return "place not known" if point is None else f"at {place_words(point)}"


def place_words(place: Point | Position) -> str:
    """Return a position in words."""
    return f"({', '.join(f'{value:.1f}'.removesuffix('.0') for value in place)})"


def items_words(items: Items, *, complete: bool) -> str:
    """Return contents in words, with a mark if there may be more."""
    told = ", ".join(f"{count} {name.replace('_', ' ')}" for name, count in sorted(items.items()))
    if complete:
        return told or "empty"
    return f"{told}, more?" if told else "nothing known"


def told_apart(texts: Sequence[str]) -> tuple[str, ...]:
    """Return blocks in words, with only the properties that distinguish them.

    Args:
        texts: Blocks as text for people, with the texts of signs.
    """
    words = {text: _block_words(text) for text in texts}
    alike = len(set(words.values())) < len(words)
    return tuple(text if alike else words[text] for text in texts)


def _block_words(text: str) -> str:
    block, _, says = text.partition(" that says ")
    name, _, properties = block.partition("[")
    kind = name.replace("_", " ")
    if is_sign(name):
        return f"{kind} that says {says}" if says else f"{kind} with nothing on it"
    for key, (on, off) in _STATES.items():
        if f"{key}=" in properties:
            return f"{kind}, {on if f'{key}=true' in properties else off}"
    return kind


_STATES = {"open": ("open", "shut"), "powered": ("on", "off"), "lit": ("lit", "out")}


def html_lines(lines: Iterable[str]) -> str:
    """Return lines of text as HTML that keeps leading spaces."""
    return f'<div style="white-space:pre-wrap">{_html(chr(10).join(lines))}</div>'


def html_table(headings: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table of texts as HTML."""
    head = "".join(f"<th>{_html(each)}</th>" for each in headings)
    body = "".join(f"<tr>{''.join(f'<td>{_html(cell)}</td>' for cell in row)}</tr>" for row in rows)
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def _html(text: str) -> str:
    return escape(visible(text))


def state_words(state: State) -> str:
    """Return the agents' places and the containers' contents of a state in words."""
    people = []
    for name, agent in sorted(state.agents.items()):
        words = f"{name} {point_words(agent.position)}"
        if agent.position is not None and not agent.current and agent.basis is not None:
            words += f", {age_text(state.tick - agent.basis.observed_at)}"
        people.append(words)
    stores = [
        f"{place_words(place)} {items_words(held.items, complete=held.complete)}"
        for place, held in sorted(state.containers.items())[:_MOST]
    ]
    more = len(state.containers) - len(stores)
    stores += [f"{more} more containers"] if more else []
    return "; ".join([*people, *stores])
