"""Embedded world in real time, in which people can play agents; beliefs in another process."""

from collections.abc import Sequence
from contextlib import suppress
from typing import Self

from msgspec.structs import replace

from beliefnest.errors import BodyError
from beliefnest.worlds.minecraft.channel import Channel
from beliefnest.worlds.minecraft.launching import MINECRAFT, started
from beliefnest.worlds.minecraft.node_files import HOSTING
from beliefnest.worlds.process_limits import ProcessLimits
from beliefnest.worlds.servers.listening import ListenAddress
from beliefnest.worlds.servers.realtime import RealtimeWorld


class HostedWorld(RealtimeWorld):
    """Process for the real world, which people can join, and another one for all beliefs.

    Args:
        address: Address on which people join.
        seed: Seed of the random numbers of beliefs' bodies.
        limits: Limits of each process.
    """

    # People see the scenario's coordinates, and only agents can enter reality.
    origin = (0, 0)
    shows_reality = False
    minecraft = MINECRAFT

    def __init__(
        self, address: ListenAddress, seed: int, limits: ProcessLimits | None = None
    ) -> None:
        super().__init__(seed, limits)
        self._address = address
        self._paused = False

    @classmethod
    def of(cls, name: str, seed: int, limits: ProcessLimits | None = None) -> Self:
        """Return the world of a name, such as `embedded://127.0.0.1:25565`.

        Raises:
            InputError: The name contains no valid address.
        """
        return cls(ListenAddress.parse(name), seed, limits)

    @property
    def host(self) -> Self:
        """The world itself; see `RealtimePlay`."""
        return self

    @property
    def address(self) -> str:
        """Address for Minecraft clients: `HOST:PORT`."""
        return str(self._address)

    def pause(self, *, paused: bool) -> None:
        """Stop or resume time in the real world."""
        self._paused = paused
        self._live().request("pause", paused=paused)

    def hearing(self, *, everybody: bool) -> None:
        """Set whether all people hear everything said aloud, so that lines need not wait."""
        self._live().post("hearing", **{"global": everybody})

    def heard(self, tick: int, agents: Sequence[Sequence[str]]) -> None:
        """Report the hearers of a tick's utterances; people receive only the lines they heard.

        Args:
            tick: The tick.
            agents: For each utterance, in order, the names of its hearers.
        """
        self._live().post("hear", tick=tick, heard=[list(names) for names in agents])

    def close(self) -> None:
        """End both processes; people get a message that the run is over."""
        self._closed = True
        self._beliefs.close()
        channel, self._channel = self._channel, None
        if channel is None:
            return
        # If the process has ended already, nobody is left to be told.
        with suppress(BodyError):
            if not channel.lost:
                channel.request("shutdown")
        channel.close()

    def _started(self) -> Channel:
        channel, self._versions = started(
            self._seed, self._limits, HOSTING, listen=self._address.told
        )
        try:
            answer = channel.request("people", invited=sorted(self._invited))
            channel.request("pause", paused=self._paused)
        except BodyError:
            channel.close()
            raise
        # If any port was allowed, keep the one that people know.
        self._address = replace(self._address, port=answer["port"])
        return channel
