"""Safe output of foreign texts on a terminal."""

import sys

from beliefnest.world.texts import escaped


def printable(text: str) -> str:
    """Return a foreign text with its control characters escaped; line breaks stay."""
    return "\n".join(escaped(line) for line in text.split("\n"))


def say(text: str) -> None:
    """Write a text to stdout, `printable`: what stands in files must not command a terminal."""
    sys.stdout.write(printable(text))
