"""Sentences of text stories of the ToMi and Hi-ToM kind.

Sources: Le et al. 2019 (ToMi), He et al. 2023 (Hi-ToM). A line may begin with its number.
A name is one word, or several words joined by `_` or blanks. A line of stars ends a chapter
and has no other meaning. A sentence of another form is reported, never guessed.
"""

import re
from collections.abc import Iterable, Iterator
from contextlib import suppress
from typing import Annotated, Any

import msgspec
from msgspec.structs import replace

from beliefnest.errors import InputError
from beliefnest.world.texts import quoted

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
    """Agents leave a room together; None: the room in which they are."""

    agents: _Agents
    room: _Name | None = None


class Returned(_Sentence, frozen=True):
    """Agents enter the room again that they left last."""

    agents: _Agents


class Absent(_Sentence, frozen=True):
    """Agents are away while the next sentence happens; they leave, unless they did before."""

    agents: _Agents


class Present(_Sentence, frozen=True):
    """Names are in a place: agents in a room, or a thing in a container."""

    names: _Agents
    place: _Name


class Stayed(_Sentence, frozen=True):
    """Agents stay in a room and do nothing."""

    agents: _Agents
    room: _Name


class Located(_Sentence, frozen=True, tag="is"):
    """A thing is in a container, or a container is in a room, depending on the names."""

    thing: _Name
    place: _Name


class Moved(_Sentence, frozen=True, tag="move"):
    """An agent takes a thing out of its container and puts it into another.

    Attributes:
        agent: The agent.
        thing: The thing.
        container: Container that holds the thing afterwards.
        source: Container that holds the thing before; None: the line does not say it.
    """

    agent: Agent
    thing: _Name
    container: _Name
    source: _Name | None = None


class Placed(_Sentence, frozen=True, tag="put"):
    """An agent puts a thing into a container: as `Moved`, or out of its hands.

    If no earlier line says where the thing was, the agent had it from the beginning.
    """

    agent: Agent
    thing: _Name
    container: _Name


