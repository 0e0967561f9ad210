"""View of one simulator: the only object that reaches templates, stories and pictures of a mind."""

from collections.abc import Callable, Mapping, Sequence

import msgspec

from beliefnest.belief.view import State
from beliefnest.prompts.observations import Observation
from beliefnest.world.paths import path_text
from beliefnest.world.values import Position


class ToldMind(msgspec.Struct, frozen=True):
    """Observations of a simulator's owner, and the names that it has for things.

    Attributes:
        observations: Observations until now, in the order of time.
        names: Names of containers, signs, doors and switches, without articles.
        labels: Labels of containers (name and appearance), if prompts may show them.
        places: Positions of named places.
        unique: Items of which everybody knows that there is one.
    """

    observations: tuple[Observation, ...]
    names: Mapping[Position, str]
    labels: Mapping[Position, str]
    places: Mapping[str, Position]
    unique: frozenset[str] = frozenset()


class MindView:
    """State of one simulator and what its owner perceived, with the views of the beliefs below.

    It has no member that leads to the world, to another simulator above, or to the record.

    Args:
        state: State of the simulator.
        told: Function that returns the observations and names; it is called once, when needed.
        below: Function that returns the view of an agent's belief in the simulator.
    """

    __slots__ = ("_below", "_told", "_told_once", "state")

    def __init__(
        self, state: State, read_mind: Callable[[], ToldMind], below: Callable[[str], "MindView"]
    ) -> None:
        self.state = state
        self._told, self._below = read_mind, below
        self._told_once: ToldMind | None = None

    def __repr__(self) -> str:
        return f"<view of {self.path} at tick {self.tick}>"

    @property
    def path(self) -> str:
        """The belief path as text."""
        return path_text(self.state.path)

    @property
    def owner(self) -> str | None:
        """The agent whose belief this is; None in the real world."""
        return self.state.owner

    @property
    def tick(self) -> int:
        """The tick of the state."""
        return self.state.tick

    @property
    def observations(self) -> Sequence[Observation]:
        """The observations of the owner, in the order of time; in the real world, all."""
        return self._read.observations

    @property
    def names(self) -> Mapping[Position, str]:
        """The names that the owner has for containers, signs, doors and switches."""
        return self._read.names

    @property
    def labels(self) -> Mapping[Position, str]:
        """The labels of containers that the owner knows, if prompts may show them."""
        return self._read.labels

    @property
    def places(self) -> Mapping[str, Position]:
        """The positions of the named places that the owner knows, by name."""
        return self._read.places

    @property
    def unique(self) -> frozenset[str]:
        """The items of which everybody knows that there is one."""
        return self._read.unique

    def child(self, agent: str) -> "MindView":
        """Return the view of an agent's belief; for the owner, this view itself."""
        return self if agent == self.owner else self._below(agent)

    @property
    def _read(self) -> ToldMind:
        if self._told_once is None:
            self._told_once = self._told()
        return self._told_once
