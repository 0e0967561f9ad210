"""Safe output of foreign texts on a terminal."""

from beliefnest.world.texts import escaped

__all__ = ["printable"]


def printable(text: str) -> str:
    """Return a foreign text with its control characters escaped; line breaks stay."""
    return "\n".join(escaped(line) for line in text.split("\n"))
