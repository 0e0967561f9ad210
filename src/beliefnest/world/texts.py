"""Texts that people, programs and models write: what may be said, and how it is shown."""

import re
import unicodedata

__all__ = [
    "LONGEST_UTTERANCE",
    "escaped",
    "fault_of",
    "formula_free",
    "is_well_formed",
    "on_one_line",
    "visible",
    "visible_json",
]

LONGEST_UTTERANCE = 256
"""Characters of one line of chat, as in Minecraft."""

_LAST_OF_FOUR_DIGITS = 0xFFFF

_COMMANDS = frozenset({"Cc", "Cs", "Zl", "Zp"})
"""Unicode categories of what controls or breaks lines, or is half a character."""

_BIDIRECTIONAL = frozenset(
    "\u061c\u200e\u200f\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069"
)
"""Characters that turn the direction of the text around them."""

_HIDDEN = re.compile(
    "\r(?!\n)|[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\xad\u0600-\u0605\u061c\u06dd\u070f\u180e\u200b\u200e\u200f"
    "\u2028-\u202e\u2060-\u206f\ufeff\ufff9-\ufffb\ud800-\udfff\U000e0000-\U000e007f]"
)
"""Characters that `visible` writes out: controls but tab and line ends, marks of direction, text
that is not shown."""

_FORMULA = re.compile(r"[=+\-@\t\r\uff1d\uff0b\uff0d\uff20]")
_NUMBERS = re.compile(r"[-+]?[\d.][-+\d., eE]*", re.ASCII)


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
    return visible("".join(_written(each) if _commands(each) else each for each in text))


def visible(text: str) -> str:
    r"""Return a text as models and readers of pages get it: lines stay, hidden characters show.

    Bidirectional controls, invisible characters and controls are written out, as `\u202e`.
    """
    if text.isascii() and text.isprintable():
        return text
    return _HIDDEN.sub(lambda found: _written(found[0]), text)


def visible_json(text: str) -> str:
    """Return a JSON text in whose strings hidden characters show, see `visible`."""
    return _HIDDEN.sub(lambda found: "\\" + _written(found[0]), text)


def formula_free(text: str) -> str:
    """Return a text as a cell of a CSV file: an apostrophe keeps spreadsheets from computing it.

    Numbers and places, as `-2,-51,-4`, stay as they are.
    """
    is_formula = _FORMULA.match(text) and not _NUMBERS.fullmatch(text)
    return f"'{text}" if is_formula else text


def on_one_line(text: str) -> str:
    """Return a text as it stands among others: white space as single spaces, the rest `escaped`."""
    return escaped(" ".join(text.split()))


def _commands(character: str) -> bool:
    return unicodedata.category(character) in _COMMANDS or character in _BIDIRECTIONAL


def _written(character: str) -> str:
    number = ord(character)
    return f"\\u{number:04x}" if number <= _LAST_OF_FOUR_DIGITS else f"\\U{number:08x}"
