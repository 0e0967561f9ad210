"""Evidence: what an observer perceived of an agent, moment by moment."""

import msgspec

from beliefnest.minds.alternatives import AgentPose
from beliefnest.minds.surroundings import Surroundings
from beliefnest.world.values import Position


class EvidenceMoment(msgspec.Struct, frozen=True, eq=False):
    """One tick at which something changed in the observer's node, or its first one.

    Sets of alternatives are numbers, as in `stage`.

    Attributes:
        tick: The tick.
        scene: The node in all alternatives, after the tick.
        cell: Cell of the agent; None: it is out of sight.
        alike: For each alternative, the set of alternatives that give the agent the same percept
            from its place; empty if it is out of sight.
        claims: For each claim that the agent took up, the alternatives in which it is true.
        learnt: For each doubted container that the agent used, and for each alternative, the set
            of alternatives with the same contents.
        opened: The doubted container that the agent opened; None: none.
        act: Number of the goal that it acted on.
        deed: True if it did something else.
        agrees: The alternatives that agree with the node.
        watch: Pose of the observer; None: it is not present, or the node is reality.
    """

    tick: int
    scene: Surroundings
    cell: Position | None
    alike: tuple[int, ...] = ()
    claims: tuple[int, ...] = ()
    learnt: tuple[tuple[int, ...], ...] = ()
    opened: Position | None = None
    act: int | None = None
    deed: bool = False
    agrees: int = -1
    watch: AgentPose | None = None
