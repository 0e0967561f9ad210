"""Worlds in which a nest can be opened, by name."""

from collections.abc import Mapping
from typing import Self

from beliefnest.world.frames import Snapshot
from beliefnest.worlds.names import maker_of
from beliefnest.worlds.process_limits import ProcessLimits
from beliefnest.worlds.protocol import Body, RealtimePlay, Sink, World


def open_world(name: str, seed: int, limits: ProcessLimits | None = None) -> World:
    """Return a world that has been started.

    Args:
        name: Name of the world.
        seed: Seed of every random number.
        limits: Limits of its process.

    Raises:
        BodyError: The world could not be started.
        UnknownNameError: There is no world of that name.
    """
    world = maker_of(name)(seed, limits)
    world.start()
    return world


class Worlds:
    """Worlds that are shared by successive nests, so that each is started once.

    Events in one nest do not depend on earlier ones: bodies are isolated, and each has its own
    seed. A process that ended is started again for the next body. Use it in a `with` block.

    Args:
        seed: Seed of the worlds' own random numbers.
        begun: Worlds that were made earlier with the same seed, by name.
    """

    def __init__(self, seed: int, begun: Mapping[str, World] | None = None) -> None:
        self._seed = seed
        self._worlds = dict(begun or {})

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
            self._worlds[name] = maker_of(name)(self._seed, None)
        self._worlds[name].start()
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

    @property
    def realtime(self) -> RealtimePlay | None:
        """The wrapped world, if it runs in real time."""
        return self.inner.realtime

    def start(self) -> None:
        """Start the process of the wrapped world."""
        self.inner.start()

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
