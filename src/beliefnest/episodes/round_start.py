"""Beginning of a round, from which an episode can be branched."""

from collections.abc import Mapping
from typing import Generic, Protocol, Self, TypeVar

from beliefnest.episodes.agent_view import Policy


class Branchable(Protocol):
    """Protocol of an episode that can be branched."""

    def forked(self, round: int, policies: Mapping[str, "str | Policy"]) -> Self:
        """Return a branch of the episode, see `RoundStart.fork`."""
        ...


Played = TypeVar("Played", bound=Branchable)


class RoundStart(Generic[Played]):
    """Beginning of a round of an episode.

    Attributes:
        episode: The episode.
        round: Number of the round, from 0.
    """

    def __init__(self, episode: Played, round: int) -> None:
        self.episode = episode
        self.round = round

    def fork(self, **policies: "str | Policy") -> Played:
        """Return the episode from here on, on a new branch with other policies.

        Args:
            policies: New policies by agent; other agents keep their policies.

        Raises:
            InputError: A policy is for an unknown agent.
            UnknownNameError: A policy does not exist.
        """
        return self.episode.forked(self.round, policies)
