"""Rules of redstone power: from sources, through blocks that carry it, along wires.

The embedded world has the same rules in `server/plugins/lib/circuit.js`. Both read the same facts
about blocks; `tests/worlds/test_circuits.py` compares them on random circuits.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

from beliefnest.world.circuits import Circuits
from beliefnest.world.handling import plus
from beliefnest.world.registry import Registry
from beliefnest.world.values import Position

Offset = tuple[int, int, int]

FACES: Sequence[Offset] = ((0, -1, 0), (0, 1, 0), (0, 0, -1), (0, 0, 1), (-1, 0, 0), (1, 0, 0))
"""Steps to the neighbours of a block: down, up, north, south, west, east."""

_DOWN, _UP = FACES[:2]
_SIDES: Mapping[str, Offset] = dict(zip(("north", "south", "west", "east"), FACES[2:], strict=True))
_OPPOSITE = {"north": "south", "south": "north", "west": "east", "east": "west"}
_WIRE = "redstone_wire"
_NEAR = tuple(
    (x, y, z)
    for x in range(-2, 3)
    for y in range(-2, 3)
    for z in range(-2, 3)
    if abs(x) + abs(y) + abs(z) <= 2
)
"""Steps to the cells that a source or wire may power, itself included."""


class Circuit:
    """Power in a world at one moment. It reads each block once: tell it of changes with `note`.

    Args:
        state_at: Function that returns the block state at a position; air outside the world.
    """

    def __init__(self, state_at: Callable[[Position], int]) -> None:
        self.state_at = state_at
        self._states: dict[Position, int] = {}
        self._registry = Registry.load()
        self._facts = Circuits.load()
        self._wires = self._registry.state_ids(_WIRE)

    def note(self, place: Position, state: int) -> None:
        """Take note of a new block state."""
        self._states[place] = state

    def reacts(self, before: int, after: int) -> bool:
        """Return True if a change of a block from one state to another may change power."""
        facts, registry = self._facts, self._registry
        if any(state in self._wires or state in facts.sources for state in (before, after)):
            return True
        if (before in facts.conductors) is not (after in facts.conductors):
            return True
        responds = after in facts.powered or after in facts.unpowered
        return responds and registry.name(before) != registry.name(after)

    def consequences(self, changed: Position) -> dict[Position, int]:
        """Return the new states of wires and other blocks that a change affects, in order.

        These are noted as well, as by `note`. A lamp is in the result as soon as it loses power.

        Args:
            changed: Position of the change, which the world or `note` tells already.
        """
        levels = self._levels(self._network(changed))
        states = {
            place: self._wire(place, level)
            for place, level in levels.items()
            if level != self._power(place)
        }
        self._states.update(states)
        for place in _around([changed, *states]):
            moved = self.answer(place)
            self._states.update(moved)
            states.update(moved)
        return states

    def answer(self, place: Position) -> dict[Position, int]:
        """Return the new states of a block, and of a door's other half, that power changes."""
        state, facts = self._at(place), self._facts
        if state not in facts.powered and state not in facts.unpowered:
            return {}
        parts = self._parts(place)
        is_powered = any(self.is_powered(part) for part in parts)
        states = facts.powered if is_powered else facts.unpowered
        if state not in states:
            return {}
        return {part: states[self._at(part)] for part in parts if self._at(part) in states}

    def is_powered(self, place: Position) -> bool:
        """Return True if a block has power from a source, a wire or a block that carries it."""
        for beside in _beside(place):
            if self._at(beside) in self._facts.sources or self._wire_powers(beside, place):
                return True
            if self._conducts(beside) and (
                self._holds_source(beside)
                or any(self._wire_powers(other, beside) for other in _beside(beside))
            ):
                return True
        return False

    def _at(self, place: Position) -> int:
        state = self._states.get(place)
        if state is None:
            state = self._states[place] = self.state_at(place)
        return state

    def _parts(self, place: Position) -> list[Position]:
        step = self._facts.halves.get(self._at(place), 0)
        if not step:
            return [place]
        other = (place[0], place[1] + step, place[2])
        same = self._registry.name(self._at(other)) == self._registry.name(self._at(place))
        return [place, other] if same else [place]

    def _conducts(self, place: Position) -> bool:
        return self._at(place) in self._facts.conductors

    def _is_wire(self, place: Position) -> bool:
        return self._at(place) in self._wires

    def _power(self, place: Position) -> int:
        return int(self._registry.properties(self._at(place))["power"])

    def _holds_source(self, place: Position) -> bool:
        """Return True if a source is attached to a block."""
        for beside in _beside(place):
            strong = self._facts.sources.get(self._at(beside), -1)
            if strong >= 0 and plus(beside, FACES[strong]) == place:
                return True
        return False

    def _given(self, place: Position) -> int:
        """Return the power that sources give to a wire: all or nothing."""
        is_given = any(
            self._at(beside) in self._facts.sources
            or (self._conducts(beside) and self._holds_source(beside))
            for beside in _beside(place)
        )
        return self._facts.facts.range if is_given else 0

    def _feeders(self, place: Position) -> Iterator[Position]:
        """Yield the wires from which a wire gets power."""
        covered = self._conducts(plus(place, _UP))
        for step in _SIDES.values():
            beside = plus(place, step)
            if self._is_wire(beside):
                yield beside
            elif not self._conducts(beside):
                if self._is_wire(below := plus(beside, _DOWN)):
                    yield below
            elif not covered and self._is_wire(above := plus(beside, _UP)):
                yield above

    def _connection(self, place: Position, side: str) -> str:
        """Return how a wire connects to a side: `none`, `side` or `up`."""
        beside = plus(place, _SIDES[side])
        climbs = self._is_wire(plus(beside, _UP)) and not self._conducts(plus(place, _UP))
        if climbs and self._registry.boxes(self._at(beside)):
            return "up"
        falls = not self._conducts(beside) and self._is_wire(plus(beside, _DOWN))
        return "side" if falls or self._at(beside) in self._facts.connecting else "none"

    def _connections(self, place: Position) -> dict[str, str]:
        """Return how a wire connects by side.

        The end of a line points on. A wire without neighbours keeps its form.
        """
        connections = {side: self._connection(place, side) for side in _SIDES}
        to = [side for side in _SIDES if connections[side] != "none"]
        if len(to) == 1:
            return {**connections, _OPPOSITE[to[0]]: "side"}
        properties = self._registry.properties(self._at(place))
        if to or all(properties[side] == "none" for side in _SIDES):
            return connections
        return dict.fromkeys(_SIDES, "side")

    def _wire(self, place: Position, power: int) -> int:
        sides = ",".join(f"{side}={how}" for side, how in self._connections(place).items())
        return self._registry.state_id(f"{_WIRE}[{sides},power={power}]")

    def _wire_powers(self, wire: Position, place: Position) -> bool:
        """Return True if there is a wire with power at a position that powers a block beside it."""
        if not self._is_wire(wire) or not self._power(wire):
            return False
        step = (place[0] - wire[0], place[1] - wire[1], place[2] - wire[2])
        if step[1]:
            return step == _DOWN
        connections = self._connections(wire)
        return any(step == _SIDES[side] and how != "none" for side, how in connections.items())

    def _network(self, changed: Position) -> list[Position]:
        """Return the wires near a position and all that hang together with them, in order."""
        places: set[Position] = set()
        left = [place for place in _around([changed]) if self._is_wire(place)]
        while left:
            place = left.pop()
            if place in places:
                continue
            places.add(place)
            beside = [(x, y + up, z) for x, y, z in _level(place) for up in (-1, 0, 1)]
            left += [other for other in beside if self._is_wire(other)]
        return sorted(places)

    def _levels(self, wires: Sequence[Position]) -> dict[Position, int]:
        """Return the power of each wire of a network."""
        levels = {place: self._given(place) for place in wires}
        feeding = {place: list(self._feeders(place)) for place in wires}
        changed = True
        while changed:
            changed = False
            for place, feeders in feeding.items():
                level = max([levels[place], *(levels[other] - 1 for other in feeders)])
                changed = changed or level != levels[place]
                levels[place] = level
        return levels


def _around(places: Iterable[Position]) -> list[Position]:
    """Return the positions within two steps of some positions, in order."""
    return sorted({plus(place, step) for place in places for step in _NEAR})


def _beside(place: Position) -> list[Position]:
    return [plus(place, step) for step in FACES]


def _level(place: Position) -> list[Position]:
    return [plus(place, step) for step in _SIDES.values()]


def may_be_of_power(registry: Registry, before: int, after: int) -> bool:
    """Return True if power, or the lack of it, may have turned one block state into another."""
    facts = Circuits.load()
    return (
        after in (facts.powered.get(before), facts.unpowered.get(before))
        or before in facts.plates
        or {registry.name(before), registry.name(after)} == {_WIRE}
    )
