"""Maps of scenarios: rows of characters, resolved into blocks, containers, signs and agents.

A map is resolved in the document, after parameters are filled in and a condition is merged. The
scenario is then built as if its author had written the positions. The resolved values keep the
place where they are drawn, so that errors name row and column.
"""

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from typing import Any

import msgspec
from msgspec.structs import replace

from beliefnest.errors import BeliefNestError, ScenarioError
from beliefnest.scenarios.document import Document, KeyPath, YamlNode, wrapped
from beliefnest.scenarios.document_form import check_written
from beliefnest.scenarios.format import FloorEntry, LegendEntry, MapEntry, ScenarioFile, WrittenFile
from beliefnest.world.cuboids import cuboids
from beliefnest.world.limits import box_fault
from beliefnest.world.registry import Registry
from beliefnest.world.terrain import Terrain
from beliefnest.world.texts import quoted
from beliefnest.world.values import Box, Position

_KEY = "map"
_AIR = "air"
_EMPTY = "."
"""Character that is air unless the legend says otherwise."""
_SOLID = ("block", "door", "container", "sign")
"""Keys of the legend that put a block into the cell."""
_PERSON = ("yaw", "pitch", "inventory", "equipment", "health", "food", "type")
_NEEDS: Mapping[str, tuple[str, ...]] = {
    "height": ("block",),
    "open": ("door",),
    "facing": ("agent", "door"),
    "items": ("container",),
    "label": ("container",),
    "looks": ("container",),
    "claims": ("sign",),
    "above": _SOLID,
    **dict.fromkeys(_PERSON, ("agent",)),
}
"""Keys of the legend that only say more about one of other keys."""
_MOST_DRAWN = 4_000_000
"""Most characters of a map; each is resolved on its own, in 300 bytes."""
_THINGS = (*_SOLID, "agent", "place", "floor")


def with_map(document: Document) -> Document:
    """Return a document with its map resolved into the other keys.

    Args:
        document: Document with its condition merged in and its parameters filled in.

    Raises:
        ScenarioError: The map is wrong; the message names file, line, and row and column.
    """
    if _KEY not in document.root.value:
        return document
    return _Drawing(document, check_written(document)).resolved()


class _Floor(msgspec.Struct, frozen=True):
    """Floor of a map.

    Attributes:
        path: Place of the floor in the document.
        node: Its text, or its list of rows.
        rows: Its rows.
        bottom: y of its lowest blocks.
        height: Its height in blocks.
    """

    path: KeyPath
    node: YamlNode
    rows: Sequence[str]
    bottom: int
    height: int


class _Cell(msgspec.Struct, frozen=True):
    """Character on a map.

    Attributes:
        floor: Its floor.
        row: Number of its row, from 0.
        column: Number of its column, from 0.
        character: The character.
        at: Position of the lowest block of the cell.
    """

    floor: _Floor
    row: int
    column: int
    character: str
    at: Position


