"""Worlds in which a nest can be opened, by name."""

from collections.abc import Mapping
from typing import Self

from beliefnest.world.frames import Snapshot
from beliefnest.worlds.minecraft.embedded import EmbeddedWorld, NodeWorld
from beliefnest.worlds.minecraft.launching import Launch
from beliefnest.worlds.names import check_world
from beliefnest.worlds.process_limits import ProcessLimits
from beliefnest.worlds.protocol import Body, Sink, World
from beliefnest.worlds.scripted.nest_world import ScriptedNestWorld
from beliefnest.worlds.servers.address import ServerAddress, is_server
from beliefnest.worlds.servers.hosted import HostedWorld
from beliefnest.worlds.servers.listening import ListenAddress, is_hosted
from beliefnest.worlds.servers.realtime import RealtimeWorld
from beliefnest.worlds.servers.server_world import MinecraftWorld


def new_world(
    name: str, seed: int, limits: ProcessLimits | None = None, launch: Launch | None = None
) -> World:
    """Return a world, which starts when it is first needed.

    Args:
        name: Name of the world.
        seed: Seed of every random number.
        limits: Limits of its process.
        launch: Node of the embedded world, started earlier with the same seed and limits.

    Raises:
        UnknownNameError: There is no world of that name.
    """
    check_world(name)
    if is_server(name):
        return MinecraftWorld(ServerAddress.parse(name), seed, limits)
    if is_hosted(name):
        return HostedWorld(ListenAddress.parse(name), seed, limits)
    match name:
        case "embedded":
            return EmbeddedWorld(seed, limits, launch)
        case "scripted":
            return ScriptedNestWorld()
        case _:
            raise AssertionError(f"{name} is listed in WORLDS and cannot be made")


def open_world(
    name: str, seed: int, limits: ProcessLimits | None = None, launch: Launch | None = None
) -> World:
    """Return a world that has been started; the arguments are those of `new_world`.

    Raises:
        BodyError: The world could not be started.
        UnknownNameError: There is no world of that name.
    """
    world = new_world(name, seed, limits, launch)
    if isinstance(world, NodeWorld):
        world.start()
    return world


def realtime_of(world: World) -> RealtimeWorld | None:
    """Return the world that runs in real time, also if it is lent; None for another kind."""
    inner = world.inner if isinstance(world, _SharedWorld) else world
    return inner if isinstance(inner, RealtimeWorld) else None


def hosted_of(world: World) -> HostedWorld | None:
    """Return the embedded world that people join, also if it is lent; None for another kind."""
    found = realtime_of(world)
    return found if isinstance(found, HostedWorld) else None


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

    def __exit__(self, *_: object) -> None:
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
    """World for one nest only.

    Attributes:
        inner: The wrapped world.
    """

    def __init__(self, world: World) -> None:
        self.inner, self.has_physics = world, world.has_physics
        self._bodies: list[Body] = []

    @property
    def versions(self) -> Mapping[str, str]:
        """Versions of the running programs by name."""
        return self.inner.versions

    def open_body(self, name: str, seed: str, snapshot: Snapshot, sink: Sink) -> Body:
        """Create a body that is closed with the nest at the latest."""
        body = self.inner.open_body(name, seed, snapshot, sink)
        self._bodies.append(body)
        return body

    def another(self) -> World:
        """Return another world of the same kind, for this nest alone."""
        return self.inner.another()

    def interrupt(self) -> None:
        """Interrupt its work for another thread."""
        self.inner.interrupt()

    def close(self) -> None:
        """Close all bodies."""
        for body in self._bodies:
            body.close()
        self._bodies.clear()
