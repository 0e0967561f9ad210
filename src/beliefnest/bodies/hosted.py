"""The embedded world in real time, where people are agents as well; beliefs in another process."""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Self

from beliefnest.bodies.channel import Channel
from beliefnest.bodies.embedded import MINECRAFT, started
from beliefnest.bodies.limits import ProcessLimits
from beliefnest.bodies.listening import ListenAddress
from beliefnest.bodies.node_files import HOSTING
from beliefnest.bodies.realtime import RealtimeWorld
from beliefnest.errors import BodyError

__all__ = ["HostedWorld"]


class HostedWorld(RealtimeWorld):
    """A process for the real world, which people can join, and another one for all beliefs.

    Args:
        address: Where people come in.
        seed: Drives the random numbers of beliefs' bodies.
        limits: What each process may take.
    """

    def __init__(
        self, address: ListenAddress, seed: int, limits: ProcessLimits | None = None
    ) -> None:
        super().__init__(seed, limits)
        self._address = address
        self._paused = False

    @classmethod
    def start(cls, address: ListenAddress, seed: int, limits: ProcessLimits | None = None) -> Self:
        """Start the process of the real world and listen, now.

        Raises:
            BodyError: Node or the bundle is missing, or the port cannot be had.
        """
        world = cls(address, seed, limits)
        world._live()
        return world

    @property
    def address(self) -> str:
        """Where a Minecraft client joins: `HOST:PORT`."""
        return str(self._address)

    @property
    def origin(self) -> tuple[int, int]:
        """People are told the scenario's coordinates."""
        return (0, 0)

    @property
    def shows_reality(self) -> bool:
        """False: only who is an agent is in it."""
        return False

    @property
    def minecraft(self) -> str:
        """The version that it has to be."""
        return MINECRAFT

    def pause(self, *, paused: bool) -> None:
        """Let time stand still in the real world, or go on."""
        self._paused = paused
        self._live().request("pause", paused=paused)

    def hearing(self, *, everybody: bool) -> None:
        """Say whether all people hear whatever is said aloud, so that nothing has to wait."""
        self._live().post("hearing", **{"global": everybody})

    def heard(self, tick: int, agents: Sequence[Sequence[str]]) -> None:
        """Say who heard what was said aloud in a tick; people are told no more than that.

        Args:
            tick: The tick.
            agents: For each thing said in it, in order, the names of who heard it.
        """
        self._live().post("hear", tick=tick, heard=[list(names) for names in agents])

    def close(self) -> None:
        """End both processes; people are told that it is over."""
        self._closed = True
        self._beliefs.close()
        channel, self._channel = self._channel, None
        if channel is None:
            return
        # Where the process has ended already, everybody is gone.
        with suppress(BodyError):
            if not channel.lost:
                channel.request("shutdown")
        channel.close()

    def _started(self) -> Channel:
        channel, self._versions = started(
            self._seed, self._limits, HOSTING, listen=self._address.told
        )
        try:
            told = channel.request("people", invited=sorted(self._invited))
            channel.request("pause", paused=self._paused)
        except BodyError:
            channel.close()
            raise
        # Where any port would do, people come back to the one they know.
        self._address = replace(self._address, port=told["port"])
        return channel
