"""Texts that people, programs and models write: what may be said, and how it is shown."""

import unicodedata

__all__ = ["LONGEST_UTTERANCE", "escaped", "fault_of", "is_well_formed", "on_one_line"]

LONGEST_UTTERANCE = 256
"""Characters of one line of chat, as in Minecraft."""

_COMMANDS = frozenset({"Cc", "Cs", "Zl", "Zp"})
"""Unicode categories of what controls or breaks lines, or is half a character."""

_BIDIRECTIONAL = frozenset(
    "\u061c\u200e\u200f\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069"
)
"""What turns the direction of the text around it."""


def is_well_formed(text: str) -> bool:
    """Return True if a text can be stored and sent: it has no half of a surrogate pair in it."""
    return not any("\ud800" <= character <= "\udfff" for character in text)


def fault_of(text: str) -> str | None:
    """What is wrong with something to say, to think or to be called; None: nothing.

    It is one line of at most `LONGEST_UTTERANCE` characters, with nothing that controls a terminal.
    """
    if len(text) > LONGEST_UTTERANCE:
        return f"a text of {len(text)} characters; at most {LONGEST_UTTERANCE} can be said at once"
    found = next((character for character in text if _commands(character)), None)
    if found is not None:
        return f"a text with {escaped(found)} in it; give one line without control characters"
    return None


def escaped(text: str) -> str:
    r"""A text with all that controls, breaks lines or turns direction written out, as `\u001b`."""
    if text.isascii() and text.isprintable():
        return text
    return "".join(_written(character) if _commands(character) else character for character in text)


def on_one_line(text: str) -> str:
    """Return a text as it stands among others: white space as single spaces, the rest `escaped`."""
    return escaped(" ".join(text.split()))


def _commands(character: str) -> bool:
    return unicodedata.category(character) in _COMMANDS or character in _BIDIRECTIONAL


def _written(character: str) -> str:
    return f"\\u{ord(character):04x}"
