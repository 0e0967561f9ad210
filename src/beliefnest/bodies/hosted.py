"""The embedded world in real time, where people are agents as well; beliefs in another process."""

from collections.abc import Iterable, Mapping
from dataclasses import replace

from beliefnest.bodies.channel import Channel
from beliefnest.bodies.embedded import MINECRAFT, EmbeddedBody, EmbeddedWorld, started
from beliefnest.bodies.limits import ProcessLimits
from beliefnest.bodies.listening import ListenAddress
from beliefnest.bodies.node_files import HOSTING
from beliefnest.bodies.protocol import Body, Sink
from beliefnest.errors import BodyError
from beliefnest.world.frames import Snapshot

__all__ = ["HostedBody", "HostedWorld"]

_REALITY = "/"


class HostedBody(EmbeddedBody):
    """The real world in real time: a call first tells what has happened since the last one."""

    @property
    def goes_on(self) -> bool:
        """True: people do not wait."""
        return True


class HostedWorld:
    """A process for the real world, which people can join, and another one for all beliefs.

    Args:
        address: Where people come in.
        seed: Drives the random numbers of beliefs' bodies.
        limits: What each process may take.
    """

    def __init__(
        self, address: ListenAddress, seed: int, limits: ProcessLimits | None = None
    ) -> None:
        self._address = address
        self._seed = seed
        self._limits = limits or ProcessLimits()
        self._beliefs = EmbeddedWorld(seed, limits)
        self._channel: Channel | None = None
        self._versions: Mapping[str, str] = {}
        self._invited: frozenset[str] = frozenset()
        self._closed = False

    @classmethod
    def start(
        cls, address: ListenAddress, seed: int, limits: ProcessLimits | None = None
    ) -> "HostedWorld":
        """Start the process of the real world and listen, now.

        Raises:
            BodyError: Node or the bundle is missing, or the port cannot be had.
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
    def address(self) -> str:
        """Where a Minecraft client joins: `HOST:PORT`."""
        return str(self._address)

    @property
    def minecraft(self) -> str:
        """The version that it has to be."""
        return MINECRAFT

    @property
    def invited(self) -> frozenset[str]:
        """Who may join."""
        return self._invited

    def invite(self, people: Iterable[str]) -> None:
        """Say who may join; one who is there and may no longer be is sent away."""
        self._invited = frozenset(people)
        self.here()

    def here(self) -> frozenset[str]:
        """The people who are there now."""
        told = self._live().request("people", invited=sorted(self._invited))
        return frozenset(told["here"])

    def open_body(self, name: str, seed: str, snapshot: Snapshot, sink: Sink) -> Body:
        """Make the real world's body in real time, any other one in the embedded world."""
        self._beliefs.knows(snapshot.agents)
        if name != _REALITY:
            return self._beliefs.open_body(name, seed, snapshot, sink)
        known = sorted(snapshot.agents)
        return HostedBody.opened(self._live(), name, seed, snapshot, sink, known)

    def another(self) -> EmbeddedWorld:
        """An embedded world: what is tried out goes as fast as it can, where nobody sees it."""
        return self._beliefs.another()

    def interrupt(self) -> None:
        """Kill both processes."""
        self._beliefs.interrupt()
        if self._channel is not None:
            self._channel.kill()

    def close(self) -> None:
        """End both processes; people are disconnected."""
        self._closed = True
        self._beliefs.close()
        if self._channel is not None:
            self._channel.close()

    def _live(self) -> Channel:
        """The channel to the process of the real world, started if none is running."""
        if self._closed:
            raise BodyError("this world was closed; open another one")
        if self._channel is None or self._channel.lost:
            if self._channel is not None:
                self._channel.close()
            self._channel, self._versions = started(
                self._seed, self._limits, HOSTING, listen=self._address.told
            )
            told = self._channel.request("people", invited=sorted(self._invited))
            # Where any port would do, people come back to the one they know.
            self._address = replace(self._address, port=told["port"])
        return self._channel
