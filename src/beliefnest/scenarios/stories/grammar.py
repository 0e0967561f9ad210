"""The sentences of text stories of the ToMi and Hi-ToM kind.

Sources: Le et al. 2019 (ToMi), He et al. 2023 (Hi-ToM). A line may begin with its number;
a name is one word, or several joined by `_` or blanks. A line of nothing but stars ends a
chapter and says nothing.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass

from beliefnest.errors import InputError

__all__ = [
    "DoorUsed",
    "Entered",
    "Exited",
    "Line",
    "Located",
    "Moved",
    "Opened",
    "Remark",
    "Sentence",
    "Stayed",
    "Told",
    "Wrote",
    "parse_line",
    "parse_lines",
]


@dataclass(frozen=True, slots=True)
class Entered:
    """Agents come into a room, together."""

    agents: tuple[str, ...]
    room: str


@dataclass(frozen=True, slots=True)
class Exited:
    """Agents leave a room, together."""

    agents: tuple[str, ...]
    room: str


@dataclass(frozen=True, slots=True)
class Stayed:
    """Agents stay in a room and do nothing."""

    agents: tuple[str, ...]
    room: str


@dataclass(frozen=True, slots=True)
class Located:
    """A thing is in a container, or a container in a room: the names tell which."""

    thing: str
    place: str


@dataclass(frozen=True, slots=True)
class Moved:
    """An agent takes a thing out of its container and puts it into another."""

    agent: str
    thing: str
    container: str


@dataclass(frozen=True, slots=True)
class DoorUsed:
    """An agent in a room opens or shuts its door."""

    agent: str
    room: str
    opens: bool


@dataclass(frozen=True, slots=True)
class Wrote:
    """An agent in a room writes on its sign, over what is there."""

    agent: str
    room: str
    text: str


@dataclass(frozen=True, slots=True)
class Opened:
    """An agent opens a container, looks into it and shuts it."""

    agent: str
    container: str


@dataclass(frozen=True, slots=True)
class Told:
    """An agent says that a thing is in a container, or that it is not; true or not.

    Attributes:
        agent: Who says it.
        hearer: To whom it is whispered; None: it is said aloud.
        thing: What it is about.
        container: Where that is said to be.
        is_there: Whether it is said to be there, and not to be elsewhere.
    """

    agent: str
    hearer: str | None
    thing: str
    container: str
    is_there: bool = True


@dataclass(frozen=True, slots=True)
class Remark:
    """Something that changes neither the world nor what anyone knows of it."""


Sentence = Entered | Exited | Stayed | Located | Moved | DoorUsed | Wrote | Opened | Told | Remark


@dataclass(frozen=True, slots=True)
class Line:
    """A sentence and where it stands.

    Attributes:
        number: Line of the story's text, or event of its list, from 1.
        text: The line as it is written.
        sentence: What it says.
        unit: What is counted: `line` or `event`.
    """

    number: int
    text: str
    sentence: Sentence
    unit: str = "line"

    @property
    def place(self) -> str:
        """Where it stands, as `line 3`."""
        return f"{self.unit} {self.number}"

    def fault(self, what: str) -> InputError:
        """Return the error to raise for this line."""
        return InputError(f"{self.place}: {self.text!r}: {what}")


_AGENT = r"[A-Za-z0-9_]{1,16}"
_AND = r"(?:,\s*(?:and\s+)?|\s+and\s+)"
_AGENTS = rf"(?P<agents>{_AGENT}(?:{_AND}{_AGENT})*)"
_NAME = r"[A-Za-z0-9][\w'-]*(?: [\w'-]+)*?"
_NUMBER = re.compile(r"^\d+[.:)]?\s+")
_SPACE = re.compile(r'(?P<text>"[^"]*")|\s+')
_JOINT = re.compile(_AND)
_A = r"(?:the|a|an|his|her|their)"
_ALL = r"(?:(?:both|all|together)\s+)?"
_CLAIM = (
    rf"(?:that )?(?:the )?(?P<thing>{_NAME}) (?P<link>is|is not) in (?:the )?"
    rf"(?P<container>{_NAME})(?: now)?"
)


def _agents(match: re.Match[str]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(_JOINT.split(match["agents"])))


def _told(match: re.Match[str]) -> Told:
    hearer = match.groupdict().get("hearer")
    there = match["link"] == "is"
    return Told(match["agent"], hearer, match["thing"], match["container"], there)


def _remark(_: re.Match[str]) -> Remark:
    return Remark()


_FORMS: tuple[tuple[str, Callable[[re.Match[str]], Sentence]], ...] = (
    (
        rf"{_AGENTS} {_ALL}(?:re-?)?entered (?:the )?(?P<room>{_NAME})",
        lambda match: Entered(_agents(match), match["room"]),
    ),
    (
        rf"{_AGENTS} {_ALL}(?:exited|left) (?:the )?(?P<room>{_NAME})",
        lambda match: Exited(_agents(match), match["room"]),
    ),
    (
        rf"{_AGENTS} made no movements and stayed in (?:the )?(?P<room>{_NAME})"
        r"(?: for \d+ minutes?)?",
        lambda match: Stayed(_agents(match), match["room"]),
    ),
    (
        rf"(?P<agent>{_AGENT}) moved (?:the )?(?P<thing>{_NAME}) (?:in)?to (?:the )?"
        rf"(?P<container>{_NAME})",
        lambda match: Moved(match["agent"], match["thing"], match["container"]),
    ),
    (
        rf"[Tt]he (?P<thing>{_NAME}) (?:is|was) in (?:the )?(?P<place>{_NAME})",
        lambda match: Located(match["thing"], match["place"]),
    ),
    (
        rf"(?P<agent>{_AGENT}) (?P<how>opened|shut|closed) the door of (?:the )?(?P<room>{_NAME})",
        lambda match: DoorUsed(match["agent"], match["room"], match["how"] == "opened"),
    ),
    (
        rf'(?P<agent>{_AGENT}) wrote "(?P<text>[^"]*)" on the sign of '
        rf"(?:the )?(?P<room>{_NAME})",
        lambda match: Wrote(match["agent"], match["room"], match["text"]),
    ),
    (
        rf"(?P<agent>{_AGENT}) (?:opened|looked into) (?:the )?(?P<container>{_NAME})",
        lambda match: Opened(match["agent"], match["container"]),
    ),
    (
        rf"(?P<agent>{_AGENT}) (?:privately told|whispered to) (?P<hearer>{_AGENT}) {_CLAIM}",
        _told,
    ),
    (
        rf"(?P<agent>{_AGENT}) (?:publicly claimed|said|told {_AGENT}) {_CLAIM}",
        _told,
    ),
    (rf"{_AGENTS} (?:dis)?likes? (?:{_A} )?{_NAME}", _remark),
    (rf"{_AGENTS} (?:hate|love)s? (?:{_A} )?{_NAME}", _remark),
    (rf"{_AGENTS} (?:saw|lost) {_A} {_NAME}", _remark),
    (r"(?:The )?[Pp]hone rang", _remark),
)
_KINDS = tuple((re.compile(form), make) for form, make in _FORMS)


def parse_lines(text: str) -> tuple[Line, ...]:
    """Return the sentences of a story, one for every line that is not blank.

    Raises:
        InputError: A line is none of the sentences known; the message gives its number.
    """
    return tuple(
        parse_line(number, line)
        for number, line in enumerate(text.splitlines(), 1)
        if line.strip(" *")
    )


def parse_line(number: int, text: str, unit: str = "line") -> Line:
    """Return one sentence of a story, the line or event of that number.

    Raises:
        InputError: It is none of the sentences known.
    """
    line = text.strip()
    return Line(number, line, _parse(line, f"{unit} {number}"), unit)


def _parse(line: str, place: str) -> Sentence:
    # What is written on a sign stays as it is.
    spaced = _SPACE.sub(lambda found: found["text"] or " ", _NUMBER.sub("", line, count=1))
    words = spaced.strip().removesuffix(".")
    for form, make in _KINDS:
        match = form.fullmatch(words)
        if match is not None:
            return make(match)
    raise InputError(
        f"{place}: {line!r} is no sentence of a story; write that someone entered, exited "
        "or stayed in a room, moved a thing to a container, opened a container, opened or shut "
        'the door of a room, wrote "..." on the sign of a room, said or whispered to someone that '
        "a thing is in a container, likes "
        "or dislikes something, or that a thing is in a container"
    )
