"""Edits of scenario files: things put and removed, in the form in which the file is written.

An edit changes the text of a file, not the scenario: comments, parameters and all keys that the
edit does not concern stay as they are. Files with a map get characters on the map; other files
get entries of `blocks`, `containers`, `agents` and so on.
"""

import math
import string
from collections.abc import Iterator, Mapping
from io import StringIO
from typing import Any

import msgspec
from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedMap, CommentedSeq
from ruamel.yaml.scalarstring import LiteralScalarString

from beliefnest.errors import InputError
from beliefnest.scenarios.document_form import check_written
from beliefnest.scenarios.format import LegendEntry
from beliefnest.scenarios.older_spellings import respelled
from beliefnest.scenarios.parameters import with_parameters
from beliefnest.scenarios.writing import in_flow
from beliefnest.scenarios.yaml_reading import parse_yaml
from beliefnest.world.texts import quoted, shortened
from beliefnest.world.values import Position

_AIR = "."
_WIDTH = 10_000
_WALL = 3
"""Height of a wall in files without a map."""
_NAMED = ("agent", "place")
_LETTERS = {"container": "CBX", "door": "D", "sign": "s", "place": "xyz", "block": "o"}


def drawn_starter(name: str) -> str:
    """Return the text of a new scenario file with a map: a room with one agent."""
    rows = ["#" * 12, *["#" + _AIR * 10 + "#"] * 6, "#" * 12]
    rows[4] = "#..a" + rows[4][4:]
    floor = "".join(f"    {row}\n" for row in rows)
    return (
        f"name: {name}\nmap:\n  legend:\n"
        '    "#": bricks\n    a: {agent: ann, facing: east}\n'
        f"  floors: |\n{floor}static_blocks: [stone, bricks]\n"
    )


def edited(text: str, edit: Mapping[str, Any]) -> str:
    """Return the text of a scenario file after an edit.

    Args:
        text: Text of the file.
        edit: `do`: `put` with `at` and `thing` (as in the legend of a map), `clear` with `at`, or
            `grow` with `side` (`east` or `south`).

    Raises:
        ScenarioError: The text does not have the form of a scenario file.
        InputError: The edit has a wrong form, or the file cannot take it.
    """
    # Edits rely on the form; the content may be wrong, as edits can mend it.
    check_written(with_parameters(respelled(parse_yaml(text, "the file")), {}))
    yaml = YAML()
    yaml.preserve_quotes = True
    yaml.width = _WIDTH
    yaml.indent(mapping=2, sequence=4, offset=2)
    out = StringIO()
    try:
        content = yaml.load(text)
        _edit(content, edit)
        yaml.dump(content, out)
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
        # Entries may be aliases, merged or tagged, which have the form and take no edits.
        raise InputError(
            f"the file cannot take this edit ({shortened(str(error))}); change its text"
        ) from error
    return out.getvalue()


def _edit(content: CommentedMap, edit: Mapping[str, Any]) -> None:
    form = _MapEdits(content) if isinstance(content.get("map"), dict) else _ListEdits(content)
    match edit.get("do"):
        case "put":
            form.put(_position(edit.get("at")), _thing(edit.get("thing")))
        case "clear":
            form.clear(_position(edit.get("at")))
        case "grow":
            form.grow(str(edit.get("side")))
        case other:
            raise InputError(f"{quoted(other)} is no edit; edits are put, clear and grow")


