"""Questions about stories."""

import re
from dataclasses import dataclass

from beliefnest.errors import InputError
from beliefnest.world.texts import quoted


@dataclass(frozen=True, slots=True)
class Question:
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
_THING = r"(?:the )?(?P<thing>[A-Za-z0-9][\w' -]*?)"
_THINK = r"(?:really )?(?:thinks?|believes?)(?: that)?"
_REALITY = re.compile(rf"Where is {_THING}(?: really| now)?")
_BEGINNING = re.compile(rf"Where was {_THING} (?:at|in) the beginning")
_SEARCH = re.compile(rf"Where will (?P<who>{_AGENT}) (?:look|search) for {_THING}")
_BELIEF = re.compile(
    rf"Where does (?P<chain>{_AGENT} {_THINK}(?: {_AGENT} {_THINK})*) "
    rf"(?:{_THING} (?:really )?is|(?P<who>{_AGENT}) (?:searches|looks|will search|will look) for "
    rf"{_THING.replace('thing', 'sought')})"
)
_DOOR = r"the door of (?:the )?(?P<room>[A-Za-z0-9][\w' -]*?)"
_DOOR_REALITY = re.compile(rf"Is {_DOOR} (?:really )?open")
_DOOR_BELIEF = re.compile(
    rf"Does (?P<chain>{_AGENT} {_THINK}(?: {_AGENT} {_THINK})*) {_DOOR} is open"
)
_SIGN = r"the sign of (?:the )?(?P<room>[A-Za-z0-9][\w' -]*?)"
_SIGN_REALITY = re.compile(rf"What does {_SIGN} (?:really )?say")
_SIGN_BELIEF = re.compile(
    rf"What does (?P<chain>{_AGENT} {_THINK}(?: {_AGENT} {_THINK})*) {_SIGN} says"
)
_BELIEVER = re.compile(rf"({_AGENT}) {_THINK}(?: |$)")


def parse_question(text: str) -> Question:
    """Parse a question.

    Raises:
        InputError: The text is no known question.
    """
    words = " ".join(text.split()).removesuffix("?").rstrip()
    found = _about_a_thing(words, text) or _about_a_door(words, text) or _about_a_sign(words, text)
    if found is not None:
        return found
    raise InputError(
        f"{quoted(text)} is no question about a story; ask 'Where is the X really?', 'Where was "
        "the X "
        "at the beginning?', 'Where will A look for the X?', 'Where does A think B thinks the "
        "X is?', 'Does A think the door of the R is open?' or 'What does A think the sign of the "
        "R says?'"
    )


def _about_a_thing(words: str, text: str) -> Question | None:
    if match := _REALITY.fullmatch(words):
        return Question((), match["thing"], False, text)
    if match := _BEGINNING.fullmatch(words):
        return Question((), match["thing"], True, text)
    if match := _SEARCH.fullmatch(words):
        return Question((match["who"],), match["thing"], False, text)
    if match := _BELIEF.fullmatch(words):
        chain = tuple(_BELIEVER.findall(match["chain"]))
        if match["who"] is None:
            return Question(chain, match["thing"], False, text)
        return Question((*chain, match["who"]), match["sought"], False, text)
    return None


def _about_a_door(words: str, text: str) -> Question | None:
    if match := _DOOR_REALITY.fullmatch(words):
        return Question((), "", False, text, match["room"])
    if match := _DOOR_BELIEF.fullmatch(words):
        return Question(tuple(_BELIEVER.findall(match["chain"])), "", False, text, match["room"])
    return None


def _about_a_sign(words: str, text: str) -> Question | None:
    if match := _SIGN_REALITY.fullmatch(words):
        return Question((), "", False, text, sign=match["room"])
    if match := _SIGN_BELIEF.fullmatch(words):
        chain = tuple(_BELIEVER.findall(match["chain"]))
        return Question(chain, "", False, text, sign=match["room"])
    return None
