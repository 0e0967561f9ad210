"""Colours and signs of agents and of false, stale or unknown entries, for all views.

Pictures, the page, the terminal and plots take colours, letters and words from here. The colours
are those of Okabe and Ito ("Color Universal Design", 2008), which colour-blind readers can tell
apart. Colour is never the only distinction.
"""

import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from enum import StrEnum
from itertools import cycle

import msgspec

INK = "#2b2a33"
PAPER = "#fcfbf8"
QUIET = "#6a6870"

AGENT_COLOURS = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#F0E442", "#4D4D4D")
"""Blue, orange, bluish green, purple, sky blue, yellow, grey. Vermillion is reserved for false
entries."""

HYPOTHESIS_COLOURS = ("#332288", "#999933", "#882255", "#44AA99", "#CC6677", "#117733", "#AA4499")
"""Indigo, olive, wine, teal, rose, green, purple: goals and alternatives of inferences.

They are those of Paul Tol's scheme "muted" that differ from the colours of agents.
"""

_DARKEST_SHADE = "#08306b"
_DARK = frozenset({"#0072B2", "#009E73", "#4D4D4D", "#1A1A1A", "#8C510A", "#9E1B32"})
_NAMED: Mapping[str, str] = {
    "light blue": "#56B4E9",
    "light gray": "#4D4D4D",
    "black": "#1A1A1A",
    "blue": "#0072B2",
    "brown": "#8C510A",
    "cyan": "#56B4E9",
    "gray": "#4D4D4D",
    "green": "#009E73",
    "grey": "#4D4D4D",
    "lime": "#009E73",
    "magenta": "#CC79A7",
    "orange": "#E69F00",
    "pink": "#CC79A7",
    "purple": "#CC79A7",
    "red": "#9E1B32",
    "white": "#FFFFFF",
    "yellow": "#F0E442",
}
"""Colours by colour words, longer phrases first; from `AGENT_COLOURS` where possible."""

_COLOUR_WORD = re.compile(rf"\b({'|'.join(_NAMED)})\b")


class AgentLook(msgspec.Struct, frozen=True):
    """Look of one agent in all views.

    Attributes:
        name: Name of the agent.
        colour: `#RRGGBB`.
        ink: Colour of letters on `colour`.
        badge: Shortest beginning of its name that no other agent has, capitalised.
        rings: Number of rings around its disc, which tell agents of one colour apart; 0 for the
            first.
    """

    name: str
    colour: str
    ink: str
    badge: str
    rings: int


class Mark(StrEnum):
    """State of an entry of a belief."""

    CURRENT = "current"
    STALE = "stale"
    UNKNOWN = "unknown"
    INCOMPLETE = "incomplete"
    HEARD = "heard"
    FALSE = "false"


class MarkLook(msgspec.Struct, frozen=True):
    """Look of a mark.

    Attributes:
        colour: `#RRGGBB`.
        sign: Sign of the mark; empty if it needs none.
        style: Style of outlines: `solid`, `dashed`, `dotted` or `double`.
        words: Meaning, for legends and for labels that are read aloud.
    """

    colour: str
    sign: str
    style: str
    words: str


MARKS: Mapping[Mark, MarkLook] = {
    Mark.CURRENT: MarkLook(INK, "", "solid", "perceived at this tick"),
    Mark.STALE: MarkLook(QUIET, "~", "dashed", "remembered, not perceived at this tick"),
    Mark.UNKNOWN: MarkLook(QUIET, "?", "dotted", "not known"),
    Mark.INCOMPLETE: MarkLook(QUIET, "+?", "dotted", "perhaps more in it"),
    Mark.HEARD: MarkLook(QUIET, "\u201c\u201d", "dashed", "only told, not perceived"),
    Mark.FALSE: MarkLook("#D55E00", "\u00d7", "double", "false"),
}


def agent_looks(agents: Iterable[str]) -> dict[str, AgentLook]:
    """Return the looks of agents by name.

    Give all agents of a run, so that their looks are the same everywhere.
    """
    names = sorted(set(agents))
    colours, before = colours_of(names), Counter[str]()
    looks = {}
    for name in names:
        colour = colours[name]
        looks[name] = AgentLook(
            name=name,
            colour=colour,
            ink="#FFFFFF" if colour in _DARK else "#000000",
            badge=_badge(name, names),
            rings=before[colour],
        )
        before[colour] += 1
    return looks


def colours_of(names: Iterable[str]) -> dict[str, str]:
    """Return a colour for each name that agrees with the colour words of the names.

    A name with one colour word, such as "the blue box", gets that colour. The others get, in
    turn, colours of `AGENT_COLOURS` that no name mentions.
    """
    wanted = {name: _named_colour(name) for name in names}
    free = [colour for colour in AGENT_COLOURS if colour not in wanted.values()]
    rest = cycle(free or AGENT_COLOURS)
    return {name: colour or next(rest) for name, colour in wanted.items()}


def hypothesis_colours(goals: Iterable[str], alternatives: Iterable[str]) -> dict[str, str]:
    """Return a colour for each goal and alternative of a model, the same in all views.

    A goal and an alternative of one name share a colour.
    """
    names = dict.fromkeys([*goals, *alternatives])
    return dict(zip(names, cycle(HYPOTHESIS_COLOURS), strict=False))


def shades(names: Sequence[str]) -> dict[str, str]:
    """Return colours from light to dark for names that are ordered."""
    most = max(1, len(names) - 1)
    return {
        name: mix(PAPER, _DARKEST_SHADE, 0.08 + 0.82 * number / most)
        for number, name in enumerate(names)
    }


def _named_colour(name: str) -> str | None:
    """Return the colour that a name mentions; None if it mentions none, or several."""
    words = " ".join(re.findall("[a-z]+", name.lower()))
    colours = {_NAMED[word] for word in _COLOUR_WORD.findall(words)}
    return colours.pop() if len(colours) == 1 else None


def mix(first: str, second: str, share: float) -> str:
    """Return the colour at a given share of the way from one `#RRGGBB` to another."""
    one, other = bytes.fromhex(first[1:]), bytes.fromhex(second[1:])
    return "#" + bytes(round(a + (b - a) * share) for a, b in zip(one, other, strict=True)).hex()


def parts(colour: str) -> tuple[int, int, int]:
    """Return red, green and blue of a colour, `#RRGGBB`."""
    red, green, blue = bytes.fromhex(colour[1:])
    return red, green, blue


def _badge(name: str, names: list[str]) -> str:
    """Return a badge of at most three letters; a number tells longer equal beginnings apart."""
    for length in (1, 2, 3):
        beginning = name[:length].lower()
        if sum(other[:length].lower() == beginning for other in names) == 1:
            return name[:1].upper() + name[1:length]
    alike = [other for other in names if other[:1].lower() == name[:1].lower()]
    return f"{name[:1].upper()}{alike.index(name) + 1}"
