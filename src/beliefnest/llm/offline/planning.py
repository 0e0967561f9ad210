"""From what a prompt says to a program for its task.

Get N ITEM [from ...]: of the chests that are said to hold enough of it, the nearest; if none
holds enough, those that hold most of it first, until there is enough. If no chest is said to
hold it, all known chests are opened, nearest first. Chests at the same distance keep the order
of the prompt; without a known position so do all.

Go to X: a position; a place of that name; a player: where it is seen, else the place named
last in the newest message that it said or that names it, else it is looked for, in the known
places in the order of the prompt and then in the four directions.

Anything else is thought about and nothing is done.
"""

import math
import re
from collections.abc import Sequence

from beliefnest.llm.offline import javascript
from beliefnest.llm.offline.naming import match_item, match_name, place_named_last, singular
from beliefnest.llm.offline.reading import Point, Reading, points_in, words

__all__ = ["plan"]

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
_COUNTS = {
    word: count
    for count, word in enumerate(
        ("one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten"), start=1
    )
}


def plan(reading: Reading) -> str:
    """The program for the task of a prompt, as JavaScript."""
    task = reading.task.strip().rstrip(".!").strip()
    going = _GO.fullmatch(task)
    if going is not None:
        return _go(going[1], reading) or _not_understood(reading)
    finding = _FIND.fullmatch(task)
    if finding is not None:
        found = _go(finding[1], reading)
        if found is not None:
            return found
    getting = _GET.fullmatch(task)
    if getting is not None:
        return _get(_count(getting[1]), getting[2], getting[3], reading)
    return _not_understood(reading)


def _not_understood(reading: Reading) -> str:
    task = reading.task or "nothing"
    return javascript.wonder(f"I do not understand the task, so I do nothing: {task}")


def _count(word: str | None) -> int:
    text = (word or "").lower()
    return int(text) if text.isdigit() else _COUNTS.get(text, 1)


def _get(count: int, phrase: str, source: str | None, reading: Reading) -> str:
    chests = _nearest_first(_chests_meant(source, reading), reading.position)
    held = [name for chest in chests for name in reading.chests[chest]]
    item = match_item(phrase, held)
    if item is not None:
        return javascript.take_items(_takings(count, item, chests, reading))
    names = list(dict.fromkeys(["_".join(words(phrase)), "_".join(singular(phrase))]))
    if not chests:
        return javascript.wonder(f"I know of no chest that could hold {names[0]}.")
    return javascript.search_chests(chests, names, count)


def _chests_meant(source: str | None, reading: Reading) -> list[Point]:
    """All known chests, or the one whose position the task gives."""
    given = points_in(source or "")
    meant = [chest for chest in reading.chests if chest in given]
    return meant or list(reading.chests)


def _nearest_first(points: Sequence[Point], here: Point | None) -> list[Point]:
    if here is None:
        return list(points)
    return sorted(points, key=lambda point: round(math.dist(here, point), 3))


def _takings(
    count: int, item: str, chests: Sequence[Point], reading: Reading
) -> list[tuple[Point, dict[str, int]]]:
    """How many to take from which chests, in order."""
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


def _go(phrase: str, reading: Reading) -> str | None:
    """A program to go where a phrase says; None if it names nothing that is known."""
    given = points_in(phrase)
    if given:
        return javascript.go_to(given[-1])
    player = match_name(phrase, reading.players)
    place = match_name(phrase, reading.places)
    if place is not None and (player is None or len(words(place)) > len(words(player))):
        return javascript.go_to(reading.places[place])
    if player is None:
        return None
    where = reading.players[player] or _said_to_be_at(player, reading)
    if where is not None:
        return javascript.go_to(where)
    return javascript.look_for_player(player, list(reading.places.values()))


def _said_to_be_at(player: str, reading: Reading) -> Point | None:
    """The place named last in the newest message a player said or that names the player."""
    for heard in reversed(reading.chat):
        if heard.speaker == player or set(words(player)) <= set(words(heard.text)):
            where = place_named_last(heard.text, reading.places)
            if where is not None:
                return where
    return None
