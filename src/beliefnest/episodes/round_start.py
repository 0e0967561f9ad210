"""The beginning of a round, from which an episode can be branched."""

from collections.abc import Mapping
from typing import Generic, Protocol, Self, TypeVar

from beliefnest.episodes.view import Policy

__all__ = ["RoundStart"]


class Branchable(Protocol):
    """What a moment needs of its episode."""

    def forked(self, round: int, policies: Mapping[str, "str | Policy"]) -> Self:
        """See `RoundStart.fork`."""
        ...


Played = TypeVar("Played", bound=Branchable)


class RoundStart(Generic[Played]):
    """The beginning of a round of an episode.

    Attributes:
        episode: The episode.
        round: The round, from 0.
    """

    def __init__(self, episode: Played, round: int) -> None:
        self.episode = episode
        self.round = round

    def fork(self, **policies: "str | Policy") -> Played:
        """Return the same episode from here on, on a branch of its own, with other policies.

        Args:
            policies: By agent; the others are played as before.

        Raises:
            InputError: There is a policy for nobody.
            UnknownNameError: There is no such policy.
        """
        return self.episode.forked(self.round, policies)
