"""Reality on a Minecraft server elsewhere, in real time; beliefs in the embedded world."""

from collections.abc import Mapping

from beliefnest.bodies.address import ServerAddress
from beliefnest.bodies.channel import Channel
from beliefnest.bodies.embedded import EmbeddedBody, EmbeddedWorld, started
from beliefnest.bodies.limits import ProcessLimits
from beliefnest.bodies.node_files import REALTIME
from beliefnest.bodies.protocol import Body, Sink
from beliefnest.errors import BodyError
from beliefnest.world.frames import Snapshot

__all__ = ["MinecraftWorld", "ServerBody"]

_REALITY = "/"


class ServerBody(EmbeddedBody):
    """The real world on a server: it goes on between the calls.

    A call first tells what has happened since the last one. `set_state` makes the place what is
    asked for, whatever happened there meanwhile.
    """

    @property
    def goes_on(self) -> bool:
        """True: the server's time does not wait."""
        return True


class MinecraftWorld:
    """A server on which the real world is played, and an embedded world for all others.

    Two processes of Node: the one that speaks to the server opens sockets, the one in which
    beliefs are acted out does not. Both are started when they are first needed.

    Args:
        address: The server.
        seed: Drives the random numbers of the embedded world.
        limits: What each process may take.
    """

    def __init__(
        self, address: ServerAddress, seed: int, limits: ProcessLimits | None = None
    ) -> None:
        self._address = address
        self._seed = seed
        self._limits = limits or ProcessLimits()
        self._beliefs = EmbeddedWorld(seed, limits)
        self._channel: Channel | None = None
        self._versions: Mapping[str, str] = {}
        self._closed = False

    @classmethod
    def start(
        cls, address: ServerAddress, seed: int, limits: ProcessLimits | None = None
    ) -> "MinecraftWorld":
        """Look whether the server can be played on, and let the operator in, now.

        Raises:
            BodyError: It cannot; the message says what is missing and what to do.
        """
        world = cls(address, seed, limits)
        world._live()
        return world

    @property
    def has_physics(self) -> bool:
        """True: it is Minecraft."""
        return True

    @property
    def versions(self) -> Mapping[str, str]:
        """Program to version, of what runs."""
        return {**self._beliefs.versions, **self._versions}

    @property
    def pid(self) -> int:
        """Process id of the Node that speaks to the server; it is started if it has not been."""
        return self._live().pid

    def open_body(self, name: str, seed: str, snapshot: Snapshot, sink: Sink) -> Body:
        """Make the real world's body on the server, any other one in the embedded world.

        Raises:
            WorldError: The server's place holds other blocks, or does not become as asked for.
        """
        self._beliefs.knows(snapshot.agents)
        if name != _REALITY:
            return self._beliefs.open_body(name, seed, snapshot, sink)
        known = sorted(snapshot.agents)
        return ServerBody.opened(self._live(), name, seed, snapshot, sink, known)

    def another(self) -> EmbeddedWorld:
        """An embedded world: what is tried out is not tried on the server.

        What is tried from reality begins there as reality is.
        """
        return self._beliefs.another()

    def interrupt(self) -> None:
        """Kill both processes; what was built on the server stays there."""
        self._beliefs.interrupt()
        if self._channel is not None:
            self._channel.kill()

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

    def _live(self) -> Channel:
        """The channel to the process that speaks to the server, started if none is running."""
        if self._closed:
            raise BodyError("this world was closed; open another one")
        if self._channel is None or self._channel.lost:
            if self._channel is not None:
                self._channel.close()
            self._channel, versions = started(
                self._seed, self._limits, REALTIME, server=self._address.told
            )
            self._versions = {**versions, "server": str(self._address)}
        return self._channel
