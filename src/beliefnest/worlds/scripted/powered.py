"""State of a scripted world, and what nobody moves by hand in it: power, plates, lamps, buttons."""

import functools
import math
from collections.abc import Collection, Iterator, Mapping
from typing import Any

from msgspec.structs import replace

from beliefnest.errors import BeliefNestError, InputError, WorldError
from beliefnest.owned import Barred
from beliefnest.world.circuits import Circuits
from beliefnest.world.doors import is_switch
from beliefnest.world.double_chests import container_at, is_double, other_half
from beliefnest.world.event_kinds import EventKind
from beliefnest.world.frames import BlockGrid, PlainClaims
from beliefnest.world.handling import Handling, pressed_button, with_power
from beliefnest.world.limits import container_slots, divided, items_fault
from beliefnest.world.registry import AIR, Registry
from beliefnest.world.signs import written
from beliefnest.world.terrain import Terrain
from beliefnest.world.texts import quoted
from beliefnest.world.values import (
    AgentState,
    Block,
    Box,
    Event,
    Items,
    Point,
    Position,
    Sign,
    block_at,
)
from beliefnest.worlds.scripted.circuit import Circuit
from beliefnest.worlds.scripted.facts import (
    Pending,
    ScriptedFacts,
    checked_box,
    sum_of,
    whole_position,
)


