"""Questions about stories."""

import re

import msgspec
from msgspec.structs import replace

from beliefnest.errors import InputError
from beliefnest.world.texts import quoted


class Question(msgspec.Struct, frozen=True):
    """Question about the place of a thing, a door, or a sign, in reality or in a belief.

    Attributes:
        believers: Names of agents from the outermost believer inwards; empty: reality.
        thing: The thing; empty if the question is about a door or a sign.
        at_beginning: True if the question is about the beginning of the story, not its end.
        text: The question as written.
        door: Room of the door; None: the question is about no door.
        sign: Room of the sign; None: the question is about no sign.
    """

    believers: tuple[str, ...]
    thing: str
    at_beginning: bool
    text: str
    door: str | None = None
    sign: str | None = None

    @property
    def order(self) -> int:
        """Return the depth of the belief in question; 0 for reality."""
        return len(self.believers)

    @property
    def path(self) -> str:
        """Return the belief path of the question."""
        return "/" + "/".join(self.believers)


_AGENT = r"[A-Za-z0-9_]{1,16}"
_THING = r"(?:(?:the|his|her|their) )?(?P<thing>[A-Za-z0-9][\w' -]*?)"
_THINK = r"(?:really )?(?:thinks?|believes?)(?: that)?"
_WILL = "(?:will|would|does)"
_SEEK = (
    r"(?:first )?(?:(?:look|search)(?: first)? for|expect to find|try to find|go to (?:find|get))"
)
_CHAIN = rf"(?P<chain>{_AGENT} {_THINK}(?: {_AGENT} {_THINK})*)"
_DOOR = r"the door of (?:the )?(?P<door>[A-Za-z0-9][\w' -]*?)"
_SIGN = r"the sign of (?:the )?(?P<sign>[A-Za-z0-9][\w' -]*?)"
_BEGINNING = re.compile(rf"Where was {_THING} (?:at|in) the beginning")
_FORMS = (
    re.compile(rf"Where is (?P<who>{_AGENT}) going to {_SEEK} {_THING}(?: first)?"),
    re.compile(rf"Where is {_THING}(?: really| now| currently)?(?: located)?"),
    _BEGINNING,
    re.compile(rf"Where {_WILL} (?P<who>{_AGENT}) {_SEEK} {_THING}(?: first)?"),
    re.compile(rf"Where does (?P<who>{_AGENT}) (?:believe|expect) {_THING} to be"),
    re.compile(
        rf"Which \w+ {_WILL} (?P<who>{_AGENT}) (?:first )?(?:open|check|look in|search)(?: first)? "
        rf"(?:to find|to get|for) {_THING}"
    ),
    re.compile(rf"Does {_CHAIN} {_THING} is (?:in|inside) [\w' -]+ or (?:(?:in|inside) )?[\w' -]+"),
    re.compile(
        rf"Where does {_CHAIN} (?:{_THING} (?:really |now )?is(?: really| now)?(?: located)?"
        rf"(?: now)?|"
        rf"(?P<who>{_AGENT}) "
        rf"(?:searches|looks|{_WILL} search|{_WILL} look) for {_THING.replace('thing', 'sought')})"
    ),
    re.compile(rf"Is {_DOOR} (?:really )?open"),
    re.compile(rf"Does {_CHAIN} {_DOOR} is open"),
    re.compile(rf"What does {_SIGN} (?:really )?say"),
    re.compile(rf"What does {_CHAIN} {_SIGN} says"),
)
_BELIEVER = re.compile(rf"({_AGENT}) {_THINK}(?: |$)")


_RETURN = r"(?:comes back|gets back|returns|walks back|(?:re-?)?enters|arrives|wakes up)[^,]*"
_WHEN = re.compile(
    rf"(?:after|as|as soon as|once|when) (?P<who>{_AGENT}) {_RETURN}, (?P<asked>.+)", re.I
)
_END = r"(?:at|by|in) the end(?: of the story)?"
_RETURNING = r"(?:after|on|upon) (?:(?:her|his|their) return|coming back|returning)[^,]*"
_LEAD = re.compile(rf"(?:{_END}|{_RETURNING}), (?P<asked>.+)", re.I)
"""Clauses of time, which change nothing: until somebody is back, it learns nothing."""
_THEN = re.compile(
    rf"(?P<asked>.+?),? (?:(?:after|as soon as|once|when) (?:he|she|they|{_AGENT}) {_RETURN}|"
    rf"{_END}|{_RETURNING})",
    re.I,
)
_VIEW = re.compile(
    rf"(?:(?:from|in) (?P<of>{_AGENT})'s? (?:mind|opinion|perspective|point of view|view)|"
    rf"according to (?P<to>{_AGENT})), (?P<asked>.+)",
    re.I,
)
_PRONOUN = re.compile(r"\b(?:he|she|they)\b")


def parse_question(text: str) -> Question:
    """Parse a question.

    Raises:
        InputError: The text is no known question.
    """
    words = " ".join(text.replace("\u2019", "'").split()).removesuffix("?").rstrip()
    words = re.sub(
        r" precisely\b", "", re.sub(r"^in (?:which|what) \w+\b", "Where", words, flags=re.I)
    )
    words = re.sub(
        rf"^where do you think (?:that )?({_AGENT}) (will|would) ",
        r"Where \2 \1 ",
        words,
        flags=re.I,
    )
    if match := _LEAD.fullmatch(words):
        return replace(parse_question(match["asked"]), text=text)
    if match := _WHEN.fullmatch(words):
        return replace(parse_question(_PRONOUN.sub(match["who"], match["asked"], 1)), text=text)
    if (match := _THEN.fullmatch(words)) and " beginning" not in words:
        return replace(parse_question(match["asked"]), text=text)
    if match := _VIEW.fullmatch(words):
        inner = parse_question(match["asked"])
        return replace(inner, believers=(match["of"] or match["to"], *inner.believers), text=text)
    words = words[:1].upper() + words[1:]
    for form in _FORMS:
        if match := form.fullmatch(words):
            part = match.groupdict("")
            who = [part["who"]] if part.get("who") else []
            return Question(
                (*_BELIEVER.findall(part.get("chain", "")), *who),
                part.get("sought") or part.get("thing", ""),
                form is _BEGINNING,
                text,
                part.get("door"),
                part.get("sign"),
            )
    raise InputError(
        f"{quoted(text)} is no question about a story; ask 'Where is the X really?', 'Where was "
        "the X at the beginning?', 'Where will A look for the X?', 'Where does A think B thinks "
        "the X is?', 'Does A think the door of the R is open?' or 'What does A think the sign of "
        "the R says?'"
    )
