"""Beginnings of imagined histories, by the alternatives that were drawn."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import msgspec
from msgspec.structs import replace

from beliefnest.minds.imagining.courses import Candidate, Course
from beliefnest.minds.walking import Strategy
from beliefnest.nest.past.recording import Recording
from beliefnest.timeline.journal import Edit, ForkPoint
from beliefnest.world.double_chests import container_at, holds_items, states_in
from beliefnest.world.frames import Frame, Snapshot
from beliefnest.world.paths import BeliefPath
from beliefnest.world.registry import Registry
from beliefnest.world.signs import plain_state
from beliefnest.world.values import AgentState, Block, Items, Position


class Doubt(msgspec.Struct, frozen=True, eq=False):
    """A doubt that one or several models share."""

    elements: frozenset[tuple[str, object]]
    strategy: Strategy


@dataclass(eq=False)
class HistoryStarts:
    """Beginnings of histories, by the alternatives drawn."""

    recording: Recording
    path: BeliefPath
    base: ForkPoint
    snapshot: Snapshot
    filled: Mapping[Position, Block]
    candidates: Mapping[str, Mapping[str, Candidate]]
    doubts: list[Doubt] = field(default_factory=list)

    def of(self, drawn: tuple[int, ...]) -> Snapshot:
        """Return the beginning with the alternatives that were drawn."""
        blocks, contents, agents = self._edits(drawn)
        registry, snapshot = Registry.load(), self.snapshot
        if not (blocks or contents or agents):
            return snapshot
        grid = snapshot.blocks.draft()
        contents_now = {place: dict(items) for place, items in snapshot.containers.items()}
        for place, block in blocks.items():
            state = max(0, plain_state(block))
            grid[snapshot.box.index(place)] = state
            if holds_items(registry, state):
                contents_now.setdefault(place, {})
            else:
                contents_now.pop(place, None)
        chest = registry.state_id("chest")
        state_at = states_in(snapshot.box, grid.terrain(), registry.air)
        for named_place, items in contents.items():
            place = container_at(registry, state_at, named_place)
            index = snapshot.box.index(place)
            if not holds_items(registry, grid[index]):
                grid[index] = chest
            contents_now[place] = dict(items)
        states = {**snapshot.agents, **agents}
        return replace(snapshot, blocks=grid.terrain(), containers=contents_now, agents=states)

    def entries(self, course: Course) -> list[Edit | Frame]:
        """Return what is recorded of a course."""
        blocks, contents, agents = self._edits(course.drawn)
        tick = self.base.tick
        entries: list[Edit | Frame] = []
        if agents:
            entries.append(Frame(tick, agents=agents))
        if blocks or contents:
            entries.append(Edit(tick, self.path, blocks, contents))
        return [*entries, *course.entries]

    def _edits(
        self, drawn: tuple[int, ...]
    ) -> tuple[dict[Position, Block], dict[Position, Items], dict[str, AgentState]]:
        registry = Registry.load()
        blocks: dict[Position, Block] = dict(self.filled)
        contents: dict[Position, Items] = {}
        agents: dict[str, AgentState] = {}
        for doubt, number in zip(self.doubts, drawn, strict=True):
            chosen = doubt.strategy.model.alternatives[number]
            blocks |= {place: registry.state_id(text) for place, text in chosen.blocks.items()}
            contents |= {place: dict(items) for place, items in chosen.containers.items()}
            for name, feet in chosen.agents.items():
                state = self.snapshot.agents.get(name)
                agents[name] = AgentState(feet) if state is None else replace(state, position=feet)
        return blocks, contents, agents
