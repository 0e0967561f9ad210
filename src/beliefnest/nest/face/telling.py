"""What was claimed in a nest: live, past, or recorded."""

from beliefnest.nest.explain.told import ToldClaim, claims_told
from beliefnest.nest.face.moment import AtMoment
from beliefnest.world.paths import parse_path

__all__ = ["Telling"]


class Telling(AtMoment):
    """The claims that were made in a nest."""

    def claims(self, path: str = "/") -> list[ToldClaim]:
        """Every claim that was made in a simulator, oldest first.

        Each tells its tick, text, speaker, hearers, whether it was false and whether a lie, and
        of any belief whether it was taken up there, and why.

        Args:
            path: The simulator; what is claimed in a simulator in control mode is told there.

        Raises:
            PathError: The path is malformed or names an unknown agent.
        """
        with self._recording.turn:
            names = parse_path(path, self._recording.agents)
            return claims_told(self._recording, names, self._moment())
