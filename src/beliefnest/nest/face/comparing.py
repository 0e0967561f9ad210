"""Simulators beside each other: live, past, or recorded."""

from beliefnest.nest.explain.comparison import Difference, compare, false_beliefs
from beliefnest.nest.face.moment import AtMoment
from beliefnest.nest.face.turns import in_turn
from beliefnest.world.paths import parse_path

__all__ = ["Comparing"]


class Comparing(AtMoment):
    """Where simulators of a nest differ."""

    @in_turn
    def compare(self, a: str, b: str, *, unknown: bool = True) -> list[Difference]:
        """Where two simulators differ: blocks, containers, agents' poses, inventories.

        Args:
            a: Belief path of one.
            b: Belief path of the other.
            unknown: Whether to tell of what is unknown, or not there, in one of them.

        Raises:
            PathError: A path is malformed or names an unknown agent.
            TickError: The tick that is looked at is in the future or before the start.
        """
        recording = self._recording
        one, other = parse_path(a, recording.agents), parse_path(b, recording.agents)
        return compare(recording, one, other, self._moment(), unknown=unknown)

    @in_turn
    def false_beliefs(self, path: str) -> list[Difference]:
        """What a simulator holds otherwise than reality (`a`) does; unknown is not false.

        Contents are false if they claim items that are not there, or claim to be complete
        and miss some; an agent's place from half a block on, wherever its head has turned to.

        Raises:
            PathError: The path is malformed or names an unknown agent.
            TickError: The tick that is looked at is in the future or before the start.
        """
        names = parse_path(path, self._recording.agents)
        return false_beliefs(self._recording, names, self._moment())
