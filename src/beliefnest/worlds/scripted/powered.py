"""Part of the scripted world that nobody moves by hand: power, plates, lamps, buttons."""

import functools
import math
from collections.abc import Collection, Iterator

from beliefnest.world.circuits import Circuits
from beliefnest.world.doors import is_switch
from beliefnest.world.handling import Handling, pressed_button, with_power
from beliefnest.world.registry import Registry
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import Box, Point, Position
from beliefnest.worlds.scripted.circuit import Circuit
from beliefnest.worlds.scripted.facts import Pending
from beliefnest.worlds.scripted.state import ScriptedState

_AGENT, _ITEM = (0.3, 1.8), (0.125, 0.25)
"""Half width and height of bodies."""
_LAMP = "redstone_lamp"


class PoweredState(ScriptedState):
    """Facts of a scripted world that react to changes, and to time.

    Args:
        box: Two inclusive corners of block positions.
    """

    def __init__(self, box: tuple[Position, Position]) -> None:
        super().__init__(box)
        self._tick = 0

    def moved_by(self, switch: Position) -> dict[Position, int]:
        """Return the new states of blocks that the use of a switch would move."""
        before = self.state_at(switch)
        is_on = self._registry.properties(before)["powered"] == "true"
        circuit = Circuit(self.state_at)
        circuit.note(switch, with_power(self._registry, before, powered=not is_on))
        return circuit.consequences(switch)

    def _alter(self, pending: Pending, place: Position, state: int) -> None:
        """Replace a block; let wires and other blocks react."""
        before = self.state_at(place)
        self._change(pending, place, state, None)
        circuit = Circuit(self.state_at)
        if not circuit.reacts(before, state):
            return
        for other, after in circuit.consequences(place).items():
            there = self.state_at(other)
            is_lamp = self._registry.name(there) == _LAMP
            if is_lamp and self._registry.properties(there)["lit"] == "true":
                self._wait(pending, other, Circuits.load().facts.dims)
            else:
                self._change(pending, other, after, None)

    def _wait(self, pending: Pending, place: Position, ticks: int) -> None:
        """Let a block react when some ticks have passed, unless it waits already.

        The tick in which somebody acts counts. In the embedded world, too, agents act before its
        time is counted.
        """
        self._facts.due.setdefault(place, self._tick + ticks + pending.is_late)

    def _let_time_pass(self, pending: Pending) -> None:
        """Let blocks react to the end of the current tick."""
        pending.is_late = True
        due = [place for place, tick in self._facts.due.items() if tick <= self._tick + 1]
        for place in due:
            del self._facts.due[place]
        for place in due:
            self._end(pending, place)
        for place in self._touched():
            state = self.state_at(place)
            if self._registry.properties(state)["powered"] == "false":
                self._alter(pending, place, with_power(self._registry, state, powered=True))
            self._wait(pending, place, Circuits.load().facts.plate_looks)

    def _end(self, pending: Pending, place: Position) -> None:
        """Let a block do what it waited for."""
        state, registry = self.state_at(place), self._registry
        if Handling.load().is_pressed(registry, state):
            out = pressed_button(registry, self.state_at, place, powered=False)
            self._alter(pending, place, out)
        elif state in Circuits.load().plates:
            if registry.properties(state)["powered"] == "true" and place not in self._touched():
                self._alter(pending, place, with_power(registry, state, powered=False))
        elif registry.name(state) == _LAMP:
            for part, after in Circuit(self.state_at).answer(place).items():
                self._change(pending, part, after, None)

    def _touched(self) -> list[Position]:
        """Return the plates on which somebody or something stands, in the order of the bodies."""
        if not self._facts.plates:
            return []
        facts, plates = self._facts, Circuits.load().plates
        places = [p for each in facts.agents.values() for p in self._under(each.position, _AGENT)]
        places += [
            place
            for each in facts.items.values()
            for place in self._under(each.position, _ITEM)
            if plates[self.state_at(place)] == "all"
        ]
        return list(dict.fromkeys(places))

    def _under(self, feet: Point, size: tuple[float, float]) -> Iterator[Position]:
        """Yield the plates that a body touches."""
        (x, y, z), (half, height), facts = feet, size, Circuits.load().facts
        for i in sorted({math.floor(x - half), math.floor(x + half)}):
            for k in sorted({math.floor(z - half), math.floor(z + half)}):
                place = (i, math.floor(y), k)
                if (
                    place in self._facts.plates
                    and y < place[1] + facts.plate_height
                    and y + height > place[1]
                    and _overlaps(x, half, i, facts.plate_inset)
                    and _overlaps(z, half, k, facts.plate_inset)
                ):
                    yield place


def plates_in(box: Box, blocks: Terrain) -> frozenset[Position]:
    """Return the positions of pressure plates in a grid."""
    return frozenset(_places(box, blocks, Circuits.load().plates))


def switches_in(box: Box, blocks: Terrain) -> list[Position]:
    """Return the positions of levers, buttons and pressure plates in a grid, in order."""
    return list(_places(box, blocks, _switch_states()))


def _places(box: Box, blocks: Terrain, wanted: Collection[int]) -> Iterator[Position]:
    """Yield the positions of blocks with wanted states."""
    x, y, z = box.low
    for i, j, k in blocks.find(wanted).tolist():
        yield (x + i, y + j, z + k)


@functools.cache
def _switch_states() -> frozenset[int]:
    registry = Registry.load()
    switches = registry.states_of(filter(is_switch, registry.block_names))
    return frozenset({*switches, *Circuits.load().plates})


def _overlaps(middle: float, half: float, low: int, inset: float) -> bool:
    return middle + half > low + inset and middle - half < low + 1 - inset
