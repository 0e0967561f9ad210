"""Poses of agents in the world of a timeline, tick by tick."""

from bisect import bisect_right
from dataclasses import dataclass, field

PoseRow = tuple[float, float, float, float, float]
"""Feet x, y, z (blocks), yaw, pitch (radians)."""


@dataclass
class Stand:
    """Poses of one agent: each with its first tick; None while the agent was absent."""

    ticks: list[int] = field(default_factory=list)
    poses: list[PoseRow | None] = field(default_factory=list)


class PoseBook:
    """Poses of all agents in the world of one timeline; before its start, in that of its base.

    Args:
        agents: Number of agents.
        start: First tick of the timeline.
        base: Poses of the timeline from which it was forked; None if it was not.
    """

    def __init__(self, agents: int, start: int, base: "PoseBook | None") -> None:
        self.stands = [Stand() for _ in range(agents)]
        self._start, self._base = start, base

    def add(self, agent: int, tick: int, pose: PoseRow | None) -> None:
        """Add the pose of an agent from a tick on."""
        stand = self.stands[agent]
        if stand.ticks and stand.ticks[-1] == tick:
            stand.poses[-1] = pose
        elif not stand.poses or stand.poses[-1] != pose:
            stand.ticks.append(tick)
            stand.poses.append(pose)

    def at(self, agent: int, tick: int) -> PoseRow | None:
        """Return the pose of an agent at a tick; None if it was absent or is not known here."""
        if tick < self._start and self._base is not None:
            return self._base.at(agent, tick)
        stand = self.stands[agent]
        number = bisect_right(stand.ticks, tick) - 1
        return stand.poses[number] if number >= 0 else None
