"""Real world in real time, in a process with sockets; beliefs in the embedded world."""

from abc import abstractmethod
from collections.abc import Iterable, Mapping
from typing import Self

from beliefnest.errors import InputError
from beliefnest.world.frames import Snapshot
from beliefnest.worlds.minecraft.embedded import EmbeddedBody, EmbeddedWorld, NodeWorld
from beliefnest.worlds.minecraft.exhibits import Exhibit, Plot, Shown
from beliefnest.worlds.process_limits import ProcessLimits
from beliefnest.worlds.protocol import Sink, SpeechHost

_REALITY = "/"


class RealtimeBody(EmbeddedBody):
    """Real world in real time: a call first reports the events since the last one.

    `set_state` sets the requested state, whatever happened in the meantime.
    """

    goes_on = True


class RealtimeWorld(NodeWorld):
    """Process for the real world, and an embedded world for all others.

    There are two processes of Node: the one that plays the real world opens sockets; the one in
    which beliefs are acted out does not. Each starts when it is first needed.

    Args:
        seed: Seed of the random numbers of beliefs' bodies.
        limits: Limits of each process.

    Attributes:
        origin: Position of scenario (0, y, 0) of reality in Minecraft: x and z.
        shows_reality: True if visitors see reality itself; False if an exhibit shows it to them.
    """

    origin: tuple[int, int]
    shows_reality: bool

    def __init__(self, seed: int, limits: ProcessLimits | None = None) -> None:
        super().__init__(seed, limits)
        self._beliefs = EmbeddedWorld(seed, limits)
        self._invited: frozenset[str] = frozenset()

    @property
    def realtime(self) -> Self:
        """The world itself; see `World`."""
        return self

    @property
    def host(self) -> SpeechHost | None:
        """The process that people join; None: a server elsewhere."""
        return None

    @property
    @abstractmethod
    def address(self) -> str:
        """Address for Minecraft clients: `HOST:PORT`."""

    @property
    @abstractmethod
    def minecraft(self) -> str:
        """Minecraft version of the clients."""

    @property
    def invited(self) -> frozenset[str]:
        """Names of the people who may join."""
        return self._invited

    def invite(self, people: Iterable[str]) -> None:
        """Set the people who may join; disconnect others who are there.

        Raises:
            WorldError: A server's operator may not kick people.
        """
        self._invited = frozenset(people)
        # A world that has not been started yet may wait until it has to.
        if self._invited or self._channel is not None:
            self.here()

    def here(self) -> frozenset[str]:
        """Return the names of the people who play now."""
        answer = self._live().request("people", invited=sorted(self._invited))
        return frozenset(answer["here"])

    @property
    def versions(self) -> Mapping[str, str]:
        """Versions of the running programs by name."""
        return {**self._beliefs.versions, **self._versions}

    def open_body(self, name: str, seed: str, snapshot: Snapshot, sink: Sink) -> EmbeddedBody:
        """Open the real world's body in real time, and all others in the embedded world.

        Raises:
            WorldError: A server's place holds other blocks, or the server builds something else.
            InputError: An agent has the name of another player, such as the operator of a server.
        """
        for taken in sorted(self.players & snapshot.agents.keys()):
            raise InputError(
                f"an agent and a player besides the agents are both called {taken}; give one of "
                "them another name, the operator of a server by ?operator=NAME"
            )
        self._beliefs.knows(snapshot.agents)
        if name != _REALITY:
            return self._beliefs.open_body(name, seed, snapshot, sink)
        agents = sorted(snapshot.agents)
        return RealtimeBody.opened(self._live(), name, seed, snapshot, sink, agents)

    def another(self) -> EmbeddedWorld:
        """Return an embedded world, for trials at full speed that nobody sees.

        A trial that starts from reality begins with its present state.
        """
        return self._beliefs.another()

    @abstractmethod
    def pause(self, *, paused: bool) -> None:
        """Stop or resume time in the real world.

        Raises:
            WorldError: It is on a server, whose time cannot be stopped.
        """

    def interrupt(self) -> None:
        """Kill both processes; blocks that were built on a server stay there."""
        self._beliefs.interrupt()
        super().interrupt()

    @property
    def players(self) -> frozenset[str]:
        """Names of players besides the agents."""
        return frozenset()

    def open_exhibit(self, name: str, plot: Plot, shown: Shown) -> Exhibit:
        """Show the content of a simulator to people, at a place of its own.

        Raises:
            WorldError: The place on a server holds other blocks.
            BodyError: The exhibit could not be built.
        """
        return Exhibit.opened(self._live(), name, plot, shown)

    def lags(self) -> Mapping[str, int]:
        """Return the largest delay of changes in each exhibit, in ticks, by name."""
        lags: Mapping[str, int] = self._live().request("lags")
        return lags
