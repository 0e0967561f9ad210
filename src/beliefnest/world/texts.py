"""Checks and display of texts that people, programs and models write."""

import re
import unicodedata

LONGEST_UTTERANCE = 256
"""Greatest number of characters in a line of chat, as in Minecraft."""

LONGEST_QUOTE = 80
"""Greatest number of characters of a value that a message quotes."""

MOST_UTTERANCES = 20
"""Greatest number of utterances and thoughts of an agent in a tick, as in Minecraft."""

_LAST_OF_FOUR_DIGITS = 0xFFFF

_LONG_NUMBER = 200
"""Number of bits above which the size of a whole number is told instead of its digits."""

_COMMANDS = frozenset({"Cc", "Cs", "Zl", "Zp"})
"""Unicode categories of control characters, line breaks and halves of surrogate pairs."""

_BIDIRECTIONAL = frozenset(
    "\u061c\u200e\u200f\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069"
)
"""Characters that change the direction of the text around them."""

_HIDDEN = re.compile(
    "\r(?!\n)|[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\xad\u0600-\u0605\u061c\u06dd\u070f\u180e\u200b\u200e\u200f"
    "\u2028-\u202e\u2060-\u206f\ufeff\ufff9-\ufffb\ud800-\udfff\U000e0000-\U000e007f]"
)
"""Characters that `visible` escapes: controls except tabs and line ends, marks of direction,
invisible characters."""

_FORMULA = re.compile(r"\s*[=+\-@\t\r\n\uff1d\uff0b\uff0d\uff20]")
_NUMBERS = re.compile(r"[-+]?[\d.][-+\d., eE]*", re.ASCII)


def is_well_formed(text: str) -> bool:
    """Return True if a text can be stored and sent: it has no half of a surrogate pair."""
    return text.isascii() or not any("\ud800" <= character <= "\udfff" for character in text)


def fault_of(text: str) -> str | None:
    """Return the fault of a text for an utterance, a thought or a name, or None.

    A valid text is one line of at most `LONGEST_UTTERANCE` characters without control
    characters.
    """
    if len(text) > LONGEST_UTTERANCE:
        return f"a text of {len(text)} characters; at most {LONGEST_UTTERANCE} can be said at once"
    command = next((character for character in text if _commands(character)), None)
    if command is not None:
        return f"a text with {escaped(command)} in it; give one line without control characters"
    return None


def escaped(text: str) -> str:
    r"""Escape control characters, line breaks and marks of direction, as `\u001b`."""
    if text.isascii() and text.isprintable():
        return text
    return visible("".join(_written(each) if _commands(each) else each for each in text))


def visible(text: str) -> str:
    r"""Escape hidden characters, as `\u202e`, for models and readers of pages; keep lines.

    Hidden characters are bidirectional controls, invisible characters and other controls.
    """
    if text.isascii() and text.isprintable():
        return text
    return _HIDDEN.sub(lambda match: _written(match[0]), text)


def visible_json(text: str) -> str:
    """Escape hidden characters inside the strings of a JSON text, see `visible`."""
    return _HIDDEN.sub(lambda match: "\\" + _written(match[0]), text)


def formula_free(text: str) -> str:
    """Return a text for a CSV cell; an apostrophe keeps spreadsheets from computing formulas.

    Numbers and positions such as `-2,-51,-4` stay as they are.
    """
    is_formula = _FORMULA.match(text) and not _NUMBERS.fullmatch(text)
    return f"'{text}" if is_formula else text


def on_one_line(text: str) -> str:
    """Return a text on one line: white space becomes single spaces, the rest is `escaped`."""
    return escaped(" ".join(text.split()))


def shortened(text: str, most: int = LONGEST_QUOTE) -> str:
    """Return at most `most` characters of a text on one line, `escaped`, for a message."""
    # Only what can be shown is escaped: the text may have millions of characters.
    line = on_one_line(text[: most + 1])
    return line if len(text) <= most and len(line) <= most else f"{line[: most - 3]}..."


def quoted(value: object, most: int = LONGEST_QUOTE) -> str:
    """Return a value of a file or an argument as messages quote it: `shortened`, in quotes.

    Only texts get quotes; other values are shown as Python writes them.
    """
    match value:
        case str():
            return f"'{shortened(value, most)}'"
        case int() if value.bit_length() > _LONG_NUMBER:
            # Python refuses to write very large whole numbers.
            return f"a number of {value.bit_length()} bits"
        case list() | tuple() | dict() | set() | bytes() if len(value) > most:
            return f"a {type(value).__name__} of {len(value):,}"
        case _:
            try:
                return shortened(repr(value), most)
            except ValueError:  # There is such a number in it.
                return f"a {type(value).__name__}"


def _commands(character: str) -> bool:
    return unicodedata.category(character) in _COMMANDS or character in _BIDIRECTIONAL


def _written(character: str) -> str:
    number = ord(character)
    return f"\\u{number:04x}" if number <= _LAST_OF_FOUR_DIGITS else f"\\U{number:08x}"
