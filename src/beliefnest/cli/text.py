"""Texts of others on a terminal."""

__all__ = ["printable"]


def printable(text: str) -> str:
    """A text that others wrote, with nothing in it that commands the terminal."""
    return "".join(c if c.isprintable() or c == "\n" else "\ufffd" for c in text)
