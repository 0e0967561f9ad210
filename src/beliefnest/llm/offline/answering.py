"""Answers of the offline model to questions, from the contents of a prompt.

The rules:

* Question about an item: the chest that holds it by the prompt; the answer is the name of a
  place there, if it has one.
* Question about a player: where the player is seen, else is said to be, else was last seen; the
  answer is the name of the nearest place within a few blocks.
* Question about a sign: its text. The sign is the one at the named place, or the only known one.
* Any other question, or missing information: the answer is that it is not known.
"""

import math
import re

from beliefnest.llm.offline.phrases import match_item, match_name, place_named_last, singular
from beliefnest.llm.offline.planning import believed_place
from beliefnest.llm.offline.prompt_reading import PromptReading, words
from beliefnest.world.values import Point

_NEAR = 3.0
_OPTION = re.compile(r"^([A-Z])\) (.+)$", re.MULTILINE)
_NOT_KNOWN = "I do not know"
_NOTHING = "I answer where an item or player is and what a sign says; nothing told me this."
_NO_TABLE = (
    "I read sections and the table of the template question, and no prose such as that of story; "
    "use the template question, or another model."
)


def answer_question(question: str, text: str, reading: PromptReading) -> str:
    """Return an answer in the requested form.

    Args:
        question: Text of the question.
        text: Full prompt, which may list options.
        reading: Contents of the prompt.
    """
    if "sign" in singular(question):
        names, reason = _sign(question, reading)
    else:
        place = _found(question, reading)
        names, reason = ([], "") if place is None else (_names(place[0], reading), place[1])
    if not names:
        rows = reading.position or reading.chests or reading.players or reading.signs
        return _said(_NOT_KNOWN, reason or (_NOTHING if rows else _NO_TABLE))
    options = [option for _, option in _OPTION.findall(text.rpartition("Options:")[2])]
    chosen = [option for option in options if any(_same(option, name) for name in names)]
    if options and len(chosen) != 1:
        return _said(_NOT_KNOWN, reason)
    return _said(chosen[0] if options else names[0], reason)


def _sign(question: str, reading: PromptReading) -> tuple[list[str], str]:
    """Return the text of the sign in question and the reason; no text if it is unclear."""
    near = place_named_last(question, reading.places)
    signs = [at for at in reading.signs if near is None or math.dist(at, near) <= _NEAR]
    if len(signs) != 1:
        return [], ""
    says = reading.signs[signs[0]]
    return [says or "nothing"], f"The sign at {_text(signs[0])} says so."


def _found(question: str, reading: PromptReading) -> tuple[Point, str] | None:
    asked = set(singular(question))
    named = {item for stored in reading.chests.values() for item in stored}
    items = [item for item in sorted(named) if set(singular(item)) <= asked]
    if items:
        item = match_item(items[-1], named) or items[-1]
        holding = [chest for chest, stored in reading.chests.items() if stored.get(item)]
        return (holding[0], f"{_text(holding[0])} holds {item}.") if len(holding) == 1 else None
    mentioned = [word for word in words(question) if match_name(word, reading.players) is not None]
    for word in reversed(mentioned):
        player = match_name(word, reading.players)
        place = None if player is None else believed_place(player, reading)
        if place is not None:
            return place, f"{player} is at {_text(place)}, as far as I know."
    return None


def _names(place: Point, reading: PromptReading) -> list[str]:
    """Return the names of a place, the nearest first, and its coordinates last."""
    far = {name: math.dist(place, there) for name, there in reading.places.items()}
    near = sorted((name for name in far if far[name] <= _NEAR), key=lambda name: far[name])
    exact = [name for name in near if far[name] == 0]
    return [*(exact or near[:1]), _text(place)]


def _same(option: str, name: str) -> bool:
    one, other = (
        [word for word in words(text) if word not in ("the", "a", "in", "at")]
        for text in (option, name)
    )
    return one == other


def _text(point: Point) -> str:
    return f"({', '.join(f'{value:g}' for value in point)})"


def _said(answer: str, reason: str) -> str:
    return f"Answer: {answer}\nReason: {reason}"
