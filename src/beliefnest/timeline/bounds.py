"""Bounds of what a run file may say: its box, its agents, and the blocks and items of the game.

A run file may come from a stranger. Compiled kernels trust every number that they read, so each
value is checked once, where bytes become values. Nothing after that checks it again.
"""

from collections.abc import Mapping

import msgspec

from beliefnest.errors import BeliefNestError, StoreError
from beliefnest.timeline.events import event_from
from beliefnest.timeline.journal import Entry
from beliefnest.world.claims import claims_of
from beliefnest.world.event_kinds import AT_CONTAINERS
from beliefnest.world.frames import Frame
from beliefnest.world.limits import (
    agent_fault,
    block_fault,
    dropped_fault,
    held_fault,
    point_fault,
    tick_fault,
)
from beliefnest.world.paths import BeliefPath, path_text
from beliefnest.world.registry import Registry
from beliefnest.world.texts import quoted
from beliefnest.world.values import AgentState, Box, Event, Position


class RunBounds(msgspec.Struct, frozen=True):
    """Box, agents and game to which all entries of a run belong.

    Attributes:
        box: The box of the scenario.
        agents: Names of all agents.
        registry: Blocks and items of the game.
    """

    box: Box
    agents: frozenset[str]
    registry: Registry

    def check(self, entry: Entry) -> None:
        """Raise StoreError if a value of an entry is out of bounds."""
        fault = tick_fault(entry.tick)
        if isinstance(entry, Frame):
            # Hot path: most frames have poses alone.
            if entry.agents:
                self.check_agents(entry.agents)
            if entry.items:
                for number, item in entry.items.items():
                    fault = fault or dropped_fault(number, item, self.registry)
        else:
            self.check_path(entry.path)
        for place, block in entry.blocks.items() if entry.blocks else ():
            fault = fault or self._place_fault(place) or block_fault(block, self.registry)
        for place, items in entry.containers.items() if entry.containers else ():
            fault = fault or self._place_fault(place) or held_fault(items or {}, self.registry)
        if fault:
            raise StoreError(f"the entry of tick {entry.tick} cannot be: {fault}")
        for event in entry.events if isinstance(entry, Frame) else ():
            self._check_event(entry.tick, event)

    def check_agents(self, agents: Mapping[str, AgentState | None]) -> None:
        """Raise StoreError if an agent is unknown, or its pose or possessions cannot be."""
        for name, agent in agents.items():
            if name not in self.agents:
                raise StoreError(f"an entry names the unknown agent {quoted(name)}")
            if agent is not None and (fault := agent_fault(agent, self.registry)):
                raise StoreError(f"an entry has agent {quoted(name)} as it cannot be: {fault}")

    def check_path(self, path: BeliefPath) -> None:
        """Raise StoreError if a path names an unknown agent, or one twice in a row."""
        for before, name in zip((None, *path), path, strict=False):
            if name not in self.agents or name == before:
                raise StoreError(
                    f"{quoted(path_text(path))} is no path of agents of this run, which are "
                    f"{quoted(', '.join(sorted(self.agents)))}"
                )

    def _place_fault(self, place: Position) -> str | None:
        if place in self.box:
            return None
        return f"{quoted(place)} lies outside the box {self.box.low} to {self.box.high}"

    def _check_event(self, tick: int, event: Event) -> None:
        try:
            detail = event_from(event.kind, event.actor, event.detail, self.agents).detail
            for claim in claims_of(event):
                claim.check(self.box, self.agents)
            if "block" in detail:
                self.registry.state_id(detail["block"])
        except BeliefNestError as error:
            raise StoreError(f"the entry of tick {tick} cannot be: {error}") from error
        place: Position | None = detail.get("position")
        fault = None
        if place is not None and event.kind in AT_CONTAINERS:
            fault = self._place_fault(place)
        elif place is not None:
            # Beliefs count the cell of a sign's text.
            fault = self._place_fault(place) if "text" in detail else point_fault(place)
        if "destination" in detail:
            fault = fault or point_fault(detail["destination"])
        if "items" in detail:
            fault = fault or held_fault(detail["items"], self.registry)
        if fault:
            raise StoreError(f"the entry of tick {tick} cannot be: {fault}")
