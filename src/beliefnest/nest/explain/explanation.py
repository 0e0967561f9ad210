"""Explanation of a belief, as a value and in words."""

from dataclasses import dataclass

from beliefnest.nest.explain.parts import BaseFact, Element, Level
from beliefnest.nest.explain.wording import explanation_lines
from beliefnest.nest.past.shown_words import html_lines


@dataclass(frozen=True, slots=True)
class Explanation:
    """Chain of perceptions behind a belief; `str()` puts it into words.

    Attributes:
        element: The explained element.
        tick: The tick of the explained state.
        fact: The element in the world that the beliefs are about.
        levels: The beliefs along the path, outermost first; empty for that world itself.
        before: Explanation of the belief at the fork, if that world is a branch on which the
            element has not changed; None otherwise.
    """

    element: Element
    tick: int
    fact: BaseFact
    levels: tuple[Level, ...]
    before: "Explanation | None" = None

    def __repr__(self) -> str:
        return f"<explanation at tick {self.tick}:\n{self}>"

    def _repr_html_(self) -> str:
        return html_lines(self.lines)

    def __str__(self) -> str:
        return "\n".join(self.lines)

    @property
    def lines(self) -> list[str]:
        """Return the chain in words."""
        lines = explanation_lines(self.element, self.fact, self.levels)
        if self.before is not None:
            lines.append(f"Before the fork at tick {self.before.tick}:")
            lines.extend(f"  {line}" for line in self.before.lines)
        return lines
