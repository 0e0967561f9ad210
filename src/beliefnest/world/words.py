"""Places, items, blocks and counts in words, for everything that people read."""

import difflib
from collections.abc import Container, Iterable, Sequence

from beliefnest.world.signs import is_sign
from beliefnest.world.texts import quoted
from beliefnest.world.values import Items

_DETERMINERS = frozenset({"the", "a", "an", "my", "his", "her", "our", "your", "their"})
_STATES = {"open": ("open", "shut"), "powered": ("on", "off"), "lit": ("lit", "out")}


def point_words(point: Iterable[float], digits: int = 1) -> str:
    """Return a point or position such as `(2, -51, -4.5)`.

    Args:
        point: Coordinates in blocks.
        digits: Greatest number of decimals.
    """
    return f"({', '.join(f'{round(value, digits):.10g}' for value in point)})"


def point_text(point: Iterable[float]) -> str:
    """Return a point as text with exactly one decimal, as in tables."""
    return f"({', '.join(f'{value:.1f}' for value in point)})"


def items_words(items: Items, joint: str = ", ", *, ids: bool = False, ones: bool = True) -> str:
    """Return items as `1 diamond, 2 oak planks`, sorted by name; empty if there are none.

    Args:
        items: Counts by item name.
        joint: Text between two items.
        ids: True to keep names as Minecraft writes them, such as `oak_planks`.
        ones: False to leave out the number 1.
    """
    counts = sorted(items.items())
    words = [name if n == 1 and not ones else f"{n} {name}" for name, n in counts]
    return joint.join(words if ids else (each.replace("_", " ") for each in words))


def things_words(items: Items, unique: Container[str] = ()) -> str:
    """Return items as prose, such as `a diamond and 2 oak planks`; empty if there are none.

    Args:
        items: Counts by item name.
        unique: Items of which there is only one; they get `the`.
    """
    return listed([_thing(name, count, name in unique) for name, count in sorted(items.items())])


def _thing(name: str, count: int, is_unique: bool = False) -> str:
    words = name.replace("_", " ")
    if is_unique and count == 1:
        return f"the {words}"
    if count > 1:
        return f"{count} {words if words.endswith('s') else f'{words}s'}"
    if words.endswith("s") and not words.endswith("ss"):
        return words
    return f"{'an' if words[0] in 'aeiou' else 'a'} {words}"


def listed(parts: Sequence[str], last: str = "and") -> str:
    """Return parts as a list in prose: `a`, `a and b`, `a, b and c`."""
    if len(parts) < 2:  # a list of one has no joint
        return "".join(parts)
    return f"{', '.join(parts[:-1])} {last} {parts[-1]}"


def with_the(name: str) -> str:
    """Return a name with `the`, unless it is a proper name or has a determiner.

    A name is proper if its first word is written with a capital letter or has the ending `'s`, or
    if it begins with something other than a letter, such as a position.
    """
    first, *_ = name.split(maxsplit=1) or [""]
    bare = not first[:1].isalpha() or first[:1].isupper() or first.endswith(("'s", "\u2019s"))
    return name if bare or first in _DETERMINERS else f"the {name}"


def contents_words(items: Items, *, complete: bool, ones: bool = True) -> str:
    """Return contents in words, with a mark if there may be more."""
    words = items_words(items, ones=ones)
    if complete:
        return words or "empty"
    return f"{words}, more?" if words else "nothing known"


def told_apart(texts: Sequence[str]) -> tuple[str, ...]:
    """Return blocks in words, with only the properties that distinguish them.

    Args:
        texts: Blocks as text for people, with the texts of signs.
    """
    words = {text: _block_words(text) for text in texts}
    alike = len(set(words.values())) < len(words)
    return tuple(text if alike else words[text] for text in texts)


def _block_words(text: str) -> str:
    block, _, says = text.partition(" that says ")
    name, _, properties = block.partition("[")
    kind = name.replace("_", " ")
    if is_sign(name):
        return f"{kind} that says {says}" if says else f"{kind} with nothing on it"
    for key, (on, off) in _STATES.items():
        if f"{key}=" in properties:
            return f"{kind}, {on if f'{key}=true' in properties else off}"
    return kind


def counted(number: int, noun: str) -> str:
    """Return a number with its noun: `1 round`, `2 rounds`, `2 histories`."""
    many = f"{noun[:-1]}ies" if noun.endswith("ry") else f"{noun}s"
    return f"{number} {noun if number == 1 else many}"


def nearest_or_all(name: str, names: Sequence[str], listing: str = "there are") -> str:
    """Return the end of a message about an unknown name: a similar name, or else all names.

    Args:
        name: The unknown name.
        names: All names that exist.
        listing: Words before the list of all names.
    """
    close = difflib.get_close_matches(name, names)
    if not close:
        return f"; {listing} {', '.join(names) or 'none'}"
    # Letters in another order are the likeliest slip.
    nearest = min(close, key=lambda each: sorted(each) != sorted(name))
    return f"; did you mean {quoted(nearest)}?"


def titled(name: str) -> str:
    """Return a name with a capital letter, for the start of a sentence."""
    return name[:1].upper() + name[1:]
