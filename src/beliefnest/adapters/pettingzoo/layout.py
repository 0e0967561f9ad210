"""Layout of the arrays of observations and actions: the order of everything in a scenario."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from beliefnest.belief.view import State
from beliefnest.errors import InputError, UnknownNameError
from beliefnest.nest.past.setting import Setting
from beliefnest.world.claims import Claim
from beliefnest.world.doors import is_door, is_switch
from beliefnest.world.registry import Registry, parse_state
from beliefnest.world.signs import is_sign
from beliefnest.world.values import Box, Position

__all__ = ["Arrays", "ObservationLayout", "Phrases"]

Arrays = dict[str, npt.NDArray[Any]]
"""An observation or a belief as arrays by name."""

Phrases = Mapping[str, Sequence[Claim]]
"""Utterances that agents can choose, with the claims of each."""


@dataclass(frozen=True)
class ObservationLayout:
    """Fixed order of the things that arrays describe.

    Attributes:
        box: Region of the scenario; `blocks` has its shape.
        agents: Names, sorted.
        items: Names of items, sorted.
        containers: Positions, in order.
        doors: Positions of doors (lower half), trapdoors and gates, in order.
        levers: Positions of levers, in order.
        buttons: Positions of buttons, in order.
        signs: Positions of signs, in order.
        phrases: Texts that can be said and written on signs.
    """

    box: Box
    agents: tuple[str, ...]
    items: tuple[str, ...]
    containers: tuple[Position, ...]
    doors: tuple[Position, ...]
    levers: tuple[Position, ...]
    buttons: tuple[Position, ...]
    signs: tuple[Position, ...]
    phrases: tuple[str, ...]

    @classmethod
    def of(
        cls, setting: Setting, phrases: Phrases, items: Sequence[str] = ()
    ) -> "ObservationLayout":
        """Return the layout for the start of a scenario.

        Args:
            setting: Setting of the scenario.
            phrases: Utterances with their claims.
            items: Names of further items, which no agent or container has at the start.

        Raises:
            UnknownNameError: There is no such item.
            InputError: A claim is about a place outside the box or about an unknown agent.
        """
        snapshot = setting.snapshot
        registry = Registry.load()
        for name in items:
            registry.item_stack(name)
        agents = tuple(sorted(snapshot.agents.keys() | setting.absent))
        for claims in phrases.values():
            for claim in claims:
                claim.check(snapshot.box, agents)
        held = [agent.inventory for agent in snapshot.agents.values()]
        held += list(snapshot.containers.values())
        worn = {name for agent in snapshot.agents.values() for name in agent.equipment.values()}
        return cls(
            box=snapshot.box,
            agents=agents,
            items=tuple(sorted({*items, *worn, *(name for each in held for name in each)})),
            containers=tuple(sorted(snapshot.containers)),
            doors=tuple(_doors(setting, registry)),
            levers=tuple(_blocks(setting, lambda name: name == "lever")),
            buttons=tuple(_blocks(setting, lambda name: is_switch(name) and name != "lever")),
            signs=tuple(_blocks(setting, is_sign)),
            phrases=tuple(phrases),
        )

    def number(self, kind: str, value: object) -> int:
        """Return the index of a thing in its order.

        Args:
            kind: `agents`, `items`, `containers`, `doors`, `levers`, `buttons`, `signs` or
                `phrases`.
            value: The thing.

        Raises:
            UnknownNameError: There is no such thing.
        """
        known = getattr(self, kind)
        if value not in known:
            there = ", ".join(map(str, known)) or "none"
            raise UnknownNameError(
                f"{value!r} is not among the {kind} of the environment, which are {there}"
            )
        return int(known.index(value))

    def shapes(self) -> dict[str, tuple[tuple[int, ...], type[np.generic], float, float]]:
        """Return shape, type, least and greatest value of each array by name."""
        agents, items, containers = len(self.agents), len(self.items), len(self.containers)
        most = float(np.iinfo(np.int32).max)
        shapes: dict[str, tuple[tuple[int, ...], type[np.generic], float, float]] = {
            "tick": ((), np.int32, 0, most),
            "me": ((), np.int32, 0, max(agents - 1, 0)),
            "agents": ((agents, 5), np.float32, -np.inf, np.inf),
            "agents_known": ((agents, 2), np.int8, 0, 1),
            "agents_seen": ((agents,), np.int32, -1, most),
            "inventories": ((agents, items), np.int32, 0, most),
            "inventories_complete": ((agents,), np.int8, 0, 1),
            "containers": ((containers, items), np.int32, 0, most),
            "containers_known": ((containers, 3), np.int8, 0, 1),
            "containers_seen": ((containers,), np.int32, -1, most),
            "blocks": (self.box.shape, np.int32, -1, most),
            "heard": ((agents, len(self.phrases) + 1), np.int32, 0, most),
        }
        for name in ("levers", "buttons"):
            if places := getattr(self, name):
                shapes[name] = ((len(places),), np.int8, -1, 1)
        if self.signs:
            shapes["signs"] = ((len(self.signs),), np.int32, -1, len(self.phrases) + 1)
        return shapes

    def arrays(self, state: State, lines: Sequence[tuple[int, str, str]] = ()) -> Arrays:
        """Return a belief as arrays; docs/pettingzoo.md describes each.

        Args:
            state: The belief.
            lines: Utterances heard since the previous observation: tick, speaker, text.
        """
        found: Arrays = {
            name: np.zeros(shape, dtype) for name, (shape, dtype, _, _) in self.shapes().items()
        }
        found["tick"][...] = state.tick
        found["me"][...] = 0 if state.owner is None else self.agents.index(state.owner)
        self._tell_agents(found, state)
        self._tell_containers(found, state)
        for first, states in state.blocks.terrain.slabs():
            found["blocks"][first : first + len(states)] = states
        for name in ("levers", "buttons"):
            for row, place in enumerate(getattr(self, name)):
                found[name][row] = _power(state, place)
        for row, place in enumerate(self.signs):
            found["signs"][row] = self._written(state.signs.get(place))
        for _, speaker, text in lines:
            column = self.phrases.index(text) if text in self.phrases else len(self.phrases)
            found["heard"][self.agents.index(speaker), column] += 1
        return found

    def _tell_agents(self, found: Arrays, state: State) -> None:
        beliefs = state.agents
        found["agents_seen"][:] = -1
        for row, name in enumerate(self.agents):
            agent = beliefs[name]
            if agent.position is not None:
                found["agents"][row] = (*agent.position, agent.yaw, agent.pitch)
                found["agents_known"][row] = (1, agent.current)
            if agent.basis is not None:
                found["agents_seen"][row] = agent.basis.observed_at
            found["inventories_complete"][row] = agent.inventory_complete
            self._count(found["inventories"][row], agent.inventory)

    def _tell_containers(self, found: Arrays, state: State) -> None:
        beliefs = state.containers
        found["containers_seen"][:] = -1
        for row, place in enumerate(self.containers):
            known = beliefs.get(place)
            if known is not None:
                found["containers_known"][row] = (1, known.complete, known.current)
                found["containers_seen"][row] = known.basis.observed_at
                self._count(found["containers"][row], known.items)

    def _written(self, text: str | None) -> int:
        """Return the code of a sign's text.

        -1: unknown; 0: no text; 1 to n: the phrases; n + 1: another text.
        """
        if not text:
            return -1 if text is None else 0
        known = text in self.phrases
        return 1 + (self.phrases.index(text) if known else len(self.phrases))

    def _count(self, row: npt.NDArray[Any], items: Mapping[str, int]) -> None:
        for name, count in items.items():
            if name not in self.items:
                raise InputError(
                    f"item {name!r} is new: no agent or container had it at the start; name it "
                    "in `items` of the environment"
                )
            row[self.items.index(name)] = count


def _doors(setting: Setting, registry: Registry) -> list[Position]:
    snapshot = setting.snapshot
    states = [s for s in snapshot.blocks.states if is_door(registry.name(s))]
    # Leave upper halves of doors out: they move together with the lower ones.
    lower = [s for s in states if registry.properties(s).get("half") != "upper"]
    return _places(setting, lower)


def _blocks(setting: Setting, wanted: Callable[[str], bool]) -> list[Position]:
    """Return the positions of blocks with wanted names, in order."""
    registry, states = Registry.load(), setting.snapshot.blocks.states
    return _places(setting, [s for s in states if s >= 0 and wanted(registry.name(s))])


def _power(state: State, place: Position) -> int:
    """Return 1 for a switch that is believed to be on, 0 for off; -1: unknown or no switch."""
    text = state.blocks[place]
    powered = None if text is None else parse_state(text)[1].get("powered")
    return -1 if powered is None else int(powered == "true")


def _places(setting: Setting, states: Sequence[int]) -> list[Position]:
    """Return the positions of blocks with one of some states, in order."""
    return setting.snapshot.places(states)
