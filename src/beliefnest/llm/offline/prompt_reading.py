"""Parser of prompts, in the paper's form or that of the default templates."""

import ast
import json
import re
from collections.abc import Mapping, Sequence

import msgspec

from beliefnest.world.values import Point

_HEADING = re.compile(r"([A-Z][A-Za-z ]*):")
_TASK = re.compile(r"Task:\s*(.*)")
_DIVIDER = re.compile(r"<[^<>]+>|\[[^\[\]]*\]")
_NUMBER = r"(-?\d+(?:\.\d+)?)"
_POINT = re.compile(rf"[(\[]\s*{_NUMBER}\s*,\s*{_NUMBER}\s*,\s*{_NUMBER}\s*[)\]]")
_CHEST = re.compile(rf"({_POINT.pattern}):\s*(\{{.*\}})")
_CONTAINER = re.compile(
    rf"({_POINT.pattern}) [^:]*: (?:unknown|known(?: in part)?, (empty|\{{[^}}]*\}}).*)"
)
_SIGN = re.compile(rf'({_POINT.pattern}) \w*sign: says (?:"(.*)"|nothing)(?:;.*)?')
_PLAYER = re.compile(rf"(\w+): (?:unknown|at ({_POINT.pattern}); ([^;]*)).*")
_CHAT = re.compile(r"(\d+);([A-Za-z0-9_]+)(?: whispers to \w+)?;(.*)")
_SIGHTING = re.compile(
    rf"\d+;(?:goToPosition|lastSeen|heardOf|visible);(\w+);(?:destination|position):({_POINT.pattern}).*"
)
_OBSERVED = re.compile(
    rf"(\d+);(assumed|inside|getItemFromChest|depositItemIntoChest);[\w-]+;"
    rf"chest:({_POINT.pattern}) & items:(\{{.*\}})"
)
_SEEN = re.compile(
    rf"\d+;(visible|lastSeen|goToPosition);(\w+);(?:position|destination):({_POINT.pattern}).*"
)
_OWNER = re.compile(r"^You are (\w+)\.$", re.MULTILINE)
_OTHERS_TASK = re.compile(r"(\w+)'s task:\s*(.+)")
_PLACE = re.compile(rf"(?:-\s*)?([A-Za-z][\w' ]*?)(?: is at|:)\s*({_POINT.pattern})\.?")
_PLACE_IN_SENTENCE = re.compile(rf"\b([A-Z]\w*(?: [A-Z]\w*)*) is at ({_POINT.pattern})")


class HeardUtterance(msgspec.Struct, frozen=True):
    """Speaker, text and tick of something heard."""

    speaker: str
    text: str
    tick: int = 0


class PromptReading(msgspec.Struct, frozen=True):
    """Contents of a prompt.

    Attributes:
        task: The sentence after `Task:`; empty if there is none.
        position: Position of the agent; None if the prompt lacks it.
        chests: Known items by position of a chest, in the order of the prompt.
        players: Positions of the other players by name; None if a player cannot be seen.
        chat: Utterances heard, in the order of the prompt.
        places: Positions of places by name.
        sightings: Last positions or destinations of players in the history, by name.
        others_tasks: Tasks of other players by name, as the prompt tells them.
        signs: Texts of signs by position, with ` / ` between lines.
    """

    task: str
    position: Point | None
    chests: Mapping[Point, Mapping[str, int]]
    players: Mapping[str, Point | None]
    chat: Sequence[HeardUtterance]
    places: Mapping[str, Point]
    sightings: Mapping[str, Point]
    others_tasks: Mapping[str, str]
    signs: Mapping[Point, str]


def words(text: str) -> tuple[str, ...]:
    """Return the words of a name or sentence in lower case; `_` and `-` separate words."""
    return tuple(re.findall(r"[a-z0-9']+", re.sub(r"[_-]", " ", text.lower())))


