"""States in short words for terminals and `repr`, and as escaped HTML for notebooks."""

from collections.abc import Iterable, Sequence
from html import escape

from beliefnest.belief.grounds import told_text
from beliefnest.belief.view import State
from beliefnest.world.texts import visible
from beliefnest.world.values import Point
from beliefnest.world.words import contents_words, point_words

_MOST = 6
"""Number of containers that are listed; further ones are only counted."""


def where_words(point: Point | None) -> str:
    """Return where something is, in words; None: unknown."""
    return "place not known" if point is None else f"at {point_words(point)}"


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
        words = f"{name} {where_words(agent.position)}"
        if agent.position is not None and not agent.current and agent.basis is not None:
            basis = agent.basis
            age = state.tick - basis.observed_at
            words += f", {told_text(basis.source, basis.speaker or 'a sign', age)}"
        people.append(words)
    stores = [
        f"{point_words(place)} {contents_words(content.items, complete=content.complete)}"
        for place, content in sorted(state.containers.items())[:_MOST]
    ]
    more = len(state.containers) - len(stores)
    stores += [f"{more} more containers"] if more else []
    return "; ".join([*people, *stores])
