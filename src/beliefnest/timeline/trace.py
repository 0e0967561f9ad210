"""Reader of traces: JSONL files with the histories that other programs recorded.

The first line holds the initial state. Each other line holds the changes of one tick: poses,
blocks, events. See docs/export.md for the format. The reader finds all bad lines and reports them
together.
"""

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any, BinaryIO

import msgspec
from msgspec.structs import replace

from beliefnest.errors import BeliefNestError, InputError
from beliefnest.files import decode_json, open_regular
from beliefnest.perception.options import Perception
from beliefnest.timeline.events import event_from
from beliefnest.timeline.journal import Entry, TimelineKey
from beliefnest.timeline.store import Journal
from beliefnest.world.claims import Claim, claims_from_plain, claims_of
from beliefnest.world.double_chests import (
    StateAt,
    container_at,
    is_double,
    whole_chests,
)
from beliefnest.world.event_kinds import AT_CONTAINERS, EventKind
from beliefnest.world.frames import Frame, PlainClaims, Snapshot
from beliefnest.world.limits import (
    AGENT_SLOTS,
    MOST_AGENTS,
    WORN_SLOTS,
    agent_name_fault,
    box_fault,
    dropped_fault,
    items_fault,
    point_fault,
    slots_at,
    tick_fault,
)
from beliefnest.world.registry import Registry
from beliefnest.world.signs import text_of, written
from beliefnest.world.terrain import Terrain
from beliefnest.world.texts import quoted
from beliefnest.world.values import (
    EQUIPMENT_SLOTS,
    AgentState,
    Block,
    Box,
    DroppedItem,
    Event,
    Items,
    Point,
    Position,
    block_at,
)

_LONGEST_LINE = 2**26
"""Greatest length of a line in bytes."""

_AGENT_SLOTS = AGENT_SLOTS + WORN_SLOTS

_TOLD = 10
"""Number of bad lines that an error message quotes."""


class _AgentLine(msgspec.Struct, forbid_unknown_fields=True, omit_defaults=True):
    position: Point | None = None
    yaw: float | None = None
    pitch: float | None = None
    on_ground: bool | None = None
    equipment: dict[str, str] | None = None
    inventory: dict[str, int] | None = None
    health: float | None = None
    food: float | None = None


class _ItemLine(msgspec.Struct, forbid_unknown_fields=True):
    name: str
    count: int
    position: Point


class _EventLine(msgspec.Struct, forbid_unknown_fields=True):
    kind: str
    actor: str | None = None
    detail: dict[str, Any] = {}


class _SignLine(msgspec.Struct, array_like=True, forbid_unknown_fields=True):
    x: int
    y: int
    z: int
    text: str
    claims: list[dict[str, Any]] = []


_BlockLine = tuple[int, int, int, str]
_ContainerLine = tuple[int, int, int, dict[str, int] | None]
_Halves = dict[Position, dict[Position, Items | None]]


class _FirstLine(msgspec.Struct, forbid_unknown_fields=True):
    box: tuple[Position, Position]
    agents: dict[str, _AgentLine | None]
    tick: int = 0
    perception: Perception = Perception()
    static_blocks: list[str] = []
    unique: list[str] = []
    fills: list[tuple[Position, Position, str]] = []
    blocks: list[_BlockLine] = []
    signs: list[_SignLine] = []
    containers: list[_ContainerLine] = []
    items: dict[int, _ItemLine] = {}


class _TickLine(msgspec.Struct, forbid_unknown_fields=True):
    tick: int
    agents: dict[str, _AgentLine | None] = {}
    blocks: list[_BlockLine] = []
    signs: list[_BlockLine] = []
    containers: list[_ContainerLine] = []
    items: dict[int, _ItemLine | None] = {}
    events: list[_EventLine] = []


class BadLine(msgspec.Struct, frozen=True):
    """An unusable line of a trace: its number, from 1, and the fault."""

    line: int
    fault: str


class Trace(msgspec.Struct, frozen=True):
    """History that another program recorded.

    Attributes:
        first: Initial state.
        agents: Names of all agents, including those that appear later.
        perception: Perception options of the agents.
        static_blocks: Names of blocks that all agents know from the start.
        unique: Items of which, by common knowledge, only one exists.
        entries: Changes, in order of ticks.
        bad: Lines that were left out.
    """

    first: Snapshot
    agents: tuple[str, ...]
    perception: Perception
    static_blocks: frozenset[str]
    unique: frozenset[str]
    entries: tuple[Entry, ...]
    bad: tuple[BadLine, ...]


