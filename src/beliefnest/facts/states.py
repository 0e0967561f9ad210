"""States as facts read them: real, believed or imagined."""

from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Protocol

from beliefnest.world.paths import BeliefPath
from beliefnest.world.values import Items, Point, Position

if TYPE_CHECKING:
    from beliefnest.belief.grounds import AgentBelief, ContainerBelief
    from beliefnest.belief.view import State


class Facts(Protocol):
    """Protocol of a state that facts are about."""

    def items_in(self, place: Position) -> Items:
        """Return the items known to be in a container; empty if nothing is known."""

    def is_complete(self, place: Position) -> bool:
        """Return True if the contents of a container are known completely."""

    def items_of(self, agent: str) -> Items:
        """Return the items that an agent is known to have."""

    def feet_of(self, agent: str) -> Point | None:
        """Return the position of an agent's feet; None: unknown."""

    def block(self, place: Position) -> str | None:
        """Return the text of a block state; None: unknown."""

    def sign(self, place: Position) -> str | None:
        """Return the text of a sign, empty if it is blank; None: unknown."""

    def has_heard(self, text: str) -> bool:
        """Return True if an utterance is known that contains a text."""


class PlanFacts(Facts, Protocol):
    """Protocol of a state from which a planner acts."""

    def may_reach(self, agent: str, place: Position) -> bool:
        """Return True if an agent may be able to reach a block."""

    @property
    def containers(self) -> Iterable[Position]:
        """Return the positions of known containers."""

    @property
    def agents(self) -> Iterable[str]:
        """Return the agents whose places are known."""


Look = Callable[[BeliefPath], Facts]
"""Function from a belief path to the state there; `()` is the caller's reality."""


class _View(Protocol):
    @property
    def containers(self) -> Mapping[Position, "ContainerBelief"]: ...

    @property
    def agents(self) -> Mapping[str, "AgentBelief"]: ...

    @property
    def signs(self) -> Mapping[Position, str]: ...


class ViewFacts:
    """Facts of what is believed, without blocks and utterances.

    Args:
        view: Believed contents and agents.
    """

    def __init__(self, view: _View) -> None:
        self._view = view

    def items_in(self, place: Position) -> Items:
        """Return items known to be in a container."""
        content = self._view.containers.get(place)
        return {} if content is None else content.items

    def is_complete(self, place: Position) -> bool:
        """Return True if the contents of a container are known completely."""
        content = self._view.containers.get(place)
        return content is not None and content.complete

    def items_of(self, agent: str) -> Items:
        """Return items that an agent is known to have."""
        return self._view.agents[agent].inventory

    def feet_of(self, agent: str) -> Point | None:
        """Return the position of an agent's feet; None: unknown."""
        return self._view.agents[agent].position

    def sign(self, place: Position) -> str | None:
        """Return the text of a sign; None: unknown."""
        return self._view.signs.get(place)


class StateFacts(ViewFacts):
    """Facts of a simulator's state.

    Args:
        state: The state.
    """

    def __init__(self, state: "State") -> None:
        super().__init__(state)
        self._blocks, self._state = state.blocks, state

    def block(self, place: Position) -> str | None:
        """Return the text of a block state; None: unknown."""
        return self._blocks[place]

    def has_heard(self, text: str) -> bool:
        """Return True if an utterance is known that contains a text."""
        return any(text in line for _, _, line in self._state.chat)

    def containers_with(self, items: Items) -> list[Position]:
        """Return the containers that are known to hold at least some items, sorted."""
        contents = sorted(self._state.containers.items())
        return [
            place
            for place, content in contents
            if all(content.items.get(name, 0) >= count for name, count in items.items())
        ]