class _MapEdits:
    """Edits of a file with a map.

    Args:
        content: Content of the file, which the edits change.
    """

    def __init__(self, content: CommentedMap) -> None:
        self._content, self._map = content, content["map"]
        self._legend = self._map.setdefault("legend", CommentedMap())
        if not isinstance(self._legend, dict):
            raise _parameter("map.legend", self._legend)
        self._origin = _written_position("map.origin", self._map.get("origin", [0, 1, 0]))

    def put(self, at: Position, thing: Any) -> None:
        """Put a thing at a position; an agent or place moves there."""
        number, row, column = self._cell(at)
        character = self._character(thing)
        for key in _NAMED:
            if isinstance(thing, dict) and key in thing:
                self._remove(character)
                _drop(self._content.get(f"{key}s"), thing[key], ("position", "facing"))
        self._set(number, row, column, character)

    def clear(self, at: Position) -> None:
        """Draw air at a position."""
        self._set(*self._cell(at), _AIR)

    def grow(self, side: str) -> None:
        """Add a row or column of air."""
        for number, rows in enumerate(self._rows()):
            if side == "east":
                self._write(number, [row + row[-1:] for row in rows])
            elif side == "south":
                self._write(number, [*rows, rows[-1]])
            else:
                raise InputError(f"{quoted(side)} is no side to grow; give east or south")

    def _cell(self, at: Position) -> tuple[int, int, int]:
        column, row = at[0] - self._origin[0], at[2] - self._origin[2]
        bottom = self._origin[1]
        for number, rows in enumerate(self._rows()):
            height = self._height(number)
            if bottom <= at[1] < bottom + height:
                if 0 <= row < len(rows) and 0 <= column < len(rows[row]):
                    return number, row, column
                break
            bottom += height
        raise InputError(f"{list(at)} is not on the map; add rows or columns first")

    def _floors(self) -> list[Any]:
        floors = self._map["floors"]
        return [floors] if isinstance(floors, str) else floors

    def _height(self, number: int) -> int:
        floor = self._floors()[number]
        if isinstance(floor, dict):
            height = floor.get("height", 1)
        else:
            height = self._map.get("height", _WALL)
        if not isinstance(height, int):
            raise _parameter("the height of a floor", height)
        return height

    def _rows(self) -> Iterator[list[str]]:
        for floor in self._floors():
            rows = floor["rows"] if isinstance(floor, dict) else floor
            yield list(rows) if isinstance(rows, list) else rows.rstrip().split("\n")

    def _set(self, number: int, row: int, column: int, character: str) -> None:
        rows = list(self._rows())[number]
        rows[row] = rows[row][:column] + character + rows[row][column + 1 :]
        self._write(number, rows)

    def _write(self, number: int, rows: list[str]) -> None:
        """Write the rows of a floor in the form that it has."""
        holder: Any = self._map
        key: Any = "floors"
        if not isinstance(holder[key], str):
            holder, key = holder[key], number
        if isinstance(holder[key], dict):
            holder, key = holder[key], "rows"
        if isinstance(holder[key], list):
            holder[key][:] = rows
        else:
            holder[key] = LiteralScalarString("".join(f"{row}\n" for row in rows))

    def _remove(self, character: str) -> None:
        """Draw air wherever a character stands."""
        for number, rows in enumerate(self._rows()):
            if any(character in row for row in rows):
                self._write(number, [row.replace(character, _AIR) for row in rows])

    def _character(self, thing: Any) -> str:
        """Return the character of a thing; explain a new one in the legend if there is none."""
        for character, meaning in self._legend.items():
            if meaning == thing:
                return str(character)
            for key in _NAMED:
                is_same = isinstance(meaning, dict) and isinstance(thing, dict) and key in thing
                if is_same and meaning.get(key) == thing[key]:
                    for name, value in thing.items():
                        meaning[name] = value
                    return str(character)
        character = self._free(thing)
        self._legend[character] = in_flow(thing)
        return character

    def _free(self, thing: Any) -> str:
        """Return a character that the legend does not have."""
        wanted = "#"
        if isinstance(thing, str):
            wanted = "#%" + thing[:1].upper()
        elif "agent" in thing:
            wanted = str(thing["agent"])[:1].lower()
        else:
            wanted = next((letters for key, letters in _LETTERS.items() if key in thing), "")
        taken = {str(key) for key in self._legend} | {_AIR}
        for character in wanted + string.ascii_letters + "%&+=*":
            if character not in taken and character.isprintable() and not character.isspace():
                return character
        raise InputError("the legend has no free character left; write it by hand")


