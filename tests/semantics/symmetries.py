"""Stories and states renamed, mirrored and turned, as plain values."""

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass, fields, is_dataclass
from math import cos, pi, sin
from typing import Any

import msgspec
from msgspec import structs
from msgspec.structs import replace
from tests.semantics.stories import HIGH, Act, Story

from beliefnest.belief.grounds import AgentBelief

WIDTH = HIGH[0] + 1
"""The box is as deep as it is wide."""


@dataclass(frozen=True)
class Symmetry:
    """A change that everything in the world undergoes alike.

    Attributes:
        name: What it is, for the test's name.
        across: New x and z of a point.
        turned: New yaw.
        names: New names of agents.
    """

    name: str
    across: Callable[[float, float], tuple[float, float]] = lambda x, z: (x, z)
    turned: Callable[[float], float] = lambda yaw: yaw
    names: tuple[tuple[str, str], ...] = ()

    def story(self, story: Story) -> Story:
        """Return the changed story."""
        changed = self.value(replace(story, acts=()))
        yaws = {self.value(name): self.turned(yaw) for name, yaw in story.yaws.items()}
        return replace(changed, acts=tuple(self.act(act) for act in story.acts), yaws=yaws)

    def act(self, act: Act) -> Act:
        """Return the changed act; the last argument of `place_agent` is a yaw."""
        name, *args = act
        if name == "tick":
            return (name, *(self.act(inner) for inner in args))
        if name == "in":
            return (name, self.path(args[0]), self.act(args[1]))
        if name == "place_agent":
            who, feet, yaw = args
            return (name, self.value(who), self.value(feet), self.turned(yaw))
        if name in ("edit", "switch"):
            return (name, self.path(args[0]), *self.value(tuple(args[1:])))
        return (name, *self.value(tuple(args)))

    def path(self, path: str) -> str:
        """Return the changed path."""
        return "/".join(self.value(name) for name in path.split("/"))

    def value(self, value: Any) -> Any:
        """Any value, with the positions, points and names in it changed."""
        if isinstance(value, str):
            return dict(self.names).get(value, value)
        if isinstance(value, dict):
            return {self.value(key): self.value(inner) for key, inner in value.items()}
        if isinstance(value, tuple):
            return self._point(value) if _is_point(value) else tuple(map(self.value, value))
        if isinstance(value, AgentBelief) and value.position is not None:
            value = replace(value, yaw=self.turned(value.yaw))
        if isinstance(value, msgspec.Struct):
            inner = {name: self.value(part) for name, part in structs.asdict(value).items()}
            return replace(value, **inner)
        if is_dataclass(value) and not isinstance(value, type):
            inner = {part.name: self.value(getattr(value, part.name)) for part in fields(value)}
            return dataclasses.replace(value, **inner)
        return value

    def _point(self, point: tuple[Any, ...]) -> tuple[Any, ...]:
        """Return the changed point; a block's lower corner is changed by its middle."""
        x, y, z = point
        if all(isinstance(coordinate, int) for coordinate in point):
            u, w = self.across(x + 0.5, z + 0.5)
            return (int(u - 0.5), y, int(w - 0.5))
        u, w = self.across(x, z)
        return (u, y, w)


def _is_point(value: tuple[Any, ...]) -> bool:
    return len(value) == 3 and all(type(part) in (int, float) for part in value)


def with_directions(everything: dict[str, Any]) -> dict[str, Any]:
    """Return a state's `everything` with angles as directions, which compare after a turn."""

    def direction(agent: AgentBelief) -> Any:
        if agent.position is None:
            return agent
        heading = (round(sin(agent.yaw), 9) + 0.0, round(cos(agent.yaw), 9) + 0.0)
        return (replace(agent, yaw=0.0), heading)

    agents = {name: direction(agent) for name, agent in everything["agents"].items()}
    return everything | {"agents": agents}


SYMMETRIES = [
    Symmetry("mirror x", lambda x, z: (WIDTH - x, z), lambda yaw: -yaw),
    Symmetry("mirror z", lambda x, z: (x, WIDTH - z), lambda yaw: pi - yaw),
    Symmetry("turn", lambda x, z: (WIDTH - z, x), lambda yaw: yaw - pi / 2),
    Symmetry("rename", names=(("ann", "cat"), ("bob", "ann"), ("cat", "bob"))),
]