def points_in(text: str) -> list[Point]:
    """Return every `(x, y, z)` or `[x, y, z]` in a text."""
    return [(float(x), float(y), float(z)) for x, y, z in _POINT.findall(text)]


def read_prompt(text: str) -> PromptReading:
    """Parse a prompt; missing or unclear sections are read as unknown."""
    sections = _sections(text)
    chat = _chat(sections.get("Chat log", []))
    places = _places(sections.get("Places", []), text)
    has_chests = {"Chest", "Containers"} & sections.keys()
    chests = _chests(sections.get("Chest", [])) | _containers(sections.get("Containers", []))
    here = points_in("\n".join(sections.get("Position", [])))
    return PromptReading(
        task=_task(text),
        position=here[0] if here else None,
        chests=chests if has_chests else _remembered(text, chat, places),
        players=_players(sections["Other players"])
        if "Other players" in sections
        else _seen_players(text),
        chat=chat,
        places=places,
        sightings=_sightings(text),
        others_tasks=_others_tasks(text),
        signs=_signs(sections.get("Signs", [])),
    )


def _sections(text: str) -> dict[str, list[str]]:
    """Return the lines below each heading; of sections with the same heading, those of the last."""
    sections: dict[str, list[str]] = {}
    lines: list[str] = []
    for line in text.splitlines():
        stripped = line.strip()
        heading = _HEADING.fullmatch(stripped) if stripped.endswith(":") else None
        if heading is not None:
            lines = sections[heading[1]] = []
        elif _ends_section(line, stripped):
            lines = []
        else:
            lines.append(line)
    return sections


def _ends_section(line: str, stripped: str) -> bool:
    """Return True if a line is `<...>`, `[...]` (not a position) or the task."""
    if stripped.startswith(("<", "[")):
        return _DIVIDER.fullmatch(stripped) is not None and _POINT.fullmatch(stripped) is None
    return _TASK.match(line) is not None


def _task(text: str) -> str:
    """Return the last task of the text: its line and the lines up to an empty line."""
    lines = text.splitlines()
    starts = [index for index, line in enumerate(lines) if _TASK.match(line)]
    if not starts:
        return ""
    task_lines = []
    for line in lines[starts[-1] :]:
        if not line.strip():
            break
        task_lines.append(line.strip())
    return " ".join(task_lines).removeprefix("Task:").strip()


def _chests(lines: Sequence[str]) -> dict[Point, dict[str, int]]:
    chests = {}
    for line in lines:
        match = _CHEST.match(line.strip())
        if match is not None:
            chests[points_in(match[1])[0]] = _items(match[5])
    return chests


def _containers(lines: Sequence[str]) -> dict[Point, dict[str, int]]:
    matches = (_CONTAINER.fullmatch(line.strip()) for line in lines)
    return {
        points_in(match[1])[0]: _items(match[5] or "") for match in matches if match is not None
    }


def _signs(lines: Sequence[str]) -> dict[Point, str]:
    matches = (_SIGN.fullmatch(line.strip()) for line in lines)
    return {points_in(match[1])[0]: match[5] or "" for match in matches if match is not None}


def _items(text: str) -> dict[str, int]:
    """Parse items written as `{'diamond': 1}`; entries of other types are left out."""
    try:
        value = ast.literal_eval(text)
    except (ValueError, SyntaxError):
        return {}
    if not isinstance(value, dict):
        return {}
    return {
        name: count
        for name, count in value.items()
        if isinstance(name, str) and isinstance(count, int)
    }


def _players(lines: Sequence[str]) -> dict[str, Point | None]:
    try:
        value = json.loads("\n".join(lines))
    except json.JSONDecodeError:
        matches = (_PLAYER.fullmatch(line.strip()) for line in lines)
        return {
            match[1]: points_in(match[2])[0] if match[6] == "seen now" else None
            for match in matches
            if match is not None
        }
    if not isinstance(value, dict):
        return {}
    players: dict[str, Point | None] = {}
    for name, entry in value.items():
        where = entry.get("position") if isinstance(entry, dict) else None
        points = points_in(str(where))
        players[name] = points[0] if points else None
    return players


