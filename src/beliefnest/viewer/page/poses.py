"""Where agents stood in the world of a timeline, and what they held, tick by tick."""

from bisect import bisect_right
from dataclasses import dataclass, field

__all__ = ["Pose", "PoseBook", "Stand"]

Pose = tuple[float, float, float, float, float]
"""Feet x, y, z (blocks), yaw, pitch (radians)."""


@dataclass
class Stand:
    """One agent: from which tick on it stood how; None: it was not there."""

    ticks: list[int] = field(default_factory=list)
    poses: list[Pose | None] = field(default_factory=list)


class PoseBook:
    """Poses of all agents in the world of one timeline, and before it in that of its base.

    Args:
        agents: How many agents there are.
        start: The timeline's first tick.
        base: The book of the timeline it was forked from; None: it was not.
    """

    def __init__(self, agents: int, start: int, base: "PoseBook | None") -> None:
        self.stands = [Stand() for _ in range(agents)]
        self._start, self._base = start, base

    def add(self, agent: int, tick: int, pose: Pose | None) -> None:
        """Note how an agent stands from a tick on."""
        stand = self.stands[agent]
        if stand.ticks and stand.ticks[-1] == tick:
            stand.poses[-1] = pose
        elif not stand.poses or stand.poses[-1] != pose:
            stand.ticks.append(tick)
            stand.poses.append(pose)

    def at(self, agent: int, tick: int) -> Pose | None:
        """How an agent stood at a tick; None: not there, or not known here."""
        if tick < self._start and self._base is not None:
            return self._base.at(agent, tick)
        stand = self.stands[agent]
        number = bisect_right(stand.ticks, tick) - 1
        return stand.poses[number] if number >= 0 else None
