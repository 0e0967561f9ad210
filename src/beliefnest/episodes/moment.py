"""The beginning of a round, from which an episode can be branched."""

from typing import TYPE_CHECKING

from beliefnest.episodes.view import Policy

if TYPE_CHECKING:
    from beliefnest.episodes.episode import Episode

__all__ = ["Moment"]


class Moment:
    """The beginning of a round of an episode.

    Attributes:
        episode: The episode.
        round: The round, from 0.
    """

    def __init__(self, episode: "Episode", round: int) -> None:
        self.episode = episode
        self.round = round

    def fork(self, **policies: "str | Policy") -> "Episode":
        """The same episode from here on, on a branch of its own, with other policies.

        Args:
            policies: By agent; the others are played as before.

        Raises:
            InputError: There is a policy for nobody.
            UnknownNameError: There is no such policy.
        """
        return self.episode.forked(self.round, policies)
