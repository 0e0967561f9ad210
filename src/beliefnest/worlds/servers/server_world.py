"""Real world on a Minecraft server, in real time; beliefs in the embedded world."""

from collections.abc import Mapping
from pathlib import Path
from typing import Self

from beliefnest.errors import BodyError, WorldError
from beliefnest.worlds.minecraft.channel import Channel
from beliefnest.worlds.minecraft.launching import started
from beliefnest.worlds.minecraft.node_files import REALTIME
from beliefnest.worlds.process_limits import ProcessLimits
from beliefnest.worlds.servers.address import ServerAddress
from beliefnest.worlds.servers.realtime import RealtimeWorld


def joined(
    address: ServerAddress, seed: int, limits: ProcessLimits
) -> tuple[Channel, Mapping[str, str]]:
    """Start a Node whose operator joins a server; return the channel and the versions.

    Raises:
        BodyError: The server cannot be used, or the folder for accounts cannot be created.
    """
    folder = None if address.accounts is None else Path(address.accounts)
    if folder is not None:
        try:
            # Only the user may read the tokens.
            folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        except OSError as error:
            raise BodyError(
                f"tokens of accounts cannot be stored in {folder}: {error.strerror}"
            ) from error
    return started(seed, limits, REALTIME, folder, server=address.told)


class MinecraftWorld(RealtimeWorld):
    """Server on which the real world is played, and an embedded world for all others.

    Args:
        address: The server.
        seed: Seed of the embedded world's random numbers.
        limits: Limits of each process.
    """

    shows_reality = True

    def __init__(
        self, address: ServerAddress, seed: int, limits: ProcessLimits | None = None
    ) -> None:
        super().__init__(seed, limits)
        self._address, self.origin = address, address.at

    @classmethod
    def of(cls, name: str, seed: int, limits: ProcessLimits | None = None) -> Self:
        """Return the world of an address, such as `minecraft://localhost:25565`.

        Raises:
            InputError: The address is malformed.
        """
        return cls(ServerAddress.parse(name), seed, limits)

    @property
    def players(self) -> frozenset[str]:
        """The operator."""
        return frozenset({self._address.operator})

    @property
    def address(self) -> str:
        """Address for Minecraft clients: `HOST:PORT`."""
        return f"{self._address.host}:{self._address.port}"

    @property
    def minecraft(self) -> str:
        """Minecraft version of the server, which is asked if necessary."""
        self._live()
        return self._versions["minecraft_server"]

    def pause(self, *, paused: bool) -> None:
        """Refuse: the server's time cannot be stopped.

        Raises:
            WorldError: Always.
        """
        raise WorldError(
            f"the server at {self.address} cannot be paused; only the embedded world "
            "in real time (realtime=True, listen=PORT) can"
        )

    def close(self) -> None:
        """Restore the box on the server, disconnect all players, and end both processes.

        Raises:
            BodyError: The server could not be restored.
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