def load_trace(path: Path, registry: Registry) -> Trace:
    """Read a trace file; every line must be good.

    Raises:
        InputError: The file cannot be read or has bad lines; the message names them.
    """
    try:
        with open_regular(path) as file:
            trace = read_trace(_lines(file), registry)
    except OSError as fault:
        raise InputError(f"{path} cannot be read ({fault.strerror}); check the path") from fault
    except InputError as fault:
        raise InputError(f"{path}: {fault}") from fault
    if trace.bad:
        faults = "; ".join(f"line {bad.line}: {bad.fault}" for bad in trace.bad[:_TOLD])
        more = f"; and {len(trace.bad) - _TOLD} more" if len(trace.bad) > _TOLD else ""
        raise InputError(f"{path} has {len(trace.bad)} bad lines: {faults}{more}")
    return trace


def read_trace(lines: Iterable[bytes], registry: Registry) -> Trace:
    """Read a trace from lines of JSON; leave bad lines out and list them.

    Raises:
        InputError: The first line is bad; the others cannot be checked without it.
    """
    numbered = ((n, line) for n, line in enumerate(lines, start=1) if line.strip())
    number, first_line = next(numbered, (1, b""))
    try:
        reader = _Reader(_decoded(first_line, _FirstLine), registry)
    except BeliefNestError as fault:
        raise InputError(f"line {number}, the first state: {fault}") from fault
    entries: list[Entry] = []
    bad: list[BadLine] = []
    for number, line in numbered:
        try:
            entries.append(reader.frame(_decoded(line, _TickLine)))
        except BeliefNestError as fault:
            bad.append(BadLine(number, str(fault)))
    return Trace(
        reader.first,
        reader.names,
        reader.perception,
        reader.static_blocks,
        reader.unique,
        tuple(entries),
        tuple(bad),
    )


def record_trace(trace: Trace, journal: Journal, key: TimelineKey) -> None:
    """Append a trace to a journal as a new timeline; BranchError if the key is in use."""
    start = trace.first.tick
    journal.create(key, None, start)
    journal.append(key, trace.entries, trace.entries[-1].tick if trace.entries else start)


