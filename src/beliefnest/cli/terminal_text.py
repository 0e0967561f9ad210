"""Texts of others on a terminal."""

from beliefnest.world.texts import escaped

__all__ = ["printable"]


def printable(text: str) -> str:
    """Return a text that others wrote, with nothing in it that commands the terminal."""
    return "\n".join(escaped(line) for line in text.split("\n"))