class _ScriptedState(Barred):
    """Facts of a scripted world, with access to single parts.

    Args:
        box: Two inclusive corners of block positions.

    Raises:
        WorldError: The box is invalid.
    """

    _called = "the scripted world"

    def __init__(self, box: tuple[Position, Position]) -> None:
        self._registry = Registry.load()
        self._plates = Circuits.load().plates
        self._box = checked_box(box)
        self._facts = ScriptedFacts(Terrain.full(self._box.shape, AIR).draft(), {}, {}, {})

    @property
    def box(self) -> Box:
        """Region of the world."""
        return self._box

    @property
    def agents(self) -> Mapping[str, AgentState]:
        """States of all agents by name."""
        return dict(self._facts.agents)

    def agent(self, name: str) -> AgentState:
        """Return the state of an agent; WorldError if there is none of that name."""
        if name not in self._facts.agents:
            raise WorldError(f"no agent {quoted(name)}; agents are {sorted(self._facts.agents)}")
        return self._facts.agents[name]

    def state_of(self, name: str) -> AgentState | None:
        """Return the state of an agent; None if there is none of that name."""
        return self._facts.agents.get(name)

    @property
    def containers(self) -> Mapping[Position, Items]:
        """Contents of all containers; must not be changed."""
        return self._facts.containers

    def contents(self, position: Position) -> Items:
        """Return the contents of a container, given either half of a double chest.

        Raises:
            WorldError: There is no container at the position.
        """
        return dict(self._facts.containers[self._container(position)])

    def container_at(self, position: Position) -> Position:
        """Return the position of the container to which a block belongs: that of its right half."""
        return container_at(self._registry, self.state_at, position)

    def block_text(self, place: Position) -> str:
        """Return the block state at a position as text; air outside the box."""
        return self._registry.text(self.state_at(place))

    @property
    def terrain(self) -> Terrain:
        """Block states of the box, as they are now."""
        return self._facts.blocks.terrain()

    @property
    def blocks(self) -> BlockGrid:
        """Block states of the box as one dense array, which later ticks do not change."""
        return self.terrain.dense()

    def state_at(self, place: Position) -> int:
        """Return the block state at a position; air outside the box."""
        return self._facts.blocks[self._box.index(place)] if place in self._box else AIR

    @property
    def signs(self) -> Mapping[Position, str]:
        """Texts of signs by position."""
        return dict(self._facts.signs)

    def _change(self, pending: Pending, place: Position, state: int, actor: str | None) -> None:
        """Replace a block in the current tick; what remains of a double chest is a single one."""
        before = self.state_at(place)
        pending.replaced.append((self._box.index(place), before))
        halves = [other_half(self._registry, each, place) for each in (before, state)]
        near = {place, *(each[0] for each in halves if each is not None)}
        contents_before = {each: self._facts.containers.get(each) for each in near}
        was_double = is_double(self._registry, self.state_at, place)
        self._put(place, self._registry.text(state))
        pending.containers |= {
            each for each in near if self._facts.containers.get(each) is not contents_before[each]
        }
        gone = self._registry.name(before) != self._registry.name(state)
        if was_double and gone and halves[0] is not None:
            rest = halves[0][0]
            single = self._registry.changed(self.state_at(rest), type="single")
            self._change(pending, rest, single, None)
        pending.blocks[place] = self._block(place)
        detail: dict[str, Any] = {"position": place, "block": self._registry.text(state)}
        if place in self._facts.sign_claims:
            # A sign that was turned keeps its claims.
            detail["claims"] = self._facts.sign_claims[place]
        pending.events.append(Event(EventKind.BLOCK_UPDATE, actor, detail))

    def _undo(self, pending: Pending) -> None:
        """Restore the facts before the current tick."""
        for index, state in reversed(pending.replaced):
            self._facts.blocks[index] = state
        self._facts = pending.saved

    def _block(self, place: Position) -> Block:
        """Return the block at a position, with its text if it is a sign."""
        state = self.state_at(place)
        return Sign(state, self._facts.signs[place]) if place in self._facts.signs else state

    def _write(self, place: Position, text: str) -> None:
        try:
            block = written(self._registry, self.state_at(place), text)
        except InputError as fault:
            raise WorldError(f"the text at {place} cannot be written: {fault}") from None
        self._wipe(place)
        if isinstance(block, Sign):
            self._facts.signs[place] = block.text

    def _claim_on(self, place: Position, claims: PlainClaims) -> None:
        """Set the claims of the text on a sign."""
        if claims and place not in self._facts.signs:
            raise WorldError(f"there is no text at {place}, so it cannot carry claims; write one")
        if claims:
            self._facts.sign_claims[place] = claims

    def _wipe(self, place: Position) -> None:
        self._facts.signs.pop(place, None)
        self._facts.sign_claims.pop(place, None)

    def _put(self, place: Position, block: str) -> None:
        state = self._state(block)
        before = self._registry.name(self.state_at(place))
        name = self._registry.name(state)
        if before != name:
            self._wipe(place)
        if is_double(self._registry, self.state_at, place):
            self._part(place)
        self._facts.blocks[self._box.index(place)] = state
        if (state in self._plates) is not (place in self._facts.plates):
            self._facts.plates ^= {place}
        if self._registry.is_container(name):
            if before != name or place not in self._facts.containers:
                self._facts.containers[place] = {}
        else:
            self._facts.containers.pop(place, None)
        if is_double(self._registry, self.state_at, place):
            self._join(place)

    def _part(self, place: Position) -> None:
        """Divide the contents of a double chest among its halves; the right one is filled first."""
        right, left = self._right_and_left(place)
        name = self._registry.name(self.state_at(right))
        kept, rest = divided(self._facts.containers[right], self._registry, container_slots(name))
        self._facts.containers[right], self._facts.containers[left] = kept, rest

    def _join(self, place: Position) -> None:
        """Put the contents of both halves of a double chest together."""
        right, left = self._right_and_left(place)
        contents = [self._facts.containers.pop(half, {}) for half in (right, left)]
        self._facts.containers[right] = sum_of(*contents)

    def _right_and_left(self, place: Position) -> tuple[Position, Position]:
        right = container_at(self._registry, self.state_at, place)
        left = other_half(self._registry, self.state_at(right), right)
        assert left is not None  # the chest is double
        return right, left[0]

    def _fill(self, block: str, low: Position, high: Position) -> None:
        """Set all blocks of a cuboid of a new world."""
        state = self._state(block)
        if self._registry.is_container(self._registry.name(state)) or state in self._plates:
            raise WorldError(f"{quoted(block)} cannot fill a cuboid; give each one in 'blocks'")
        if any(a > b for a, b in zip(low, high, strict=True)):
            raise WorldError(f"the cuboid {low} to {high} is empty; give its lower corner first")
        x, y, z = self._box.index(high)
        self._facts.blocks.fill(self._box.index(low), (x + 1, y + 1, z + 1), state)

    def _set_agent(
        self,
        name: str,
        *,
        inventory: dict[str, int] | None = None,
        equipment: dict[str, str] | None = None,
    ) -> None:
        agent = self.agent(name)
        items = agent.inventory if inventory is None else inventory
        worn = agent.equipment if equipment is None else equipment
        gone = agent.inventory.keys() - items.keys()
        self._facts.agents[name] = replace(
            agent,
            inventory=items,
            equipment={slot: item for slot, item in worn.items() if item not in gone},
        )

    def _container(self, position: Position) -> Position:
        """Return the position of the container to which the block at a position belongs."""
        place = container_at(self._registry, self.state_at, self._inside(position))
        if place not in self._facts.containers:
            there = self._registry.text(self.state_at(place))
            raise WorldError(f"there is no container at {place}, but {there}")
        return place

    def _inside(self, position: Position) -> Position:
        return self._in_box(whole_position(position))

    def _in_box(self, place: Position) -> Position:
        if place not in self._box:
            raise WorldError(
                f"position {place} lies outside the box {self._box.low}..{self._box.high}"
            )
        return place

    def _feet(self, position: Point) -> Point:
        if len(position) != 3 or not all(map(math.isfinite, position)):
            raise WorldError(f"{quoted(position)} is no point; give three finite numbers")
        x, y, z = map(float, position)
        self._in_box(block_at((x, y, z)))
        return (x, y, z)

    def _state(self, block: str) -> int:
        try:
            return self._registry.state_id(block)
        except BeliefNestError as error:
            raise WorldError(str(error)) from None

    def _items(self, items: Items) -> dict[str, int]:
        for name, count in items.items():
            if not self._registry.has_item(name):
                raise WorldError(f"there is no item {quoted(name)}")
            if not isinstance(count, int) or isinstance(count, bool) or count <= 0:
                raise WorldError(
                    f"count {quoted(count)} of {quoted(name)}; give a whole number above 0"
                )
        return dict(items)

    def _fitting(self, who: str, inventory: Items, moved: Items, slots: int) -> dict[str, int]:
        """Return the items of a holder after a transfer; WorldError if they do not fit."""
        items = sum_of(inventory, moved)
        if fault := items_fault(items, self._registry, slots, who):
            raise WorldError(f"{moved} cannot be moved: {fault}")
        return items


_AGENT, _ITEM = (0.3, 1.8), (0.125, 0.25)
"""Half width and height of bodies."""
_LAMP = "redstone_lamp"


class PoweredState(_ScriptedState):
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