class _Drawing:
    """Resolver of a document's map.

    Args:
        document: The document.
        file: Its content as typed values, with a map.
    """

    def __init__(self, document: Document, file: ScenarioFile | WrittenFile) -> None:
        assert isinstance(file, WrittenFile) and isinstance(file.map, MapEntry)
        self._document = document
        self._file = file
        self._map = file.map
        self._node: YamlNode = document.root.value[_KEY]
        self._lines = document.text.splitlines()
        self._legend: dict[str, str | LegendEntry] = {_EMPTY: _AIR, **self._map.legend}
        self._check_legend()
        self._floors = self._floors_of()

    def resolved(self) -> Document:
        """Return the document without the map, with what the map shows."""
        root = {key: node for key, node in self._document.root.value.items() if key != _KEY}
        cells = list(self._cells())
        self._check_inside(cells)
        cells_drawn = [(cell, entry) for cell, entry in self._entries(cells)]
        lists = {
            "blocks": self._blocks(cells),
            "containers": [self._container(c) for c, e in cells_drawn if e.container is not None],
            "signs": [self._sign(c) for c, e in cells_drawn if e.sign is not None],
        }
        names = {
            "agents": {name: self._agent(cell) for name, cell in self._named("agent", cells_drawn)},
            "places": {
                name: self._position(cell, list(cell.at))
                for name, cell in self._named("place", cells_drawn)
            },
        }
        if not names["agents"] and not self._file.agents:
            raise self._document.fault(
                (_KEY,), "shows no agent; explain a character as {agent: NAME}, and draw it"
            )
        low, high = self._box.low, self._box.high
        root.setdefault("box", replace(wrapped([low, high]), line=self._node.line))
        for key, drawn in lists.items():
            if drawn:
                old = root.get(key, YamlNode([]))
                root[key] = YamlNode([*drawn, *old.value], old.line or self._node.line)
        for key, entries in names.items():
            if entries:
                old = root.get(key, YamlNode({}))
                both = {**entries, **old.value}
                for name in entries.keys() & old.value.keys():
                    both[name] = _joined(entries[name], old.value[name])
                root[key] = YamlNode(both, old.line or self._node.line)
        return replace(self._document, root=YamlNode(root, self._document.root.line))

    def _check_legend(self) -> None:
        for character, entry in self._map.legend.items():
            path = (_KEY, "legend", character)
            if len(character) != 1:
                raise self._document.fault(path, "is not one character")
            if isinstance(entry, str):
                continue
            keys = list(self._node.value["legend"].value[character].value)
            solid = [key for key in _SOLID if key in keys]
            if len(solid) > 1:
                raise self._document.fault(path, f"is both {solid[0]} and {solid[1]}; keep one")
            if not any(key in keys for key in _THINGS):
                raise self._document.fault(path, f"shows nothing; give one of {', '.join(_THINGS)}")
            for key in keys:
                wanted = _NEEDS.get(key, ())
                if wanted and not any(each in keys for each in wanted):
                    raise self._document.fault(
                        (*path, key), f"needs {' or '.join(wanted)} beside it"
                    )
            if entry.door is not None and not isinstance(entry.facing, str | None):
                raise self._document.fault((*path, "facing"), "of a door is a direction")

    def _floors_of(self) -> list[_Floor]:
        path: KeyPath = (_KEY, "floors")
        node = self._node.value["floors"]
        floors = self._map.floors
        if isinstance(floors, str):
            written = [(path, node, floors, self._map.height)]
        else:
            written = []
            for number, (entry, child) in enumerate(zip(floors, node.value, strict=True)):
                place: KeyPath = (*path, number)
                if isinstance(entry, FloorEntry):
                    inner = child.value["rows"]
                    written.append((place, inner, _text(entry.rows), entry.height))
                else:
                    written.append((place, child, _text(entry), self._map.height))
        if not written:
            raise self._document.fault(path, "is empty; draw at least one floor")
        count = sum(len(text) for _, _, text, _ in written)
        if count > _MOST_DRAWN:
            raise self._document.fault(
                path,
                f"has {count:,} characters; at most {_MOST_DRAWN:,} are possible: draw a smaller "
                "part, and give the rest as `blocks`",
            )
        drawn: list[_Floor] = []
        bottom = self._map.origin[1]
        for place, child, text, height in written:
            rows = [row.rstrip() for row in text.rstrip().split("\n")]
            floor = _Floor(place, child, rows, bottom, height)
            self._check_shape(floor, drawn[0] if drawn else floor)
            drawn.append(floor)
            bottom += height
        return drawn

    def _check_shape(self, floor: _Floor, first: _Floor) -> None:
        width = len(first.rows[0])
        if not width:
            raise self._document.fault(floor.path, "has an empty first row")
        for number, row in enumerate(floor.rows):
            if len(row) != width:
                least = "the first row" if floor is first else "the lowest floor"
                raise self._fault(
                    floor, number, None, f"has {len(row)} columns, but {least} has {width}"
                )
        if len(floor.rows) != len(first.rows):
            raise self._document.fault(
                floor.path,
                f"has {len(floor.rows)} rows, but the lowest floor has {len(first.rows)}",
            )

    @cached_property
    def _drawn_box(self) -> Box:
        """The box of everything drawn, with the layer below it and room for agents."""
        x, y, z = self._map.origin
        first, last = self._floors[0], self._floors[-1]
        low = y if self._map.floor is None else y - 1
        high = last.bottom + last.height - 1
        for floor in self._floors:
            for character in set("".join(floor.rows)):
                below, above = _extent(self._legend.get(character, _AIR), floor.height)
                low, high = min(low, floor.bottom - below), max(high, floor.bottom + above - 1)
        far = (x + len(first.rows[0]) - 1, high, z + len(first.rows) - 1)
        box = Box((x, low, z), far)
        if fault := box_fault(box):
            raise self._document.fault((_KEY,), fault)
        return box

    @cached_property
    def _box(self) -> Box:
        """The box of the scenario."""
        if isinstance(self._file.box, msgspec.UnsetType):
            return self._drawn_box
        return Box.between(*self._file.box)

    def _cells(self) -> Iterator[_Cell]:
        """Yield the cells, floor by floor, in the order of reading."""
        x, _, z = self._map.origin
        for floor in self._floors:
            for k, row in enumerate(floor.rows):
                for i, character in enumerate(row):
                    cell = _Cell(floor, k, i, character, (x + i, floor.bottom, z + k))
                    if character not in self._legend:
                        letters = " ".join(self._legend)
                        raise self._wrong(
                            cell, f"{quoted(character)} is not in the legend, which has {letters}"
                        )
                    yield cell

    def _entries(self, cells: Sequence[_Cell]) -> Iterator[tuple[_Cell, LegendEntry]]:
        """Yield the cells of things, in the order of the legend."""
        by_character: dict[str, list[_Cell]] = {}
        for cell in cells:
            by_character.setdefault(cell.character, []).append(cell)
        for character, entry in self._legend.items():
            if isinstance(entry, LegendEntry):
                for cell in by_character.get(character, ()):
                    yield cell, entry

    def _check_inside(self, cells: Sequence[_Cell]) -> None:
        low, high = self._box.low, self._box.high
        if all(a <= b for a, b in zip(low, self._drawn_box.low, strict=True)) and all(
            a >= b for a, b in zip(high, self._drawn_box.high, strict=True)
        ):
            return
        for cell in cells:
            for at, _ in self._stack(cell):
                if at not in self._box:
                    raise self._wrong(
                        cell, f"{list(at)} lies outside the box {list(low)} to {list(high)}"
                    )
            if cell.at not in self._box and self._legend[cell.character] != _AIR:
                raise self._wrong(
                    cell, f"{list(cell.at)} lies outside the box {list(low)} to {list(high)}"
                )

    def _stack(self, cell: _Cell) -> Iterator[tuple[Position, YamlNode]]:
        """Yield the blocks of a cell, as positions and nodes of their states."""
        entry, (x, y, z) = self._legend[cell.character], cell.at
        top = y + cell.floor.height
        if isinstance(entry, str):
            if entry != _AIR:
                state = self._meaning(cell, entry)
                end = top if _is_wall(entry) else y + 1
                yield from (((x, each, z), state) for each in range(y, end))
            return
        if entry.floor is not None:
            yield (x, y - 1, z), self._meaning(cell, entry.floor, "floor")
        if entry.block is not None:
            state = self._meaning(cell, entry.block, "block")
            yield from (((x, each, z), state) for each in range(y, y + (entry.height or 1)))
            y += (entry.height or 1) - 1
        elif entry.door is not None:
            for half in ("lower", "upper"):
                state = self._meaning(cell, self._door(cell, entry, half), "door")
                yield (x, y + (half == "upper"), z), state
            y += 1
        if entry.above is not None:
            state = self._meaning(cell, entry.above, "above")
            yield from (((x, each, z), state) for each in range(y + 1, top))

    def _meaning(self, cell: _Cell, value: str, key: str | None = None) -> YamlNode:
        """Return a value of the legend, with its place there."""
        node = self._node.value["legend"].value[cell.character]
        place = f"{_KEY}.legend.{cell.character}"
        if key is None:
            return YamlNode(value, node.line, place)
        return YamlNode(value, node.value[key].line, f"{place}.{key}")

    def _door(self, cell: _Cell, entry: LegendEntry, half: str) -> str:
        """Return the state of one half of a door."""
        assert entry.door is not None
        name = entry.door if entry.door.endswith("_door") else f"{entry.door}_door"
        across = "north"
        rows, k, i = cell.floor.rows, cell.row, cell.column
        if self._is_wall(rows, k - 1, i) and self._is_wall(rows, k + 1, i):
            across = "east"
        if self._is_wall(rows, k, i - 1) and self._is_wall(rows, k, i + 1):
            across = "north"
        is_open = "true" if entry.open else "false"
        return f"{name}[facing={entry.facing or across},half={half},open={is_open}]"

    def _is_wall(self, rows: Sequence[str], row: int, column: int) -> bool:
        if not (0 <= row < len(rows) and 0 <= column < len(rows[row])):
            return False
        entry = self._legend.get(rows[row][column])
        return isinstance(entry, str) and entry != _AIR and _is_wall(entry)

    def _blocks(self, cells: Sequence[_Cell]) -> list[YamlNode]:
        """Return entries for all blocks, each a cuboid."""
        box = self._drawn_box
        grid = Terrain.full(box.shape, 0).draft()
        states: list[YamlNode] = [YamlNode(_AIR)]
        numbers: dict[tuple[str, str], int] = {}

        def number_of(state: YamlNode) -> int:
            number = numbers.setdefault((state.value, state.origin), len(states))
            if number == len(states):
                states.append(state)
            return number

        if self._map.floor is not None:
            written = self._node.value.get("floor", YamlNode("", self._node.line))
            ground = YamlNode(self._map.floor, written.line, f"{_KEY}.floor")
            first, last = self._drawn_box.low, self._drawn_box.high
            level = self._map.origin[1] - 1
            low = box.index((first[0], level, first[2]))
            high = box.index((last[0], level, last[2]))
            grid.fill(low, (high[0] + 1, high[1] + 1, high[2] + 1), number_of(ground))
        for cell in cells:
            for at, state in self._stack(cell):
                grid[box.index(at)] = 0 if state.value == _AIR else number_of(state)
        return [
            self._fill(states[number], part, box) for number, part in cuboids(grid.terrain(), 0)
        ]

    def _fill(self, state: YamlNode, part: Box, box: Box) -> YamlNode:
        corners = [
            [int(i) + low for i, low in zip(corner, box.low, strict=True)]
            for corner in (part.low, part.high)
        ]
        where = YamlNode(wrapped(corners).value, state.line, _KEY)
        return YamlNode({"block": state, "fill": where}, state.line, state.origin)

    def _container(self, cell: _Cell) -> YamlNode:
        return self._thing(cell, {"container": "block"}, ("items", "label", "looks"))

    def _sign(self, cell: _Cell) -> YamlNode:
        return self._thing(cell, {"sign": "text"}, ("claims",))

    def _thing(self, cell: _Cell, renamed: Mapping[str, str], kept: Sequence[str]) -> YamlNode:
        """Return the entry of a thing at a cell, with keys of the legend."""
        written = self._node.value["legend"].value[cell.character]
        place = f"{_KEY}.legend.{cell.character}"
        entry = {"at": self._position(cell, list(cell.at))}
        for key, node in written.value.items():
            if key in renamed or key in kept:
                entry[renamed.get(key, key)] = replace(node, origin=f"{place}.{key}")
        return YamlNode(entry, written.line, place)

    def _agent(self, cell: _Cell) -> YamlNode:
        x, y, z = cell.at
        thing = self._thing(cell, {}, (*_PERSON, "facing"))
        feet = self._position(cell, [x + 0.5, y, z + 0.5])
        entry = {"position": feet, **thing.value}
        del entry["at"]
        return YamlNode(entry, thing.line, thing.origin)

    def _named(
        self, key: str, cells_of_key: Sequence[tuple[_Cell, LegendEntry]]
    ) -> Iterator[tuple[str, _Cell]]:
        """Yield the cells of things with names, each once."""
        first: dict[str, _Cell] = {}
        for cell, entry in cells_of_key:
            name = getattr(entry, key)
            if name is None:
                continue
            if name in first:
                other = self._place(first[name].floor, first[name].row, first[name].column)
                raise self._wrong(cell, f"{key} {quoted(name)} is drawn twice; first at {other}")
            first[name] = cell
            yield name, cell

    def _position(self, cell: _Cell, value: list[Any]) -> YamlNode:
        line = self._line(cell.floor, cell.row)
        origin = self._place(cell.floor, cell.row, cell.column)
        return YamlNode(wrapped(value).value, line, origin)

    def _wrong(self, cell: _Cell, message: str) -> ScenarioError:
        return self._fault(cell.floor, cell.row, cell.column, message)

    def _fault(self, floor: _Floor, row: int, column: int | None, message: str) -> ScenarioError:
        line = self._line(floor, row)
        where = f"{self._document.source}:{line}" if line else self._document.source
        return ScenarioError(f"{where}: {self._place(floor, row, column)}: {message}")

    def _place(self, floor: _Floor, row: int, column: int | None) -> str:
        _, _, *number = floor.path
        named = f"{_KEY}.floors" + "".join(f"[{each}]" for each in number)
        column_words = "" if column is None else f", column {column + 1}"
        return f"{named}, row {row + 1}{column_words}"

    def _line(self, floor: _Floor, row: int) -> int:
        """Return the line of a row in the file; the line of the floor if the row is not there."""
        if isinstance(floor.node.value, list):
            return int(floor.node.value[row].line)
        # A block of text begins on the line after its key.
        line = floor.node.line + row
        is_there = floor.node.line > 0 and line < len(self._lines)
        if is_there and self._lines[line].strip() == floor.rows[row].strip():
            return line + 1
        return floor.node.line