def _remembered(
    text: str, chat: Sequence[HeardUtterance], places: Mapping[str, Point]
) -> dict[Point, dict[str, int]]:
    """Return the contents of chests that follow from a history of observations.

    The newest knowledge counts: what was seen inside, put in or taken out, and what others said
    in words such as `The diamond is in the left chest`.
    """
    owner = _OWNER.search(text)
    rows = [match for match in map(_OBSERVED.fullmatch, text.splitlines()) if match is not None]
    heard = [said for said in chat if owner is None or said.speaker != owner[1]]
    # Events of a tick come before words of the same tick. Narrators know all and need no words.
    changes: list[tuple[int, int, re.Match[str] | HeardUtterance]] = []
    changes += [(int(row[1]), 0, row) for row in rows]
    changes += [(said.tick, 1, said) for said in heard if owner is not None]
    chests: dict[Point, dict[str, int]] = {}
    for _, _, change in sorted(changes, key=lambda each: each[:2]):
        if isinstance(change, HeardUtterance):
            _believe(change.text, chests, places)
        else:
            _observe(change, chests)
    return chests


def _observe(row: re.Match[str], chests: dict[Point, dict[str, int]]) -> None:
    at, items = points_in(row[3])[0], _items(row[7])
    stored = chests.setdefault(at, {})
    if row[2] in ("assumed", "inside"):
        stored.clear()
    sign = -1 if row[2] == "getItemFromChest" else 1
    for name, count in items.items():
        stored[name] = max(0, stored.get(name, 0) + sign * count)


def _believe(text: str, chests: dict[Point, dict[str, int]], places: Mapping[str, Point]) -> None:
    for name, at in places.items():
        match = re.search(
            rf"(?:^|\b(?:the|a|an) )([a-z ]+?) is (?:now )?in (?:the )?{re.escape(name)}\b",
            text,
            re.IGNORECASE,
        )
        if match is not None:
            item = re.sub(r"^(?:the|an?) ", "", match[1].lower()).replace(" ", "_")
            for items in chests.values():
                items.pop(item, None)
            chests.setdefault(at, {})[item] = 1


def _seen_players(text: str) -> dict[str, Point | None]:
    """Return the places of the players that are in sight by the history; None: out of sight."""
    matches = [match for match in map(_SEEN.fullmatch, text.splitlines()) if match is not None]
    return {
        match[2]: None if match[1] == "lastSeen" else points_in(match[3])[0] for match in matches
    }


def _chat(lines: Sequence[str]) -> list[HeardUtterance]:
    matches = (_CHAT.fullmatch(line.strip()) for line in lines)
    return [
        HeardUtterance(match[2], match[3], int(match[1])) for match in matches if match is not None
    ]


def _places(lines: Sequence[str], text: str) -> dict[str, Point]:
    """Return places from sentences such as `Home is at (1, 2, 3)`, then from their section."""
    places: dict[str, Point] = {}
    if " is at " in text:
        for name, where, *_ in _PLACE_IN_SENTENCE.findall(text):
            places[name] = points_in(where)[0]
    for line in lines:
        match = _PLACE.fullmatch(line.strip())
        if match is not None:
            places[match[1].strip()] = points_in(match[2])[0]
    return places


def _sightings(text: str) -> dict[str, Point]:
    lines = (line.strip() for line in text.splitlines() if ";" in line)
    matches = (_SIGHTING.fullmatch(line) for line in lines)
    return {match[1]: points_in(match[2])[0] for match in matches if match is not None}


def _others_tasks(text: str) -> dict[str, str]:
    lines = text.splitlines() if "'s task:" in text else ()
    matches = (_OTHERS_TASK.fullmatch(line.strip()) for line in lines)
    return {match[1]: match[2] for match in matches if match is not None}
