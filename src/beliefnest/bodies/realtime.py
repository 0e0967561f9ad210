"""Reality in real time, in a process of its own that has sockets; beliefs in the embedded world."""

from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping

from beliefnest.bodies.channel import Channel
from beliefnest.bodies.embedded import EmbeddedBody, EmbeddedWorld
from beliefnest.bodies.exhibits import Exhibit, Plot, Shown
from beliefnest.bodies.limits import ProcessLimits
from beliefnest.bodies.protocol import Body, Sink
from beliefnest.errors import BodyError, InputError
from beliefnest.owned import Owned
from beliefnest.world.frames import Snapshot

__all__ = ["RealtimeBody", "RealtimeWorld"]

_REALITY = "/"


class RealtimeBody(EmbeddedBody):
    """The real world in real time: a call first tells what has happened since the last one.

    `set_state` makes the place what is asked for, whatever happened there meanwhile.
    """

    @property
    def goes_on(self) -> bool:
        """True: neither people nor servers wait."""
        return True


class RealtimeWorld(Owned, ABC):
    """A process for the real world, and an embedded world for all others.

    Two processes of Node: the one that plays the real world opens sockets, the one in which
    beliefs are acted out does not. Both are started when they are first needed.

    Args:
        seed: Drives the random numbers of beliefs' bodies.
        limits: What each process may take.
    """

    def __init__(self, seed: int, limits: ProcessLimits | None = None) -> None:
        super().__init__()
        self._seed = seed
        self._limits = limits or ProcessLimits()
        self._beliefs = EmbeddedWorld(seed, limits)
        self._channel: Channel | None = None
        self._versions: Mapping[str, str] = {}
        self._closed = False
        self._invited: frozenset[str] = frozenset()

    @property
    @abstractmethod
    def address(self) -> str:
        """Where a Minecraft client joins: `HOST:PORT`."""

    @property
    @abstractmethod
    def minecraft(self) -> str:
        """The version that it has to be."""

    @property
    def invited(self) -> frozenset[str]:
        """Who may join."""
        return self._invited

    def invite(self, people: Iterable[str]) -> None:
        """Say who may join; one who is there and may no longer be is sent away.

        Raises:
            WorldError: A server's operator cannot send people away.
        """
        self._invited = frozenset(people)
        self.here()

    def here(self) -> frozenset[str]:
        """Return the people who are there now."""
        told = self._live().request("people", invited=sorted(self._invited))
        return frozenset(told["here"])

    @property
    def has_physics(self) -> bool:
        """True: it is Minecraft."""
        return True

    @property
    def versions(self) -> Mapping[str, str]:
        """Program to version, of what runs."""
        return {**self._beliefs.versions, **self._versions}

    def open_body(self, name: str, seed: str, snapshot: Snapshot, sink: Sink) -> Body:
        """Make the real world's body in real time, any other one in the embedded world.

        Raises:
            WorldError: A server's place holds other blocks, or does not become as asked for.
            InputError: An agent has the name of another player, as the operator of a server.
        """
        for taken in sorted(self.players & snapshot.agents.keys()):
            raise InputError(
                f"an agent and a player besides the agents are both called {taken}; give one of "
                "them another name, the operator of a server by ?operator=NAME"
            )
        self._beliefs.knows(snapshot.agents)
        if name != _REALITY:
            return self._beliefs.open_body(name, seed, snapshot, sink)
        known = sorted(snapshot.agents)
        return RealtimeBody.opened(self._live(), name, seed, snapshot, sink, known)

    def another(self) -> EmbeddedWorld:
        """Return an embedded world: what is tried out goes as fast as it can, where nobody sees it.

        What is tried from reality begins there as reality is.
        """
        return self._beliefs.another()

    @abstractmethod
    def pause(self, *, paused: bool) -> None:
        """Let time stand still in the real world, or go on.

        Raises:
            WorldError: It is on a server elsewhere, which nobody here can stop.
        """

    def interrupt(self) -> None:
        """Kill both processes; what was built on a server stays there."""
        self._beliefs.interrupt()
        if self._channel is not None:
            self._channel.kill()

    @property
    @abstractmethod
    def origin(self) -> tuple[int, int]:
        """Where scenario (0, y, 0) of reality lies in Minecraft: x and z."""

    @property
    @abstractmethod
    def shows_reality(self) -> bool:
        """True if visitors see reality itself; if not, they need to be shown it as beliefs are."""

    @property
    def players(self) -> frozenset[str]:
        """Names of players besides the agents."""
        return frozenset()

    def open_exhibit(self, name: str, plot: Plot, shown: Shown) -> Exhibit:
        """Let people see what a simulator holds, at a place of its own.

        Raises:
            WorldError: The place on a server holds other blocks.
            BodyError: It could not be built.
        """
        return Exhibit.opened(self._live(), name, plot, shown)

    def lags(self) -> Mapping[str, int]:
        """By how many ticks what changed in exhibits was shown later, at most, by name."""
        lags: Mapping[str, int] = self._live().request("lags")
        return lags

    def _live(self) -> Channel:
        """Return the channel to the process of the real world, started if none is running."""
        self.check_own("the world")
        if self._closed:
            raise BodyError("this world was closed; open another one")
        if self._channel is None or self._channel.lost:
            if self._channel is not None:
                self._channel.close()
            self._channel = self._started()
        return self._channel

    @abstractmethod
    def _started(self) -> Channel:
        """Start the process of the real world; sets `_versions`."""