def _is_wall(state: str) -> bool:
    """Return False for blocks that agents walk through, such as a lever, wire or a pressure plate.

    An unknown block counts as a wall; the scenario's builder names its place in the file.
    """
    registry = Registry.load()
    try:
        return bool(registry.boxes(registry.state_id(state)))
    except BeliefNestError:
        return True


def _extent(entry: str | LegendEntry, height: int) -> tuple[int, int]:
    """Return how many blocks an entry of the legend needs below and above its floor's level."""
    if isinstance(entry, str):
        return 0, height
    is_tall = entry.agent is not None or entry.door is not None
    return int(entry.floor is not None), max(height, entry.height or 1, 1 + is_tall)


def _text(rows: str | list[str]) -> str:
    return rows if isinstance(rows, str) else "\n".join(rows)


def _joined(drawn: YamlNode, written: YamlNode) -> YamlNode:
    """Return the drawn entry with the written keys, which count."""
    if not isinstance(drawn.value, dict) or not isinstance(written.value, dict):
        return written
    kept = dict(drawn.value)
    if written.value.keys() & {"facing", "yaw", "pitch"}:
        kept = {key: node for key, node in kept.items() if key not in ("facing", "yaw", "pitch")}
    return YamlNode({**kept, **written.value}, written.line)
