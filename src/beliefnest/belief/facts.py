"""States as conditions read them: real, believed or imagined."""

from collections.abc import Callable, Iterable, Mapping
from typing import Protocol

from beliefnest.belief.grounds import AgentBelief, ContainerBelief
from beliefnest.belief.view import State
from beliefnest.world.paths import BeliefPath
from beliefnest.world.values import Items, Point, Position

__all__ = ["GoalFacts", "Look", "PlanFacts", "StateFacts", "ViewFacts", "looking_at"]


class GoalFacts(Protocol):
    """Protocol of a state that conditions read."""

    def items_in(self, place: Position) -> Items:
        """Return the items known to be in a container; empty if nothing is known."""

    def is_empty(self, place: Position) -> bool:
        """Return True if a container is known to hold nothing."""

    def items_of(self, agent: str) -> Items:
        """Return the items that an agent is known to have."""

    def feet_of(self, agent: str) -> Point | None:
        """Return the position of an agent's feet; None: unknown."""

    def block(self, place: Position) -> str | None:
        """Return the text of a block state; None: unknown."""


class PlanFacts(GoalFacts, Protocol):
    """Protocol of a state from which a planner acts."""

    def may_reach(self, agent: str, place: Position) -> bool:
        """Return True if an agent may be able to reach a block."""

    @property
    def containers(self) -> Iterable[Position]:
        """Return the positions of known containers."""

    @property
    def agents(self) -> Iterable[str]:
        """Return the agents whose places are known."""


Look = Callable[[BeliefPath], GoalFacts]
"""Function from a belief path to the state there; `()` is the caller's reality."""


class _View(Protocol):
    @property
    def containers(self) -> Mapping[Position, ContainerBelief]: ...

    @property
    def agents(self) -> Mapping[str, AgentBelief]: ...


class ViewFacts:
    """Facts of what is believed, without blocks.

    Args:
        view: Believed contents and agents.
    """

    def __init__(self, view: _View) -> None:
        self._view = view

    def items_in(self, place: Position) -> Items:
        """Return items known to be in a container."""
        known = self._view.containers.get(place)
        return {} if known is None else known.items

    def is_empty(self, place: Position) -> bool:
        """Return True if a container is known to hold nothing."""
        known = self._view.containers.get(place)
        return known is not None and known.complete and not known.items

    def items_of(self, agent: str) -> Items:
        """Return items that an agent is known to have."""
        return self._view.agents[agent].inventory

    def feet_of(self, agent: str) -> Point | None:
        """Return the position of an agent's feet; None: unknown."""
        return self._view.agents[agent].position


class StateFacts(ViewFacts):
    """Facts of a simulator's state.

    Args:
        state: The state.
    """

    def __init__(self, state: State) -> None:
        super().__init__(state)
        self._blocks = state.blocks

    def block(self, place: Position) -> str | None:
        """Return the text of a block state; None: unknown."""
        return self._blocks[place]


def looking_at(states: Mapping[BeliefPath, State]) -> Look:
    """Return a function that looks up facts in states by path."""
    return lambda path: StateFacts(states[path])
