"""Sentences of text stories of the ToMi and Hi-ToM kind.

Sources: Le et al. 2019 (ToMi), He et al. 2023 (Hi-ToM). A line may begin with its number.
A name is one word, or several words joined by `_` or blanks. A line of stars ends a chapter
and has no other meaning.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated

import msgspec

from beliefnest.errors import InputError

__all__ = [
    "Agent",
    "Entered",
    "Exited",
    "Line",
    "Located",
    "Moved",
    "Opened",
    "Sentence",
    "Stayed",
    "Told",
    "UseDoor",
    "Wait",
    "Whispered",
    "Write",
    "parse_line",
    "parse_lines",
]

Agent = Annotated[str, msgspec.Meta(pattern=r"^[A-Za-z0-9_]{1,16}$")]
_Agents = Annotated[tuple[Agent, ...], msgspec.Meta(min_length=1)]
_Name = Annotated[str, msgspec.Meta(min_length=1, max_length=100)]


class _Sentence(msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag_field="event"):
    """Sentence of a story; in JSON the key `event` names its kind."""


class Entered(_Sentence, frozen=True, tag="enter"):
    """Agents enter a room together."""

    agents: _Agents
    room: _Name


class Exited(_Sentence, frozen=True, tag="leave"):
    """Agents leave a room together."""

    agents: _Agents
    room: _Name


class Stayed(_Sentence, frozen=True):
    """Agents stay in a room and do nothing."""

    agents: _Agents
    room: _Name


class Located(_Sentence, frozen=True, tag="is"):
    """A thing is in a container, or a container is in a room, depending on the names."""

    thing: _Name
    place: _Name


class Moved(_Sentence, frozen=True, tag="move"):
    """An agent takes a thing out of its container and puts it into another."""

    agent: Agent
    thing: _Name
    container: _Name


class UseDoor(_Sentence, frozen=True, tag="door"):
    """An agent in a room opens or shuts its door."""

    agent: Agent
    room: _Name
    opens: bool = msgspec.field(name="open")


class Write(_Sentence, frozen=True, tag="write"):
    """An agent in a room writes on its sign and replaces the text there."""

    agent: Agent
    room: _Name
    text: str


class Opened(_Sentence, frozen=True, tag="open"):
    """An agent opens a container, looks into it and shuts it."""

    agent: Agent
    container: _Name


class Told(_Sentence, frozen=True, tag="tell"):
    """An agent says aloud that a thing is in a container, or that it is not there.

    Attributes:
        agent: Speaker.
        thing: The thing.
        container: The container.
        is_there: True if the speaker says that the thing is there, False if that it is not.
    """

    agent: Agent
    thing: _Name
    container: _Name
    is_there: bool = True


class Whispered(_Sentence, frozen=True, tag="whisper"):
    """An agent whispers to `hearer` what `Told` says aloud."""

    agent: Agent
    hearer: Agent
    thing: _Name
    container: _Name
    is_there: bool = True


class Wait(_Sentence, frozen=True, tag="wait"):
    """Nothing is done: a remark that changes neither the world nor any belief about it."""


Sentence = (
    Entered | Exited | Stayed | Located | Moved | UseDoor | Write | Opened | Told | Whispered | Wait
)


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
    return Told(match["agent"], match["thing"], match["container"], match["link"] == "is")


def _whispered(match: re.Match[str]) -> Whispered:
    told = _told(match)
    return Whispered(told.agent, match["hearer"], told.thing, told.container, told.is_there)


def _remark(_: re.Match[str]) -> Wait:
    return Wait()


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
        lambda match: UseDoor(match["agent"], match["room"], match["how"] == "opened"),
    ),
    (
        rf'(?P<agent>{_AGENT}) wrote "(?P<text>[^"]*)" on the sign of '
        rf"(?:the )?(?P<room>{_NAME})",
        lambda match: Write(match["agent"], match["room"], match["text"]),
    ),
    (
        rf"(?P<agent>{_AGENT}) (?:opened|looked into) (?:the )?(?P<container>{_NAME})",
        lambda match: Opened(match["agent"], match["container"]),
    ),
    (
        rf"(?P<agent>{_AGENT}) (?:privately told|whispered to) (?P<hearer>{_AGENT}) {_CLAIM}",
        _whispered,
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
