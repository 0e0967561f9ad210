"""The state of one simulator: `s^Z` of the paper (semantics, sections 1 and 2)."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from beliefnest.belief.entries import AgentBelief, Basis, ContainerBelief, PerceivedEvent, Source
from beliefnest.perception.observe import Pose, Scene
from beliefnest.perception.terrain import Terrain
from beliefnest.world.values import DroppedItem, Event, Position

__all__ = ["SOURCES", "BeliefState", "Grounds", "ItemBelief", "Log"]

SOURCES = tuple(Source)
"""Source of each code in `Grounds.sources`."""


@dataclass(frozen=True, slots=True)
class ItemBelief:
    """What is believed of a dropped item."""

    item: DroppedItem
    basis: Basis
    current: bool


@dataclass(frozen=True, slots=True, eq=False)
class Grounds:
    """What each block of a terrain rests on; arrays of the box's shape, read-only.

    Attributes:
        observed_at: int32, tick of the perception; -1 where the block is unknown.
        sources: uint8, index into `SOURCES`.
        current: bool, whether a perception in this tick backs the block.
    """

    observed_at: npt.NDArray[np.int32]
    sources: npt.NDArray[np.uint8]
    current: npt.NDArray[np.bool_]

    def basis(self, index: tuple[int, int, int]) -> Basis | None:
        """Basis of the block at an array index; None where it is unknown."""
        tick = int(self.observed_at[index])
        return None if tick < 0 else Basis(tick, SOURCES[self.sources[index]])


@dataclass(frozen=True, slots=True)
class Log:
    """Perceived events, newest first, sharing their past with other logs.

    Attributes:
        before: The log without its newest event; None: this is the first.
        newest: The newest event.
    """

    before: "Log | None"
    newest: PerceivedEvent

    def __iter__(self) -> Iterator[PerceivedEvent]:
        """Events, newest first."""
        log: Log | None = self
        while log is not None:
            yield log.newest
            log = log.before


@dataclass(frozen=True, slots=True, eq=False)
class BeliefState:
    """One simulator at one tick; never changed after it was made.

    Attributes:
        tick: The tick it is the state of.
        terrain: Blocks, unknown ones included.
        grounds: What each block rests on.
        containers: Known containers.
        agents: All agents of the scenario.
        items: Known dropped items.
        log: Events perceived so far; None: none.
        news: The events perceived in this tick.
    """

    tick: int
    terrain: Terrain
    grounds: Grounds
    containers: Mapping[Position, ContainerBelief]
    agents: Mapping[str, AgentBelief]
    items: Mapping[int, ItemBelief]
    log: Log | None
    news: tuple[Event, ...]

    def scene(self) -> Scene:
        """What agents in this simulator can perceive of it in this tick."""
        poses = {
            name: Pose(agent.position, agent.yaw, agent.pitch)
            for name, agent in self.agents.items()
            if agent.position is not None
        }
        present = frozenset(name for name in poses if self.agents[name].current)
        items = {number: belief.item for number, belief in self.items.items()}
        return Scene(self.terrain, poses, present, items, self.news)

    def events(self) -> tuple[PerceivedEvent, ...]:
        """All perceived events, oldest first."""
        return tuple(reversed(tuple(self.log or ())))
