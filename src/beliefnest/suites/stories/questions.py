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
_WILL = "(?:will|would|does)"
_CHAIN = rf"(?P<chain>{_AGENT} {_THINK}(?: {_AGENT} {_THINK})*)"
_DOOR = r"the door of (?:the )?(?P<door>[A-Za-z0-9][\w' -]*?)"
_SIGN = r"the sign of (?:the )?(?P<sign>[A-Za-z0-9][\w' -]*?)"
_BEGINNING = re.compile(rf"Where was {_THING} (?:at|in) the beginning")
_FORMS = (
    re.compile(rf"Where is {_THING}(?: really| now)?"),
    _BEGINNING,
    re.compile(rf"Where {_WILL} (?P<who>{_AGENT}) (?:look for|search for|expect to find) {_THING}"),
    re.compile(
        rf"Where does {_CHAIN} (?:{_THING} (?:really )?is|(?P<who>{_AGENT}) "
        rf"(?:searches|looks|{_WILL} search|{_WILL} look) for {_THING.replace('thing', 'sought')})"
    ),
    re.compile(rf"Is {_DOOR} (?:really )?open"),
    re.compile(rf"Does {_CHAIN} {_DOOR} is open"),
    re.compile(rf"What does {_SIGN} (?:really )?say"),
    re.compile(rf"What does {_CHAIN} {_SIGN} says"),
)
_BELIEVER = re.compile(rf"({_AGENT}) {_THINK}(?: |$)")


def parse_question(text: str) -> Question:
    """Parse a question.

    Raises:
        InputError: The text is no known question.
    """
    words = " ".join(text.split()).removesuffix("?").rstrip()
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
