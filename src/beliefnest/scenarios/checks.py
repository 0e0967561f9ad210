"""Checks of names and places in a document against the world that it describes."""

import msgspec

from beliefnest.errors import ScenarioError
from beliefnest.scenarios.document import Document, KeyPath
from beliefnest.world.double_chests import container_at, other_half, states_in
from beliefnest.world.frames import Snapshot
from beliefnest.world.limits import AGENT_SLOTS, WORN_SLOTS, items_fault, slots_at
from beliefnest.world.paths import parse_path
from beliefnest.world.registry import Registry
from beliefnest.world.texts import quoted
from beliefnest.world.values import Box, Items, Position


def check_items(
    document: Document, path: KeyPath, items: Items, registry: Registry, slots: int, holder: str
) -> None:
    """Refuse unknown items, counts below 1, and more items than the slots of a holder can hold."""
    for name, count in items.items():
        with document.naming((*path, name)):
            registry.item_stack(name)
        if count < 1:
            raise document.fault((*path, name), f"the count is {count}; it must be at least 1")
    if fault := items_fault(items, registry, slots, holder):
        raise document.fault(path, fault)


def check_inside(document: Document, path: KeyPath, position: Position, box: Box) -> None:
    """Refuse a position that lies outside the box."""
    if position not in box:
        raise document.fault(
            path, f"{list(position)} lies outside the box {list(box.low)} to {list(box.high)}"
        )


class Checks(msgspec.Struct, frozen=True):
    """Checks that raise `ScenarioError` with file, line and key.

    Attributes:
        document: The document.
        snapshot: Its first tick.
        registry: Registry of blocks and items.
    """

    document: Document
    snapshot: Snapshot
    registry: Registry

    def fault(self, path: KeyPath, message: str) -> ScenarioError:
        """Return the error about a key."""
        return self.document.fault(path, message)

    def belief_path(self, path: KeyPath, text: str) -> tuple[str, ...]:
        """Return the agents of a belief path."""
        with self.document.naming(path):
            return parse_path(text, self.snapshot.agents)
        raise AssertionError("unreachable")

    def agent(self, path: KeyPath, name: str) -> None:
        """Refuse an unknown agent."""
        if name not in self.snapshot.agents:
            agents = ", ".join(self.snapshot.agents)
            raise self.fault(path, f"there is no agent {quoted(name)}; agents are {agents}")

    def container_at(self, position: Position) -> Position:
        """Return the position of the container to which a block belongs: that of its right half."""
        return container_at(self.registry, self._state_at, position)

    def halves(self, place: Position) -> frozenset[Position]:
        """Return the block positions of the container at a place; none if there is none."""
        whole = self.container_at(place)
        if whole not in self.snapshot.containers:
            return frozenset()
        other = other_half(self.registry, self._state_at(whole), whole)
        is_whole = other is not None and self.container_at(other[0]) == whole
        return frozenset((whole, other[0]) if is_whole and other is not None else (whole,))

    def container(self, path: KeyPath, position: Position) -> Position:
        """Return the position of a container, given either half; refuse one without a container."""
        if (whole := self.container_at(position)) not in self.snapshot.containers:
            places = ", ".join(str(list(place)) for place in self.snapshot.containers)
            raise self.fault(
                path, f"no container stands at {list(position)}; there are {places or 'none'}"
            )
        return whole

    def contents(self, path: KeyPath, place: Position, items: Items) -> None:
        """Refuse items that the container at a place could not hold."""
        name = self.registry.name(self._state_at(place))
        slots = slots_at(self.registry, self._state_at, place)
        self.items(path, items, slots, f"a {name}")

    def _state_at(self, place: Position) -> int:
        return states_in(self.snapshot.box, self.snapshot.blocks, self.registry.air)(place)

    def items(self, path: KeyPath, items: Items, slots: int, holder: str) -> None:
        """Refuse unknown items, counts below 1, and more than the slots of a holder can hold."""
        check_items(self.document, path, items, self.registry, slots, holder)

    def possessions(self, path: KeyPath, items: Items) -> None:
        """Refuse items that an agent could not have."""
        self.items(path, items, AGENT_SLOTS + WORN_SLOTS, "an agent")

    def inside(self, path: KeyPath, position: Position) -> None:
        """Refuse a position outside the box."""
        check_inside(self.document, path, position, self.snapshot.box)

    def state(self, path: KeyPath, text: str | None) -> str | None:
        """Return the canonical text of a block state; None stays None."""
        if text is None:
            return None
        with self.document.naming(path):
            return self.registry.text(self.registry.state_id(text))

    def block_name(self, path: KeyPath, name: str) -> None:
        """Refuse an unknown block."""
        with self.document.naming(path):
            self.registry.state_ids(name)
