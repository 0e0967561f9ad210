"""Sentences of text stories of the ToMi and Hi-ToM kind.

Sources: Le et al. 2019 (ToMi), He et al. 2023 (Hi-ToM). A line may begin with its number.
A name is one word, or several words joined by `_` or blanks. A line of stars ends a chapter
and has no other meaning.
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
    """Agents enter a room together."""

    agents: tuple[str, ...]
    room: str


@dataclass(frozen=True, slots=True)
class Exited:
    """Agents leave a room together."""

    agents: tuple[str, ...]
    room: str


@dataclass(frozen=True, slots=True)
class Stayed:
    """Agents stay in a room and do nothing."""

    agents: tuple[str, ...]
    room: str


@dataclass(frozen=True, slots=True)
class Located:
    """A thing is in a container, or a container is in a room, depending on the names."""

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
    """An agent in a room writes on its sign and replaces the text there."""

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
    """An agent says that a thing is in a container, or that it is not there.

    Attributes:
        agent: Speaker.
        hearer: Agent to whom the speaker whispers; None: the speaker says it aloud.
        thing: The thing.
        container: The container.
        is_there: True if the speaker says that the thing is there, False if that it is not.
    """

    agent: str
    hearer: str | None
    thing: str
    container: str
    is_there: bool = True


@dataclass(frozen=True, slots=True)
class Remark:
    """A remark that changes neither the world nor any belief about it."""


Sentence = Entered | Exited | Stayed | Located | Moved | DoorUsed | Wrote | Opened | Told | Remark


@dataclass(frozen=True, slots=True)
class Line:
    """Sentence and its place in the story.

    Attributes:
        number: Number of the line in the text, or of the event in the list, from 1.
        text: The line as written.
        sentence: Parsed sentence.
        unit: What `number` counts: `line` or `event`.
    """

    number: int
    text: str
    sentence: Sentence
    unit: str = "line"

    @property
    def place(self) -> str:
        """Return the place of the sentence, such as `line 3`."""
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
        InputError: A line is no known sentence; the message gives its number.
    """
    return tuple(
        parse_line(number, line)
        for number, line in enumerate(text.splitlines(), 1)
        if line.strip(" *")
    )


def parse_line(number: int, text: str, unit: str = "line") -> Line:
    """Parse one sentence of a story: the line or event with a number.

    Raises:
        InputError: The text is no known sentence.
    """
    line = text.strip()
    return Line(number, line, _parse(line, f"{unit} {number}"), unit)


def _parse(line: str, place: str) -> Sentence:
    # Keep the text of a sign as it is.
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
