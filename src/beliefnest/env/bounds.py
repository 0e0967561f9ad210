"""Arrays of observations: their sizes, and beliefs as arrays.

Nothing here can reach the world: an array is a function of a belief and of the order in which its
holder came to know things.
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import msgspec
import numpy as np
import numpy.typing as npt

from beliefnest.belief.view import State
from beliefnest.env.order import (
    BLOCK_CLASSES,
    KINDS,
    KnownOrder,
    Things,
    block_classes,
    moved_state,
)
from beliefnest.errors import InputError
from beliefnest.world.claims import Claim
from beliefnest.world.paths import BeliefPath
from beliefnest.world.values import Box, Position

Arrays = dict[str, npt.NDArray[Any]]
"""An observation or a belief as arrays by name."""

ArrayShape = tuple[tuple[int, ...], type[np.generic], float, float]
"""Shape, type, least and greatest value of an array; a least value of -1 means unknown."""

Phrases = Mapping[str, Sequence[Claim]]
"""Utterances that agents can choose, with the claims of each."""

_MOVED = ("doors", "levers", "buttons")
_BELOW = "beliefs_"
_OF_OBSERVER = ("tick", "me")
"""Arrays that only the observer's own belief has: they would be equal in beliefs below it."""
_FARTHEST = 3.0e7
"""Distance of Minecraft's border from the origin, in blocks."""


class ThingsLayout(Things, frozen=True, kw_only=True):
    """All things of an instance. Its user sees them all; each agent numbers those that it knows.

    Names are sorted, positions are in order.

    Attributes:
        box: Region of the scenario; `blocks` has its shape.
        phrases: Texts that can be said and written on signs.
        places: Named places, sorted by name.
    """

    box: Box
    phrases: tuple[str, ...]
    places: tuple[Position, ...] = ()


