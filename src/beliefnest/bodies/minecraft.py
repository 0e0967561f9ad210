"""Reality on a Minecraft server elsewhere, in real time; beliefs in the embedded world."""

from collections.abc import Mapping
from pathlib import Path
from typing import Self

from beliefnest.bodies.address import ServerAddress
from beliefnest.bodies.channel import Channel
from beliefnest.bodies.embedded import started
from beliefnest.bodies.limits import ProcessLimits
from beliefnest.bodies.node_files import REALTIME
from beliefnest.bodies.realtime import RealtimeWorld
from beliefnest.errors import BodyError, WorldError

__all__ = ["MinecraftWorld", "joined"]


def joined(
    address: ServerAddress, seed: int, limits: ProcessLimits
) -> tuple[Channel, Mapping[str, str]]:
    """A channel to a new Node whose operator is on a server, and the versions of what runs there.

    Raises:
        BodyError: The server cannot be played on, or the folder for accounts cannot be had.
    """
    folder = None if address.accounts is None else Path(address.accounts)
    if folder is not None:
        try:
            # Tokens are the user's alone.
            folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        except OSError as error:
            raise BodyError(f"accounts cannot be kept in {folder}: {error.strerror}") from error
    return started(seed, limits, REALTIME, folder, server=address.told)


class MinecraftWorld(RealtimeWorld):
    """A server on which the real world is played, and an embedded world for all others.

    Args:
        address: The server.
        seed: Drives the random numbers of the embedded world.
        limits: What each process may take.
    """

    def __init__(
        self, address: ServerAddress, seed: int, limits: ProcessLimits | None = None
    ) -> None:
        super().__init__(seed, limits)
        self._address = address

    @classmethod
    def start(cls, address: ServerAddress, seed: int, limits: ProcessLimits | None = None) -> Self:
        """Look whether the server can be played on, and let the operator in, now.

        Raises:
            BodyError: It cannot; the message says what is missing and what to do.
        """
        world = cls(address, seed, limits)
        world._live()
        return world

    @property
    def origin(self) -> tuple[int, int]:
        """Where scenario (0, y, 0) lies on the server: x and z."""
        return self._address.at

    @property
    def shows_reality(self) -> bool:
        """True: it stands on the server, for everybody who is there."""
        return True

    @property
    def players(self) -> frozenset[str]:
        """The operator."""
        return frozenset({self._address.operator})

    @property
    def address(self) -> str:
        """Where a Minecraft client joins: `HOST:PORT`."""
        return f"{self._address.host}:{self._address.port}"

    @property
    def minecraft(self) -> str:
        """The version that the server speaks; it is asked if it has not been."""
        self._live()
        return self._versions["minecraft_server"]

    @property
    def pid(self) -> int:
        """Process id of the Node that speaks to the server; it is started if it has not been."""
        return self._live().pid

    def pause(self, *, paused: bool) -> None:
        """Refused: the server's time is its own.

        Raises:
            WorldError: Always.
        """
        raise WorldError(
            f"the server at {self.address} goes on whatever happens here; only the embedded world "
            "in real time (realtime=True, listen=PORT) can be paused"
        )

    def close(self) -> None:
        """Put back what was in the box on the server, let all players leave, end both processes.

        Raises:
            BodyError: The server could not be left as it was.
        """
        if self._closed:
            return
        self._closed = True
        self._beliefs.close()
        channel = self._channel
        if channel is None:
            return
        try:
            if not channel.lost:
                channel.request("shutdown")
        finally:
            channel.close()

    def _started(self) -> Channel:
        channel, versions = joined(self._address, self._seed, self._limits)
        channel.request("people", invited=sorted(self._invited))
        self._versions = {**versions, "server": str(self._address)}
        return channel
