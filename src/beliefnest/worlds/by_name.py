"""Worlds in which a nest can be opened, by name."""

from collections.abc import Mapping
from types import TracebackType
from typing import Self

from beliefnest.world.frames import Snapshot
from beliefnest.worlds.minecraft.launching import Launch
from beliefnest.worlds.names import check_world
from beliefnest.worlds.process_limits import ProcessLimits
from beliefnest.worlds.protocol import Body, Sink, World
from beliefnest.worlds.scripted.nest_world import ScriptedNestWorld
from beliefnest.worlds.servers.address import ServerAddress, is_server
from beliefnest.worlds.servers.hosted import HostedWorld
from beliefnest.worlds.servers.listening import ListenAddress, is_hosted
from beliefnest.worlds.servers.realtime import RealtimeWorld

__all__ = [
    "LazyWorld",
    "Worlds",
    "hosted_of",
    "is_real_time",
    "joined_of",
    "open_world",
    "realtime_of",
]

_WITHOUT_PHYSICS = frozenset({"scripted"})


def open_world(
    name: str, seed: int, limits: ProcessLimits | None = None, launch: Launch | None = None
) -> World:
    """Start a world.

    Args:
        name: Name of the world.
        seed: Seed of every random number.
        limits: Limits of its process.
        launch: Node of the embedded world, started earlier with the same seed and limits.

    Raises:
        BodyError: The world could not be started.
        UnknownNameError: There is no world of that name.
    """
    check_world(name)
    if is_server(name):
        from beliefnest.worlds.servers.server_world import MinecraftWorld

        return MinecraftWorld.start(ServerAddress.parse(name), seed, limits)
    if is_hosted(name):
        return HostedWorld.start(ListenAddress.parse(name), seed, limits)
    match name:
        case "embedded":
            from beliefnest.worlds.minecraft.embedded import EmbeddedWorld

            return EmbeddedWorld.start(seed, limits, launch)
        case "scripted":
            return ScriptedNestWorld()
        case _:
            raise AssertionError(f"{name} is listed in WORLDS and cannot be started")


def joined_of(world: World) -> RealtimeWorld | None:
    """Return the world that people can join, also if it is lent; None for another kind."""
    match world:
        case RealtimeWorld():
            return world
        case LazyWorld() | _SharedWorld():
            return None if world.inner is None else joined_of(world.inner)
        case _:
            return None


def realtime_of(world: World) -> RealtimeWorld | None:
    """Return the world that runs in real time, also if it is lent; None for another kind.

    Raises:
        BodyError: The world had not been started, and the start failed.
    """
    match world:
        case RealtimeWorld():
            return world
        case LazyWorld():
            return realtime_of(world.started()) if world.is_realtime else None
        case _SharedWorld():
            return realtime_of(world.inner)
        case _:
            return None


def hosted_of(world: World) -> HostedWorld | None:
    """Return the embedded world that people join, also if it is lent; None for another kind.

    Raises:
        BodyError: As for `realtime_of`.
    """
    found = realtime_of(world)
    return found if isinstance(found, HostedWorld) else None


def is_real_time(world: World) -> bool:
    """Return True if the real world runs on between calls in real time, or will once started."""
    match world:
        case RealtimeWorld():
            return True
        case LazyWorld():
            return world.is_realtime
        case _SharedWorld():
            return is_real_time(world.inner)
        case _:
            return False


class LazyWorld:
    """World that is started when its first body is opened.

    Args:
        name: Name of the world.
        seed: Seed of every random number.
        limits: Limits of its process.

    Raises:
        UnknownNameError: There is no world of that name.
    """

    def __init__(self, name: str, seed: int, limits: ProcessLimits | None = None) -> None:
        check_world(name)
        self._name = name
        self._seed = seed
        self._limits = limits
        self._world: World | None = None

    @property
    def has_physics(self) -> bool:
        """True if agents in its bodies stand, fall and are stopped by blocks."""
        return self._name not in _WITHOUT_PHYSICS

    @property
    def versions(self) -> Mapping[str, str]:
        """Versions of the running programs by name; empty before the first body."""
        return {} if self._world is None else self._world.versions

    @property
    def inner(self) -> World | None:
        """The wrapped world, if it was started."""
        return self._world

    def open_body(self, name: str, seed: str, snapshot: Snapshot, sink: Sink) -> Body:
        """Create a body; the first one starts the world.

        Raises:
            BodyError: The world could not be started.
        """
        return self.started().open_body(name, seed, snapshot, sink)

    @property
    def is_realtime(self) -> bool:
        """True if it runs in real time, where people can play."""
        return is_server(self._name) or is_hosted(self._name)

    def started(self) -> World:
        """Return the wrapped world, and start it if necessary.

        Raises:
            BodyError: The world could not be started.
        """
        if self._world is None:
            self._world = open_world(self._name, self._seed, self._limits)
        return self._world

    def another(self) -> World:
        """Return another world of the same kind, which starts with its first body."""
        return LazyWorld(self._name, self._seed, self._limits)

    def interrupt(self) -> None:
        """Interrupt its work for another thread."""
        if self._world is not None:
            self._world.interrupt()

    def close(self) -> None:
        """Close the world if it was started."""
        if self._world is not None:
            self._world.close()


class Worlds:
    """Worlds that are shared by successive nests, so that each is started once.

    Events in one nest do not depend on earlier ones: bodies are isolated, and each has its own
    seed. A process that ended is started again for the next body. Use it in a `with` block.

    Args:
        seed: Seed of the worlds' own random numbers.
        limits: Limits of the process of each world.
        launch: Node of the embedded world, started earlier with the same seed and limits.
    """

    def __init__(
        self, seed: int, limits: ProcessLimits | None = None, launch: Launch | None = None
    ) -> None:
        self._seed = seed
        self._limits = limits
        self._launch = launch
        self._worlds: dict[str, World] = {}

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        for world in self._worlds.values():
            world.close()
        self._worlds.clear()

    def lend(self, name: str) -> World:
        """Return a world whose `close` closes only the bodies opened in it.

        Raises:
            BodyError: The world could not be started.
            UnknownNameError: There is no world of that name.
        """
        if name not in self._worlds:
            self._worlds[name] = open_world(name, self._seed, self._limits, self._launch)
        return _SharedWorld(self._worlds[name])


class _SharedWorld:
    """World for one nest only."""

    def __init__(self, world: World) -> None:
        self._world = world
        self._bodies: list[Body] = []

    @property
    def has_physics(self) -> bool:
        """True if agents in its bodies stand, fall and are stopped by blocks."""
        return self._world.has_physics

    @property
    def versions(self) -> Mapping[str, str]:
        """Versions of the running programs by name."""
        return self._world.versions

    @property
    def inner(self) -> World:
        """The wrapped world."""
        return self._world

    def open_body(self, name: str, seed: str, snapshot: Snapshot, sink: Sink) -> Body:
        """Create a body that is closed with the nest at the latest."""
        body = self._world.open_body(name, seed, snapshot, sink)
        self._bodies.append(body)
        return body

    def another(self) -> World:
        """Return another world of the same kind, for this nest alone."""
        return self._world.another()

    def interrupt(self) -> None:
        """Interrupt its work for another thread."""
        self._world.interrupt()

    def close(self) -> None:
        """Close all bodies."""
        for body in self._bodies:
            body.close()
        self._bodies.clear()