class SpaceBounds(msgspec.Struct, frozen=True):
    """Sizes of the arrays, which are the same for all instances and agents.

    Attributes:
        box: Region of the scenario; `blocks` has its shape.
        most: Greatest number of things of each kind.
        phrases: Texts that can be said and written on signs.
        nested: Two greatest numbers: of one agent's beliefs about beliefs, and of names that follow
            the agent's own in the path of such a belief.
    """

    box: Box
    most: Mapping[str, int]
    phrases: tuple[str, ...]
    nested: tuple[int, int] = (0, 0)

    @classmethod
    def of(cls, layouts: Iterable[ThingsLayout], sizes: Mapping[str, int]) -> "SpaceBounds":
        """Return the least bounds of several instances.

        Args:
            layouts: Layouts of instances.
            sizes: Greatest numbers by kind, which replace those of the instances.

        Raises:
            InputError: A kind does not exist, a number is below 0, or boxes differ.
        """
        for kind, number in sizes.items():
            if kind not in KINDS:
                raise InputError(f"sizes names {kind!r}; kinds are {', '.join(KINDS)}")
            if isinstance(number, bool) or not isinstance(number, int) or number < 0:
                raise InputError(f"sizes gives {number!r} {kind}; give a whole number from 0 on")
        first, *others = layouts
        counts = [each.counts for each in (first, *others)]
        most = {kind: max(each[kind] for each in counts) for kind in KINDS}
        most["places"] = max(len(each.places) for each in (first, *others))
        bounds = cls(first.box, {**most, **sizes}, first.phrases)
        for each in others:
            bounds.check_box(each)
        return bounds

    def check_box(self, layout: ThingsLayout) -> None:
        """Raise InputError if an instance has another box."""
        if layout.box.shape != self.box.shape:
            sides = (" x ".join(map(str, each.shape)) for each in (layout.box, self.box))
            raise InputError(
                "an instance has a box of {} blocks, another one of {}, so that their arrays do "
                "not fit; give all the same box, or make an environment for each".format(*sides)
            )

    def check(self, layout: ThingsLayout) -> None:
        """Raise InputError if an instance has more things than there is room for."""
        self.check_box(layout)
        for kind, count in layout.counts.items():
            if count > self.most[kind]:
                raise InputError(
                    f"the number of {kind} in this instance is {count}, and the arrays have room "
                    f"for {self.most[kind]}; make the environment with sizes={{{kind!r}: {count}}}"
                )

    def shapes(self) -> Mapping[str, ArrayShape]:
        """Return shape, type, least and greatest value of each array of an observation."""
        own = self.own_shapes()
        if not self.nested[0]:
            return own
        rows = self.nested[0]
        below: dict[str, ArrayShape] = {
            _BELOW + name: ((rows, *shape), kind, low, high)
            for name, (shape, kind, low, high) in own.items()
            if name not in _OF_OBSERVER
        }
        most = max(self.most["agents"] - 1, 1)
        return {**own, "beliefs": (self.nested, np.int32, -1, most), **below}

    def own_shapes(self) -> Mapping[str, ArrayShape]:
        """Return shape, type, least and greatest value of each array of one belief."""
        # Few learners take an array without elements, so that it gets one row of nothing.
        agents, items, containers = (
            max(1, self.most[kind]) for kind in ("agents", "items", "containers")
        )
        most = float(np.iinfo(np.int32).max)
        shapes: dict[str, ArrayShape] = {
            "tick": ((1,), np.int32, 0, most),
            "me": ((1,), np.int32, 0, max(agents - 1, 1)),
            "agents": ((agents, 5), np.float32, -_FARTHEST, _FARTHEST),
            "agents_known": ((agents, 2), np.int8, 0, 1),
            "agents_seen": ((agents,), np.int32, -1, most),
            "inventories": ((agents, items), np.int32, 0, most),
            "inventories_complete": ((agents,), np.int8, 0, 1),
            "containers": ((containers, items), np.int32, 0, most),
            "containers_known": ((containers, 3), np.int8, 0, 1),
            "containers_seen": ((containers,), np.int32, -1, most),
            "blocks": (self.box.shape, np.int8, -1, len(BLOCK_CLASSES) - 1),
            "heard": ((agents, len(self.phrases) + 1), np.int32, 0, most),
        }
        for name in _MOVED:
            if self.most[name]:
                shapes[name] = ((self.most[name],), np.int8, -1, 1)
        if self.most["signs"]:
            shapes["signs"] = ((self.most["signs"],), np.int32, -1, len(self.phrases) + 1)
        return shapes

    def arrays(
        self, order: KnownOrder, state: State, lines: Sequence[tuple[int, str, str]] = ()
    ) -> Arrays:
        """Return a belief as arrays; docs/pettingzoo.md describes each.

        Args:
            order: Numbers of the things in the belief.
            state: The belief.
            lines: Utterances heard since the previous observation: tick, speaker, text.

        Raises:
            InputError: There is no room for a thing that has come to be known.
        """
        self._check_room(order.things)
        arrays = _blank(self.own_shapes())
        arrays["tick"][...] = state.tick
        arrays["me"][...] = order.number("agents", state.owner) or 0
        _tell_agents(arrays, order, state)
        _tell_containers(arrays, order, state)
        for first, states in state.blocks.terrain.slabs():
            arrays["blocks"][first : first + len(states)] = block_classes()[states]
        things = order.things
        for name in arrays.keys() & _MOVED:
            for row, place in enumerate(getattr(things, name)):
                arrays[name][row] = moved_state(state.blocks.terrain[state.box.index(place)])
        if "signs" in arrays:
            for row, place in enumerate(things.signs):
                arrays["signs"][row] = self._written(state.signs.get(place))
        for _, speaker, text in lines:
            column = self.phrases.index(text) if text in self.phrases else len(self.phrases)
            arrays["heard"][order.number("agents", speaker), column] += 1
        return arrays

    def with_nested(
        self, own: Arrays, order: KnownOrder, beliefs: Mapping[BeliefPath, Arrays]
    ) -> Arrays:
        """Return an observation: an agent's belief, and its beliefs about beliefs by row.

        A row without a belief is as one about which nothing is known.
        """
        if not self.nested[0]:
            return own
        arrays = {**_blank(self.shapes()), **own}
        for path, row in order.rows(beliefs).items():
            numbers = [order.number("agents", name) for name in path[1:]]
            arrays["beliefs"][row, : len(numbers)] = numbers
            for name, array in beliefs[path].items():
                if name not in _OF_OBSERVER:
                    arrays[_BELOW + name][row] = array
        return arrays

    def _check_room(self, things: Things) -> None:
        for kind, count in things.counts.items():
            if count > self.most[kind]:
                latest = getattr(things, kind)[self.most[kind]]
                named = "; for items name it in `items`" if kind == "items" else ""
                raise InputError(
                    f"{latest!r} is new, and the arrays have room for {self.most[kind]} {kind}: "
                    f"make the environment with sizes={{{kind!r}: {count}}}{named}"
                )

    def _written(self, text: str | None) -> int:
        """Return the code of a sign's text.

        -1: unknown; 0: no text; 1 to n: the phrases; n + 1: another text.
        """
        if not text:
            return -1 if text is None else 0
        is_phrase = text in self.phrases
        return 1 + (self.phrases.index(text) if is_phrase else len(self.phrases))


def _blank(shapes: Mapping[str, ArrayShape]) -> Arrays:
    """Return arrays of nothing known: -1 where that means unknown, 0 elsewhere."""
    return {
        name: np.full(shape, -1 if low == -1 else 0, dtype)
        for name, (shape, dtype, low, _) in shapes.items()
    }


def _tell_agents(arrays: Arrays, order: KnownOrder, state: State) -> None:
    for row, name in enumerate(order.things.agents):
        agent = state.agents[name]
        if agent.position is not None:
            arrays["agents"][row] = (*agent.position, agent.yaw, agent.pitch)
            arrays["agents_known"][row] = (1, agent.current)
        if agent.basis is not None:
            arrays["agents_seen"][row] = agent.basis.observed_at
        arrays["inventories_complete"][row] = agent.inventory_complete
        _count(arrays["inventories"][row], order, agent.inventory)


def _tell_containers(arrays: Arrays, order: KnownOrder, state: State) -> None:
    beliefs = state.containers
    for row, place in enumerate(order.things.containers):
        content = beliefs.get(place)
        if content is not None:
            arrays["containers_known"][row] = (1, content.complete, content.current)
            arrays["containers_seen"][row] = content.basis.observed_at
            _count(arrays["containers"][row], order, content.items)


def _count(row: npt.NDArray[Any], order: KnownOrder, items: Mapping[str, int]) -> None:
    for name, count in items.items():
        row[order.number("items", name)] = count