class Taken(_Sentence, frozen=True, tag="take"):
    """An agent takes a thing out of its container, and keeps it in its hands."""

    agent: Agent
    thing: _Name
    source: _Name | None = None


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
        hearer: Agent to whom it is said. Everybody there hears it, and nobody who is elsewhere.
    """

    agent: Agent
    thing: _Name
    container: _Name
    is_there: bool = True
    hearer: Agent | None = None


class Whispered(_Sentence, frozen=True, tag="whisper"):
    """An agent whispers to `hearer` what `Told` says aloud."""

    agent: Agent
    hearer: Agent
    thing: _Name
    container: _Name
    is_there: bool = True


class Wait(_Sentence, frozen=True, tag="wait"):
    """Nothing is done: a remark that changes neither the world nor any belief about it.

    Attributes:
        about: Name in the remark; None: it names nothing.
    """

    about: _Name | None = None


StoryEvent = (
    Entered
    | Exited
    | Located
    | Moved
    | Placed
    | Taken
    | Opened
    | UseDoor
    | Write
    | Told
    | Whispered
    | Wait
)
"""Sentence that can also be written as an object in JSON."""

Sentence = StoryEvent | Absent | Returned | Present | Stayed


class Line(msgspec.Struct, frozen=True):
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
        return InputError(f"{self.place}: {quoted(self.text)}: {what}")


IT = "it"
"""Thing that was named last."""

_ONE = r"[A-Za-z0-9_]{1,16}"
_AND = r"(?:,\s*(?:and\s+)?|\s+and\s+)"
_SOME = rf"{_ONE}(?:{_AND}{_ONE})*"
_AGENT, _HEARER, _AGENTS = rf"(?P<agent>{_ONE})", rf"(?P<hearer>{_ONE})", rf"(?P<agents>{_SOME})"
_WORD = (
    r"(?!(?:the|an?|in|into|inside|to|from|out|on|onto|up|and|with|for|that|is|are|was|were|after|"
    r"as|because|before|but|once|so|then|until|when|which|while|who|without)\b)"
    r"[\w'-]+"
)
"""Word of a name. A name with a word of the grammar in it is another sentence."""

_NAME = rf"(?=[A-Za-z0-9]){_WORD}(?: {_WORD})*?"
_NUMBER = re.compile(r"^\d+[.:)]?\s+")
_THEN = re.compile(
    r"(?:after that|afterwards?|finally|later|meanwhile|next|now|soon|then),? (?=[A-Z]|the )", re.I
)
"""Words that say no more than the order of the sentences."""
_THEN_DOES = re.compile(rf"^({_ONE}) then (?=[a-z])")
_SPACE = re.compile(r'(?P<text>"[^"]*")|\s+')
_JOINT = re.compile(_AND)
_A = r"(?:the|a|an|his|her|their)"
_THE = rf"(?:{_A} )?"
_ALL = r"(?:(?:both|all|together)\s+)?"
_THING = rf"{_THE}(?P<thing>{_NAME})"
_CONTAINER = rf"{_THE}(?P<container>{_NAME})"
_ROOM = rf"(?P<room>{_NAME})"
_PLACE = rf"{_THE}(?P<place>{_NAME})"
_IN = r"(?:in|inside|on)"
_INTO = r"(?:back )?(?:in|into|inside|on|onto)"
_TO = r"(?:back )?(?:into|inside|to)"
_FROM = rf"(?:from|out of) {_THE}(?P<source>{_NAME})"
_WALK = r"(?:came|comes|goes|ran|runs|stepped|steps|walked|walks|went)"
_PUTS = r"(?:drops|dropped|hid|hides|laid|left|leaves|placed|places|put|puts|stored|stores)"
_CARRIES = (
    r"(?:brings|brought|carried|carries|moved|moves|returned|returns|shifted|shifts|takes|took|"
    r"transferred|transfers)"
)
_TAKES = r"(?:fetched|fetches|grabbed|grabs|removed|removes|takes|took)"
_CLAIM = (
    rf"(?:that )?(?:the )?(?P<thing>{_NAME}) (?P<is_there>is|is not) in (?:the )?"
    rf"(?P<container>{_NAME})(?: now)?"
)
_NOBODY = re.compile(
    "he|she|it|they|him|her|them|his|their|we|you|i|this|that|there|here|someone|somebody|"
    "everyone|everybody|nobody|both|all",
    re.IGNORECASE | re.ASCII,
)
"""Words that name nobody and nothing."""


_FORMS: tuple[tuple[str, type[Any]], ...] = (
    (
        rf"{_AGENTS} {_ALL}(?:(?:re-?)?enter(?:ed|s)|{_WALK} (?:back )?(?:in|to|into|inside)|"
        rf"return(?:ed|s) to|arrive[ds] in) {_THE}{_ROOM}",
        Entered,
    ),
    (
        rf"{_AGENTS} {_ALL}(?:(?:re-?)enter(?:ed|s)|return(?:ed|s)|(?:came|comes|goes|went) back)"
        r"(?: in| inside)?",
        Returned,
    ),
    (
        rf"{_AGENTS} {_ALL}(?:left|leaves|exited|exits|departed|departs|"
        rf"{_WALK} (?:out|away|off|outside)(?: for a walk| to play)?)",
        Exited,
    ),
    (
        rf"{_AGENTS} {_ALL}(?:exit(?:ed|s)|left|leaves|{_WALK} out of) {_THE}(?:room|{_ROOM})",
        Exited,
    ),
    (rf"{_AGENTS} made no movements and stayed in (?:the )?{_ROOM}(?: for \d+ minutes?)?", Stayed),
    (rf"{_AGENT} {_CARRIES} {_THING}(?: {_FROM})? {_TO} {_CONTAINER}", Moved),
    (
        rf"{_AGENT} (?:{_TAKES}|picked up|picks up) {_THING}(?: {_FROM})? and {_PUTS} it {_INTO} "
        rf"{_CONTAINER}",
        Moved,
    ),
    (rf"{_AGENT} {_PUTS} {_THING} {_INTO} {_CONTAINER}", Placed),
    (rf"{_AGENT} (?:{_TAKES}|picked up|picks up) {_THING}(?: {_FROM})?", Taken),
    (rf"{_AGENT} (?:picked|picks|takes|took) {_THING} (?:up|out)(?: {_FROM})?", Taken),
    (
        rf"(?:The|the|An?|an?) (?P<thing>{_NAME}) (?:is|are|was|were) (?:now )?{_IN} {_PLACE}",
        Located,
    ),
    (rf"There (?:is|was) an? (?P<thing>{_NAME}) {_IN} {_PLACE}", Located),
    (rf"It (?:is|was) (?:now )?{_IN} {_PLACE}", Located),
    (rf"(?P<names>{_SOME}) {_ALL}(?:is|are|was|were) {_ALL}in {_PLACE}", Present),
    (rf"{_AGENT} (?P<opens>opened|shut|closed) the door of (?:the )?{_ROOM}", UseDoor),
    (rf'{_AGENT} wrote "(?P<text>[^"]*)" on the sign of (?:the )?{_ROOM}', Write),
    (rf"{_AGENT} (?:opens|opened|look(?:ed|s) (?:in|into|inside)) {_CONTAINER}", Opened),
    (rf"{_AGENT} (?:privately told|whispered to) {_HEARER} {_CLAIM}", Whispered),
    (rf"{_AGENT} (?:publicly claimed|said|told {_HEARER}) {_CLAIM}", Told),
    (rf"{_AGENTS} (?:dis)?likes? {_THE}(?P<about>{_NAME})", Wait),
    (rf"{_AGENTS} (?:hate|love)s? {_THE}(?P<about>{_NAME})", Wait),
    (rf"{_AGENTS} (?:saw|lost) {_A} (?P<about>{_NAME})", Wait),
    (rf"{_AGENT} (?:has|had) an? (?P<about>{_NAME})", Wait),
    (r"(?:The )?[Pp]hone rang", Wait),
)
"""Kinds of sentences; the groups of a form are fields of its kind."""

_KINDS = tuple((re.compile(form), kind) for form, kind in _FORMS)


_GONE = (
    r"(?:is|are|was|were) (?:absent|away|elsewhere|gone|out|outside|not (?:here|there|in the room))"
)
_LEAVING = (
    rf"(?:(?:has|have|had) (?:left|gone|gone out|gone outside)|left|leaves?|exited|exits?|"
    rf"{_WALK} (?:out|away|off|outside)|is gone)(?: {_THE}{_NAME})?"
)
_ABSENCE = (
    rf"(?:(?:[Aa]s|[Ww]hen|[Ww]hile|[Nn]ow that) {_AGENTS} {_GONE}|"
    rf"(?:[Aa]fter|[Aa]s soon as|[Oo]nce|[Ww]hen|[Nn]ow that) "
    rf"{_AGENTS.replace('agents', 'leavers')} {_LEAVING})"
)
_WITH_ABSENCE = (
    re.compile(rf"{_ABSENCE},? (?P<main>[A-Z].*|the .*)"),
    re.compile(rf"(?P<main>.+?),? {_ABSENCE}"),
)
"""Sentences about what happens while somebody is away."""
_TWO_DEEDS = re.compile(rf"(?P<agents>{_SOME}) .+?(?P<joint>,? and(?: then)?|,? then) (?=[a-z])")
_BEFORE_LEAVING = re.compile(
    rf"(?P<first>(?P<agents>{_SOME}) .+?),? before (?:leaving|exiting)(?P<room> {_THE}{_NAME})?"
)


def parse_clauses(number: int, text: str, unit: str = "line") -> tuple[Line, ...]:
    """Parse a sentence of prose, which may say several things one after the other.

    Raises:
        InputError: A part is no known sentence.
    """
    words = _SPACE.sub(lambda space: space["text"] or " ", text.strip()).removesuffix(".")
    for form in _WITH_ABSENCE:
        match = form.fullmatch(words)
        names = () if match is None else _JOINT.split(match["agents"] or match["leavers"])
        if match is not None and not any(map(_NOBODY.fullmatch, names)):
            away = Line(number, text, Absent(tuple(names)), unit)
            return (away, *_of(text, parse_clauses(number, match["main"], unit)))
    try:
        return (parse_line(number, text, unit),)
    except InputError:
        if parts := _parts(words, number, unit):
            return tuple(_of(text, parts))
        raise


def _of(text: str, lines: Iterable[Line]) -> Iterator[Line]:
    """Yield lines with the whole sentence as their text."""
    yield from (replace(each, text=text) for each in lines)


def _parts(words: str, number: int, unit: str) -> tuple[Line, ...]:
    """Return the sentences of two deeds of the same agents; empty: it has no such parts."""
    if match := _BEFORE_LEAVING.fullmatch(words):
        pair = (match["first"], f"{match['agents']} left{match['room'] or ''}")
    elif match := _TWO_DEEDS.match(words):
        pair = (words[: match.start("joint")], f"{match['agents']} {words[match.end() :]}")
    else:
        return ()
    with suppress(InputError):
        return tuple(line for each in pair for line in parse_clauses(number, each, unit))
    return ()


def parse_all(text: str) -> tuple[tuple[Line, ...], tuple[InputError, ...]]:
    """Return the sentences of a story, and an error for each line that is no known sentence.

    Lines that are blank or have only stars are left out.
    """
    lines: list[Line] = []
    faults: list[InputError] = []
    for number, line in enumerate(text.splitlines(), 1):
        if line.strip(" *"):
            try:
                lines.append(parse_line(number, line))
            except InputError as error:
                faults.append(error)
    return tuple(lines), tuple(faults)


def parse_lines(text: str) -> tuple[Line, ...]:
    """Return the sentences of a story, one for every line that is not blank.

    Raises:
        InputError: A line is no known sentence; the message gives its number.
    """
    lines, faults = parse_all(text)
    if faults:
        raise faults[0]
    return lines


def parse_line(number: int, text: str, unit: str = "line") -> Line:
    """Parse one sentence of a story: the line or event with a number.

    Raises:
        InputError: The text is no known sentence.
    """
    line = text.strip()
    return Line(number, line, _parse(line, f"{unit} {number}"), unit)


def _parse(line: str, place: str) -> Sentence:
    # Keep the text of a sign as it is.
    spaced = _SPACE.sub(lambda space: space["text"] or " ", _NUMBER.sub("", line, count=1))
    words = spaced.strip().removesuffix(".")
    if first := _THEN.match(words):
        words = words[first.end() :]
    words = _THEN_DOES.sub(r"\1 ", words)
    for form, kind in _KINDS:
        match = form.fullmatch(words)
        if match is not None:
            _check_names(match, place, line)
            return _sentence(kind, match)
    raise InputError(
        f"{place}: {quoted(line)} is no sentence of a story; write that someone entered, left, "
        "returned "
        "to or stayed in a room, moved, took or put a thing, opened a container, opened or shut "
        'the door of a room, wrote "..." on the sign of a room, said or whispered to someone that '
        "a thing is in a container, likes or dislikes something, or that a thing is in a container"
    )


def _sentence(kind: type[Any], match: re.Match[str]) -> Sentence:
    """Return the sentence of a match; a thing without a group is `it`."""
    parts: dict[str, Any] = {"thing": IT}
    for name, text in match.groupdict().items():
        match name:
            case _ if text is None:
                pass
            case "agents" | "names":
                parts[name] = tuple(dict.fromkeys(_JOINT.split(text)))
            case "is_there" | "opens":
                parts[name] = text in ("is", "opened")
            case _:
                parts[name] = text
    sentence: Sentence = kind(**{n: parts[n] for n in kind.__struct_fields__ if n in parts})
    return sentence


def _check_names(match: re.Match[str], place: str, line: str) -> None:
    """Refuse words in place of names; only a thing may be `it`."""
    for kind, names in match.groupdict().items():
        if kind in ("about", "opens", "is_there", "text") or names is None:
            continue
        for name in _JOINT.split(names) if kind in ("agents", "names") else (names,):
            if _NOBODY.fullmatch(name) and (kind, name) != ("thing", IT):
                raise InputError(
                    f"{place}: {quoted(line)}: {quoted(name)} is no name; write the name"
                )
