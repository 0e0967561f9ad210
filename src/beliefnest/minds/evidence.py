"""Evidence: what an observer perceived of an agent, moment by moment."""

from dataclasses import dataclass

from beliefnest.minds.alternatives import Pose
from beliefnest.minds.surroundings import Scene
from beliefnest.world.values import Position

__all__ = ["Moment"]


@dataclass(frozen=True, eq=False)
class Moment:
    """One tick at which something changed in the observer's node, or its first one.

    Sets of alternatives are numbers, as in `stage`.

    Attributes:
        tick: The tick.
        scene: The node in all alternatives, after the tick.
        cell: Where the agent is; None: it is out of sight.
        alike: By alternative, those with the same percept of the agent from where it is; empty
            where it is out of sight.
        claims: The alternatives in which each claim is true that the agent took up.
        learnt: For each container in doubt that the agent used, by alternative those with the same
            content.
        opened: The container in doubt that the agent opened.
        act: Number of the goal that it acted on.
        deed: Whether it did something else.
        agrees: The alternatives that agree with what the node holds.
        watch: Pose of the observer; None: it is not present, or is nobody.
    """

    tick: int
    scene: Scene
    cell: Position | None
    alike: tuple[int, ...] = ()
    claims: tuple[int, ...] = ()
    learnt: tuple[tuple[int, ...], ...] = ()
    opened: Position | None = None
    act: int | None = None
    deed: bool = False
    agrees: int = -1
    watch: Pose | None = None