class _Reader:
    """Converter from lines to frames; keeps the current state for fields that a line omits."""

    def __init__(self, line: _FirstLine, registry: Registry) -> None:
        self._registry = registry
        self._box = Box(*line.box)
        self.names = tuple(line.agents)
        _check(box_fault(self._box), tick_fault(line.tick), *map(agent_name_fault, self.names))
        if len(self.names) > MOST_AGENTS:
            raise InputError(
                f"there are {len(self.names)} agents; at most {MOST_AGENTS} are allowed"
            )
        for name in line.perception.transparent_blocks:
            registry.state_ids(name)
        self.perception = line.perception
        for name in line.static_blocks:
            registry.state_ids(name)
        self.static_blocks = frozenset(line.static_blocks)
        for name in line.unique:
            registry.item_stack(name)
        self.unique = frozenset(name.removeprefix("minecraft:") for name in line.unique)
        self._tick = line.tick
        self._grid = Terrain.full(self._box.shape, registry.air).draft()
        for low, high, text in line.fills:
            (x0, y0, z0), (x1, y1, z1) = (self._index(low), self._index(high))
            if min(Box(low, high).shape) < 1:
                raise InputError(f"fill {low} to {high} is empty; give its lower corner first")
            self._grid.fill((x0, y0, z0), (x1 + 1, y1 + 1, z1 + 1), registry.state_id(text))
        for place, state in self._blocks(line.blocks).items():
            self._grid[self._box.index(place)] = state
        self._grid = whole_chests(registry, self._box, self._grid.terrain()).draft()
        signs = self._signs(((at.x, at.y, at.z, at.text) for at in line.signs), {})
        self._halves: _Halves = {}
        containers, self._halves = self._containers(line.containers, {})
        self._agents: dict[str, AgentState | None] = {}
        self._agents = self._changed_agents(line.agents)
        self.first = Snapshot(
            line.tick,
            self._box,
            self._grid.terrain(),
            {place: items for place, items in containers.items() if items is not None},
            {name: agent for name, agent in self._agents.items() if agent is not None},
            {n: item for n, item in self._entities(line.items).items() if item is not None},
            signs={place: text_of(block) for place, block in signs.items()},
            sign_claims={
                (at.x, at.y, at.z): self._sign_claims(at) for at in line.signs if at.claims
            },
        )

    def frame(self, line: _TickLine) -> Frame:
        """Return the frame of a line; a line that raises leaves the state unchanged."""
        if line.tick <= self._tick:
            raise InputError(
                f"tick {line.tick} is not later than tick {self._tick}; sort the lines by tick"
            )
        _check(tick_fault(line.tick))
        agents = self._changed_agents(line.agents)
        blocks = self._blocks(line.blocks)
        containers, halves = self._containers(line.containers, blocks)
        frame = Frame(
            line.tick,
            agents,
            blocks | self._signs(line.signs, blocks),
            containers,
            self._entities(line.items),
            tuple(self._event(event, blocks) for event in line.events),
        )
        self._tick = line.tick
        self._agents |= agents
        self._halves |= halves
        for place, state in blocks.items():
            self._grid[self._box.index(place)] = state
        return frame

    def _index(self, place: Position) -> Position:
        if place not in self._box:
            raise InputError(f"{place} lies outside the box {self._box.low} to {self._box.high}")
        return self._box.index(place)

    def _blocks(self, lines: Iterable[_BlockLine]) -> dict[Position, int]:
        blocks = {}
        for x, y, z, text in lines:
            self._index((x, y, z))
            blocks[x, y, z] = self._registry.state_id(text)
        return blocks

    def _signs(
        self, lines: Iterable[_BlockLine], changed: Mapping[Position, int]
    ) -> dict[Position, Block]:
        signs = {}
        for x, y, z, text in lines:
            place = (x, y, z)
            state = changed.get(place, self._grid[self._index(place)])
            try:
                signs[place] = written(self._registry, state, text)
            except InputError as fault:
                raise InputError(f"the sign at {place}: {fault}") from None
        return signs

    def _sign_claims(self, line: _SignLine) -> PlainClaims:
        where = f"the sign at {line.x, line.y, line.z}"
        if not line.text.strip("\n"):
            raise InputError(f"{where} has claims and no text; add the text")
        try:
            claims = self._checked(claims_from_plain(line.claims))
        except BeliefNestError as fault:
            raise InputError(f"{where}: {fault}") from fault
        return tuple(claim.plain() for claim in claims)

    def _checked(self, claims: tuple[Claim, ...]) -> tuple[Claim, ...]:
        """Return claims that are about the box and the agents of the trace."""
        for claim in claims:
            claim.check(self._box, self.names)
        return claims

    def _containers(
        self, lines: Iterable[_ContainerLine], changed: Mapping[Position, int]
    ) -> tuple[dict[Position, Items | None], _Halves]:
        """Return contents by container, and the contents of both halves of double chests.

        A line that names both halves gives each its own; from then on a half that is named alone
        gives its own, too. Before, it gives the contents of the whole chest.
        """
        halves_named: _Halves = {}
        for x, y, z, items in lines:
            place = (x, y, z)
            state = changed.get(place, self._grid[self._index(place)])
            name = self._registry.name(state)
            if items is not None and not self._registry.is_container(name):
                raise InputError(f"the block at {place} is {name}, which holds no items")
            halves_named.setdefault(self._whole(place, changed), {})[place] = items
        contents: dict[Position, Items | None] = {}
        halves: _Halves = {}
        state_at = self._state_at(changed)
        for place, named in halves_named.items():
            parts, halves_before = named, self._halves.get(place, {})
            if (halves_before or len(named) > 1) and is_double(self._registry, state_at, place):
                parts = halves[place] = {**halves_before, **named}
            contents_of_halves = [items for items in parts.values() if items is not None]
            name = self._registry.name(state_at(place))
            slots = slots_at(self._registry, state_at, place)
            for each in contents_of_halves:
                self._items(each, slots, f"a {name}")
            total = dict(sum(map(Counter, contents_of_halves), Counter()))
            contents[place] = self._items(total, slots, f"a {name}") if contents_of_halves else None
        return contents, halves

    def _whole(self, place: Position, changed: Mapping[Position, int]) -> Position:
        """Return the position of the container to which a block belongs."""
        return container_at(self._registry, self._state_at(changed), place)

    def _state_at(self, changed: Mapping[Position, int]) -> StateAt:
        def state_at(place: Position) -> int:
            if place not in self._box:
                return self._registry.air
            return changed[place] if place in changed else self._grid[self._box.index(place)]

        return state_at

    def _items(self, items: Mapping[str, int], slots: int, holder: str) -> dict[str, int]:
        for name, count in items.items():
            self._registry.item_stack(name)
            if count < 1:
                raise InputError(f"{count} of item {quoted(name)}; counts must be positive")
        _check(items_fault(items, self._registry, slots, holder))
        return dict(items)

    def _entities(self, lines: Mapping[int, _ItemLine | None]) -> dict[int, DroppedItem | None]:
        _check(*(dropped_fault(number, None, self._registry) for number in lines))
        return {n: None if item is None else self._item(item) for n, item in lines.items()}

    def _item(self, line: _ItemLine) -> DroppedItem:
        self._items({line.name: line.count}, 1, "a dropped item")
        self._inside(line.position)
        return DroppedItem(line.name, line.count, line.position)

    def _changed_agents(
        self, lines: Mapping[str, _AgentLine | None]
    ) -> dict[str, AgentState | None]:
        return {name: self._agent(name, line) for name, line in lines.items()}

    def _agent(self, name: str, line: _AgentLine | None) -> AgentState | None:
        if name not in self.names:
            raise InputError(f"unknown agent {quoted(name)}; list every agent in the first line")
        if line is None:
            return None
        fields = {k: v for k, v in msgspec.structs.asdict(line).items() if v is not None}
        before = self._agents.get(name)
        if before is None and line.position is None:
            raise InputError(f"agent {quoted(name)} appears without a position; give one")
        if line.position is not None:
            self._inside(line.position)
        numbers = (line.yaw, line.pitch, line.health, line.food)
        if not all(math.isfinite(number) for number in numbers if number is not None):
            raise InputError(
                f"agent {quoted(name)} has a yaw, pitch, health or food that is not a finite number"
            )
        self._items(line.inventory or {}, _AGENT_SLOTS, f"agent {quoted(name)}")
        for slot, item in (line.equipment or {}).items():
            self._registry.item_stack(item)
            if slot not in EQUIPMENT_SLOTS:
                slots = ", ".join(EQUIPMENT_SLOTS)
                raise InputError(
                    f"agent {quoted(name)} has an unknown slot {quoted(slot)}; slots are {slots}"
                )
        return AgentState(**fields) if before is None else replace(before, **fields)

    def _inside(self, point: Point) -> None:
        _check(point_fault(point))
        self._index(block_at(point))

    def _event(self, line: _EventLine, changed: Mapping[Position, int]) -> Event:
        event = event_from(line.kind, line.actor, line.detail, self.names)
        detail = event.detail
        if "position" in detail:
            self._check_place(event.kind, detail["position"], changed)
        if "destination" in detail:
            _check(point_fault(detail["destination"]))
        if "block" in detail:
            self._registry.state_id(detail["block"])
        self._items(detail.get("items", {}), _AGENT_SLOTS, "an agent")
        self._checked(claims_of(event))
        placed = dict(detail)
        if event.kind in AT_CONTAINERS:
            placed["position"] = self._whole(detail["position"], changed)
        return replace(event, detail=placed)

    def _check_place(
        self, kind: EventKind, place: Position, changed: Mapping[Position, int]
    ) -> None:
        before = self._grid[self._index(place)]
        states = (before, changed.get(place, before))
        names = [self._registry.name(state) for state in states]
        if kind in AT_CONTAINERS and not any(map(self._registry.is_container, names)):
            raise InputError(
                f"event {quoted(kind.value)}: the block at {place} is {names[-1]}, which holds "
                "no items"
            )


def _lines(file: BinaryIO) -> Iterator[bytes]:
    """Yield the lines of a file; InputError if one is too long."""
    while line := file.readline(_LONGEST_LINE + 1):
        if len(line) > _LONGEST_LINE:
            raise InputError(f"a line is longer than {_LONGEST_LINE:,} bytes")
        yield line


def _check(*faults: str | None) -> None:
    for fault in faults:
        if fault:
            raise InputError(fault)


def _decoded(line: bytes, kind: Any) -> Any:
    try:
        return decode_json(line, kind)
    except msgspec.MsgspecError as fault:
        raise InputError(str(fault)) from fault
