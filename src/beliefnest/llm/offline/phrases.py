"""Resolution of phrases in a task to known names."""

import re
from collections.abc import Iterable, Mapping, Sequence

from beliefnest.llm.offline.prompt_reading import points_in, words
from beliefnest.world.values import Point

_NOT_THERE = frozenset({"from", "leave", "leaves", "leaving", "left", "not"})
_ARTICLES = frozenset({"a", "an", "the"})


def singular(phrase: str) -> tuple[str, ...]:
    """Return the words of a phrase without plural endings."""
    return tuple(
        word[:-1] if word.endswith("s") and not word.endswith("ss") else word
        for word in words(phrase)
    )


def match_item(phrase: str, names: Iterable[str]) -> str | None:
    """Return the item that a phrase means.

    That is the item with the same words, or else the only item that ends with them: "iron
    ingots" means `iron_ingot`; "pickaxe" means `iron_pickaxe` if no other item ends so.
    """
    candidates = sorted(set(names))
    wanted = singular(phrase)
    exact = [name for name in candidates if singular(name) == wanted]
    if exact:
        return exact[0]
    ending = [name for name in candidates if wanted and singular(name)[-len(wanted) :] == wanted]
    return ending[0] if len(ending) == 1 else None


def match_name(phrase: str, names: Iterable[str]) -> str | None:
    """Return the name that a phrase means.

    That is the name with the same words, or else the only name whose words contain or are
    contained in the phrase: "ice cream seller" means `ice_cream_seller`, `IceCreamSeller` or
    `seller`.
    """
    candidates = sorted(set(names))
    wanted = [word for word in words(phrase) if word not in _ARTICLES] or list(words(phrase))
    for name in candidates:
        if "".join(words(name)) == "".join(wanted):
            return name
    shared = [name for name in candidates if words(name) and _within(set(words(name)), set(wanted))]
    return shared[0] if len(shared) == 1 else None


def _within(one: set[str], other: set[str]) -> bool:
    return one <= other or (bool(other) and other <= one)


def place_named_last(text: str, places: Mapping[str, Point]) -> Point | None:
    """Return the place or position that a sentence names last as someone's destination.

    Places after "from", "leave" or "not" are skipped.
    """
    mentions: list[tuple[int, Point]] = []
    for name, point in places.items():
        # Match short names with their case: the name "A" is not the article "a".
        flags = re.IGNORECASE if len(name) > 2 else re.NOFLAG
        for match in re.finditer(rf"\b{re.escape(name)}\b", text, flags):
            if not _speaks_of_leaving(words(text[: match.start()])):
                mentions.append((match.start(), point))
    mentions += [(len(text), point) for point in points_in(text)]
    return max(mentions, key=lambda each: each[0])[1] if mentions else None


def _speaks_of_leaving(before: Sequence[str]) -> bool:
    """Return True if the words before a place mean leaving it; articles and "to" are ignored."""
    rest = [word for word in before if word not in _ARTICLES | {"to", "at", "in", "go", "going"}]
    return bool(rest) and rest[-1] in _NOT_THERE
