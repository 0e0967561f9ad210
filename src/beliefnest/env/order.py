"""Order in which an agent numbers the things of a scenario: as it came to know them.

An order holds what one simulator believes and nothing else. It cannot reach the world, so that no
number in observations and actions depends on anything that the agent has not perceived.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import Any

import msgspec
import numpy as np
import numpy.typing as npt

from beliefnest.belief.view import State
from beliefnest.world.doors import is_door, is_switch
from beliefnest.world.paths import BeliefPath
from beliefnest.world.registry import Registry
from beliefnest.world.signs import is_sign
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import Box, Position

PLACED = ("containers", "doors", "levers", "buttons", "signs")
"""Kinds of things that are blocks."""
KINDS = ("agents", "items", *PLACED)
"""Kinds of things that are numbered."""


class Things(msgspec.Struct, frozen=True):
    """Things in order.

    Attributes:
        agents: Names of agents.
        items: Names of items.
        containers: Positions of containers.
        doors: Positions of doors (lower half), trapdoors and gates.
        levers: Positions of levers.
        buttons: Positions of buttons.
        signs: Positions of signs.
    """

    agents: tuple[str, ...] = ()
    items: tuple[str, ...] = ()
    containers: tuple[Position, ...] = ()
    doors: tuple[Position, ...] = ()
    levers: tuple[Position, ...] = ()
    buttons: tuple[Position, ...] = ()
    signs: tuple[Position, ...] = ()

    @property
    def counts(self) -> Mapping[str, int]:
        """Number of things of each kind."""
        return {kind: len(getattr(self, kind)) for kind in KINDS}


BLOCK_CLASSES = ("free", "solid", *PLACED)
"""Classes of blocks in observations, by number; -1: unknown."""


@cache
def block_classes() -> npt.NDArray[np.int8]:
    """Return the class of each block state, by state number; the last one is for the unknown."""
    registry = Registry.load()
    classes = np.full(len(registry.state_shape) + 1, -1, np.int8)
    for name in registry.block_names:
        kind = _kind_of(registry, name) or ("solid" if registry.is_solid(name) else "free")
        states = registry.state_ids(name)
        classes[states.start : states.stop] = BLOCK_CLASSES.index(kind)
    return classes


@cache
def moved_state(state: int) -> int:
    """Return 1 for a switch that is on or a door that is open, 0 for off or shut, else -1."""
    properties = {} if state < 0 else Registry.load().properties(state)
    value = properties.get("open", properties.get("powered"))
    return -1 if value is None else int(value == "true")


def placed_in(box: Box, blocks: Terrain) -> Mapping[str, Sequence[Position]]:
    """Return by kind the positions of things that are blocks, in order."""
    x, y, z = box.low
    places: dict[str, list[Position]] = {kind: [] for kind in PLACED}
    is_placed = _is_placed()
    if blocks.is_dense:
        cells = np.argwhere(is_placed[blocks.dense()])
    else:  # Only chunks with such states are looked at.
        cells = blocks.find([state for state in blocks.states if is_placed[state]])
    for i, j, k in cells.tolist():
        kind = BLOCK_CLASSES[block_classes()[blocks[i, j, k]]]
        places[kind].append((x + i, y + j, z + k))
    return places


@cache
def _is_placed() -> npt.NDArray[np.bool_]:
    """Return by block state whether it is a thing that is numbered; the last: the unknown.

    Upper halves of doors are left out: they move together with the lower ones.
    """
    is_placed: npt.NDArray[np.bool_] = block_classes() >= BLOCK_CLASSES.index(PLACED[0])
    registry = Registry.load()
    for state in np.flatnonzero(is_placed).tolist():
        is_placed[state] = registry.properties(state).get("half") != "upper"
    return is_placed


def _kind_of(registry: Registry, name: str) -> str | None:
    if registry.is_container(name):
        return "containers"
    if is_door(name):
        return "doors"
    if name == "lever":
        return "levers"
    if is_switch(name):
        return "buttons"
    return "signs" if is_sign(name) else None


@dataclass
class KnownOrder:
    """Order of things by the time at which an agent's beliefs first had them.

    Things that it has at the same time are in the order of their names or positions. A number
    never changes: a new thing gets the next one, and a thing that is gone keeps its own.

    Args:
        declared: Things that the holder knows by the rules; they come first.
    """

    declared: Things = field(default_factory=Things)
    _known: dict[str, dict[Any, int]] = field(init=False)
    _rows: dict[BeliefPath, int] = field(default_factory=dict, init=False)
    _seen: dict[BeliefPath, tuple[Terrain, int]] = field(default_factory=dict, init=False)

    def __post_init__(self) -> None:
        self._known = {kind: {} for kind in KINDS}
        for kind in KINDS:
            self._add(kind, getattr(self.declared, kind))

    @property
    def things(self) -> Things:
        """The things by now, in order."""
        return Things(**{kind: tuple(numbers) for kind, numbers in self._known.items()})

    def number(self, kind: str, thing: object) -> int | None:
        """Return the number of a thing; None: the beliefs have had no such thing so far."""
        return self._known[kind].get(thing)

    def rows(self, paths: Iterable[BeliefPath]) -> Mapping[BeliefPath, int]:
        """Return rows of beliefs below the holder's own, as soon as it knows all their agents.

        They are in the order in which it came to know these, as things are.
        """
        numbers = self._known["agents"]
        new = [p for p in paths if p not in self._rows and numbers.keys() >= {*p}]
        for path in sorted(new, key=lambda path: [numbers[name] for name in path]):
            self._rows[path] = len(self._rows)
        return self._rows

    def note(self, state: State) -> None:
        """Take in a later state of the agent's belief, or of a belief below it."""
        terrain, (before, said) = state.blocks.terrain, self._seen.get(state.path, (None, 0))
        self._seen[state.path] = terrain, len(state.chat)
        self._add("agents", _agents_in(state, said))
        self._add("items", _items_in(state))
        self._add("containers", state.containers)
        if before is None or not _is_same(before, terrain):
            for kind, places in placed_in(state.box, terrain).items():
                self._add(kind, places)

    def _add(self, kind: str, things: Iterable[Any]) -> None:
        numbers = self._known[kind]
        for thing in sorted({*things} - numbers.keys()):
            numbers[thing] = len(numbers)


def _agents_in(state: State, said: int) -> set[str]:
    """Return the agents that a simulator has perceived or heard; `said`: lines known before."""
    names = {
        name
        for name, agent in state.agents.items()
        if agent.position is not None or agent.basis is not None or agent.inventory
    }
    names |= {speaker for _, speaker, _ in state.chat[said:]}
    # The holder of an order knows itself; whom its nested beliefs are about it may not know.
    return names | {*state.path} if len(state.path) == 1 else names


def _items_in(state: State) -> set[str]:
    """Return the items that a simulator believes to exist."""
    names = {name for each in state.containers.values() for name in each.items}
    for agent in state.agents.values():
        names |= {*agent.inventory, *(agent.equipment or {}).values()}
    return names | {each.name for each in state.items.values()}


def _is_same(former: Terrain, blocks: Terrain) -> bool:
    """Return True if two terrains are the same; False if that would take long to find out."""
    if former is blocks:
        return True
    both_small = former.is_dense and blocks.is_dense
    return both_small and np.array_equal(former.dense(), blocks.dense())
