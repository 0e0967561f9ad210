"""Planner of the offline model: a program for the task of a prompt.

If a task has several sentences, the planner takes the first one that it understands.

* Get N ITEM [from ...]: take the item from the nearest chest that holds enough by the prompt. If
  no chest holds enough, take it from several chests, the fullest first. If no known chest holds
  it, open all known chests, the nearest first. Chests at equal distance keep the order of the
  prompt, as do all chests if the own position is unknown.
* Go to X, where X is a position, a place or a player. A player is where it is seen; else at the
  place named last in the newest message that it said or that names it; else where the history
  last has it. Else the program searches the known places in the order of the prompt, then the
  four directions.
* Help X: get the item that X wants and give it to X. The wish of X is its task, if the prompt
  tells it ("X's task: Get ..."), else the last thing that X said it wants, needs or looks for.

For any other task the program only thinks a thought.
"""

import math
import re
from collections.abc import Sequence

import msgspec

from beliefnest.llm.offline import program_texts
from beliefnest.llm.offline.phrases import match_item, match_name, place_named_last, singular
from beliefnest.llm.offline.prompt_reading import PromptReading, points_in, words
from beliefnest.world.values import Point

_GO = re.compile(
    r"(?:please )?(?:go|walk|move|come|run|return|travel|head)(?: back| over)? to (?:the )?(.+)",
    re.IGNORECASE,
)
_FIND = re.compile(r"(?:please )?(?:find|meet|visit|look for) (?:the )?(.+)", re.IGNORECASE)
_GET = re.compile(
    r"(?:please )?(?:get|take|fetch|grab|obtain|collect|bring|find)(?: me)?"
    r"(?: (a|an|the|one|some|two|three|four|five|six|seven|eight|nine|ten|\d+))? (.+?)"
    r"(?: (?:from|out of|in|inside) (.+))?",
    re.IGNORECASE,
)
_HELP = re.compile(r"(?:please )?(?:help|assist|support) (?:the )?(.+)", re.IGNORECASE)
_WISH = re.compile(
    r".*\bI(?: am|'m)? (?:want|need|look for|looking for|would like)(?: to get)? (.+?)[.!?]*",
    re.IGNORECASE,
)
_SENTENCE_END = re.compile(r"(?<=[.!?])\s+")
_COUNTS = {
    word: count
    for count, word in enumerate(
        ("one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten"), start=1
    )
}


class _Wanted(msgspec.Struct, frozen=True):
    """Count, item and source as a task words them."""

    count: int
    phrase: str
    source: str | None


def plan(reading: PromptReading) -> str:
    """Return the program for the task of a prompt, as JavaScript."""
    sentences = (part.rstrip(".!? ") for part in _SENTENCE_END.split(reading.task))
    programs = (_plan_sentence(sentence, reading) for sentence in sentences)
    return next((program for program in programs if program), _not_understood(reading))


def _plan_sentence(task: str, reading: PromptReading) -> str | None:
    for form in (_GO, _FIND):
        going = form.fullmatch(task)
        program = _go(going[1], reading) if going is not None else None
        if program is not None:
            return program
    helping = _HELP.fullmatch(task)
    if helping is not None:
        return _help(helping[1], reading)
    wanted = _wanted(task)
    return None if wanted is None else _get(wanted, reading)


def _wanted(task: str) -> _Wanted | None:
    match = _GET.fullmatch(task)
    return None if match is None else _Wanted(_count(match[1]), match[2], match[3])


def _not_understood(reading: PromptReading) -> str:
    task = reading.task or "nothing"
    return program_texts.wonder(f"I do not understand the task, so I do nothing: {task}")


def _count(word: str | None) -> int:
    text = (word or "").lower()
    return int(text) if text.isdigit() else _COUNTS.get(text, 1)


def _get(wanted: _Wanted, reading: PromptReading) -> str:
    chests = _nearest_first(_chests_meant(wanted.source, reading), reading.position)
    item = _item_in(chests, wanted, reading)
    if item is not None:
        return program_texts.take_items(_takings(wanted.count, item, chests, reading))
    phrase = wanted.phrase
    names = list(dict.fromkeys(["_".join(words(phrase)), "_".join(singular(phrase))]))
    if not chests:
        return program_texts.wonder(f"I know of no chest that could hold {names[0]}.")
    return program_texts.search_chests(chests, names, wanted.count)


