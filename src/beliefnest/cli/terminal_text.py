"""Texts on a terminal: those of others, and counts."""

from beliefnest.world.texts import escaped

__all__ = ["counted", "printable"]


def printable(text: str) -> str:
    """Return a text that others wrote, with nothing in it that commands the terminal."""
    return "\n".join(escaped(line) for line in text.split("\n"))


def counted(number: int, noun: str) -> str:
    """Return a number with its noun: `1 round`, `2 rounds`."""
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"