class _ListEdits:
    """Edits of a file without a map.

    Args:
        content: Content of the file, which the edits change.
    """

    def __init__(self, content: CommentedMap) -> None:
        self._content = content

    def put(self, at: Position, thing: Any) -> None:
        """Put a thing at a position; an agent or place moves there."""
        x, y, z = at
        if isinstance(thing, str):
            self._block(thing, at, _WALL)
            return
        if "agent" in thing:
            self._agent(thing, [x + 0.5, y, z + 0.5])
        elif "place" in thing:
            self._content.setdefault("places", CommentedMap())[thing["place"]] = in_flow(list(at))
        elif "door" in thing:
            facing, is_open = thing.get("facing", "north"), str(thing.get("open", False)).lower()
            for dy, half in enumerate(("lower", "upper")):
                state = f"{thing['door']}_door[facing={facing},half={half},open={is_open}]"
                self._block(state, (x, y + dy, z), 1)
        elif "block" in thing:
            self._block(thing["block"], at, int(thing.get("height", 1)))
        else:
            self._remove_things(at)
            names = {"container": "block", "sign": "text"}
            entry = {names.get(key, key): value for key, value in thing.items()}
            listed = self._content.setdefault(
                "signs" if "sign" in thing else "containers", CommentedSeq()
            )
            listed.append(in_flow({**entry, "at": list(at)}))

    def clear(self, at: Position) -> None:
        """Remove what stands at a position."""
        agents = self._content.get("agents", {})
        for name, entry in list(agents.items()):
            feet: Any = entry.get("position") if isinstance(entry, dict) else None
            is_point = isinstance(feet, list) and all(isinstance(p, int | float) for p in feet)
            if is_point and [math.floor(part) for part in feet] == list(at):
                del agents[name]
                return
        if not self._remove_things(at) and not self._remove_last(at):
            self._block("air", at, _WALL)

    def grow(self, side: str) -> None:
        """Move the eastern or southern side of the box by one."""
        axis = {"east": 0, "south": 2}.get(side)
        if axis is None:
            raise InputError(f"{quoted(side)} is no side to grow; give east or south")
        low, high = self._box()
        farther = high if high[axis] >= low[axis] else low
        farther[axis] += 1

    def _block(self, state: str, at: Position, height: int) -> None:
        x, y, z = at
        high = [x, self._top(y, height), z]
        where = {"at": list(at)} if high == list(at) else {"fill": [list(at), high]}
        self._content.setdefault("blocks", CommentedSeq()).append(
            in_flow({"block": state, **where})
        )

    def _top(self, y: int, height: int) -> int:
        low, high = self._box()
        return max(y, min(y + height - 1, int(max(low[1], high[1]))))

    def _box(self) -> tuple[Any, Any]:
        """Return the corners of the box as written."""
        box = self._content["box"]
        for corner in box if isinstance(box, list) else [box]:
            _written_position("box", corner)
        return box[0], box[1]

    def _agent(self, thing: Mapping[str, Any], feet: list[float]) -> None:
        agents = self._content.setdefault("agents", CommentedMap())
        name = thing["agent"]
        if name not in agents:
            agents[name] = in_flow({"position": feet})
        position = agents[name].get("position") if isinstance(agents[name], dict) else agents[name]
        if isinstance(position, str) or any(isinstance(part, str) for part in position or ()):
            raise _parameter(f"the position of {name}", position)
        agents[name]["position"] = in_flow(feet)
        for key, value in thing.items():
            if key != "agent":
                agents[name][key] = value
        if "facing" in thing:
            for key in ("yaw", "pitch"):
                agents[name].pop(key, None)

    def _remove_things(self, at: Position) -> bool:
        """Remove containers, signs and places at a position; return True if there was one."""
        is_found = False
        for key in ("containers", "signs"):
            listed = self._content.get(key, [])
            for entry in [each for each in listed if each.get("at") == list(at)]:
                listed.remove(entry)
                is_found = True
        places = self._content.get("places", {})
        for name in [name for name, place in places.items() if place == list(at)]:
            del places[name]
            is_found = True
        return is_found

    def _remove_last(self, at: Position) -> bool:
        """Remove the last entry of blocks if it concerns only this position's column."""
        blocks = self._content.get("blocks") or []
        if not blocks:
            return False
        corners = blocks[-1].get("fill") or [blocks[-1].get("at")] * 2
        if not all(isinstance(corner, list) for corner in corners):
            return False
        is_column = bool(corners[0] == list(at) and corners[1][::2] == list(at)[::2])
        if is_column and blocks[-1].get("block") != "air":
            del blocks[-1]
        return is_column


def _drop(entries: Any, name: str, keys: tuple[str, ...]) -> None:
    """Remove what other keys of the file say about the place of a drawn thing."""
    if not isinstance(entries, dict) or name not in entries:
        return
    if not isinstance(entries[name], dict):
        del entries[name]
        return
    for key in keys:
        entries[name].pop(key, None)


def _written_position(name: str, value: Any) -> Position:
    if not isinstance(value, list) or not all(isinstance(part, int) for part in value):
        raise _parameter(name, value)
    return (int(value[0]), int(value[1]), int(value[2]))


def _parameter(name: str, value: object) -> InputError:
    """Return the error about a value that a parameter decides."""
    return InputError(f"{name} is {quoted(value)}, a parameter; change it in the text of the file")


def _position(value: object) -> Position:
    if (
        isinstance(value, list)
        and len(value) == 3
        and all(isinstance(part, int) and not isinstance(part, bool) for part in value)
    ):
        return (value[0], value[1], value[2])
    raise InputError(f"{quoted(value)} is no position; give three whole numbers")


def _thing(value: object) -> Any:
    form: Any = str | LegendEntry
    try:
        msgspec.convert(value, form)
    except msgspec.ValidationError as error:
        raise InputError(
            f"{quoted(value)} is no thing ({shortened(str(error))}); give a block, or a mapping as "
            "in a map's legend"
        ) from None
    if not value:
        raise InputError("the thing is empty; name a block")
    return value