def _item_in(chests: Sequence[Point], wanted: _Wanted, reading: PromptReading) -> str | None:
    items = [name for chest in chests for name in reading.chests[chest]]
    return match_item(wanted.phrase, items)


def _help(phrase: str, reading: PromptReading) -> str | None:
    """Return a program that gets a player its wish; None if the phrase names no player."""
    player = match_name(phrase, reading.players)
    if player is None:
        return None
    wanted = _wish(player, reading)
    if wanted is None:
        return program_texts.wonder(f"I do not know what {player} needs.")
    chests = _nearest_first(_chests_meant(wanted.source, reading), reading.position)
    item = _item_in(chests, wanted, reading)
    if item is None:
        return program_texts.wonder(f"I know of no chest that holds {wanted.phrase} for {player}.")
    takings = _takings(wanted.count, item, chests, reading)
    count = sum(taken[item] for _, taken in takings)
    where = believed_place(player, reading)
    parts = [
        program_texts.take_items(takings),
        *([] if where is None else [program_texts.go_to(where)]),
        program_texts.give_item(player, item, count),
    ]
    return "\n".join(parts)


def _wish(player: str, reading: PromptReading) -> _Wanted | None:
    """Return the wish of a player, from its task or its own words."""
    their_task = reading.others_tasks.get(player)
    if their_task is not None:
        return _wanted(their_task.rstrip(".!? "))
    for heard in reversed(reading.chat):
        match = _WISH.fullmatch(heard.text) if heard.speaker == player else None
        if match is not None:
            return _wanted(f"get {match[1]}")
    return None


def _chests_meant(source: str | None, reading: PromptReading) -> list[Point]:
    """Return the chest whose position the task gives, or all known chests."""
    named = points_in(source or "")
    meant = [chest for chest in reading.chests if chest in named]
    return meant or list(reading.chests)


def _nearest_first(points: Sequence[Point], here: Point | None) -> list[Point]:
    if here is None:
        return list(points)
    return sorted(points, key=lambda point: round(math.dist(here, point), 3))


def _takings(
    count: int, item: str, chests: Sequence[Point], reading: PromptReading
) -> list[tuple[Point, dict[str, int]]]:
    """Return the chests to take from, in order, with the items to take."""
    holding = {chest: reading.chests[chest].get(item, 0) for chest in chests}
    enough = [chest for chest in chests if holding[chest] >= count]
    if enough:
        return [(enough[0], {item: count})]
    takings = []
    missing = count
    for chest in sorted(chests, key=lambda chest: -holding[chest]):
        taken = min(missing, holding[chest])
        if taken:
            takings.append((chest, {item: taken}))
            missing -= taken
    return takings


def _go(phrase: str, reading: PromptReading) -> str | None:
    """Return a program that goes to the place or player of a phrase; None if it is unknown."""
    named = points_in(phrase)
    if named:
        return program_texts.go_to(named[-1])
    player = match_name(phrase, reading.players)
    place = match_name(phrase, reading.places)
    if place is not None and (player is None or len(words(place)) > len(words(player))):
        return program_texts.go_to(reading.places[place])
    if player is None:
        return None
    where = believed_place(player, reading)
    if where is not None:
        return program_texts.go_to(where)
    return program_texts.look_for_player(player, list(reading.places.values()))


def believed_place(player: str, reading: PromptReading) -> Point | None:
    """Return where a player is seen, else is said to be, else was last seen."""
    return (
        reading.players[player] or _said_to_be_at(player, reading) or reading.sightings.get(player)
    )


def _said_to_be_at(player: str, reading: PromptReading) -> Point | None:
    """Return the last place in the newest message that a player said or that names the player."""
    for heard in reversed(reading.chat):
        if heard.speaker == player or set(words(player)) <= set(words(heard.text)):
            where = place_named_last(heard.text, reading.places)
            if where is not None:
                return where
    return None
