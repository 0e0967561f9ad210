"""The worlds a nest can be opened in, by name."""

from collections.abc import Callable, Mapping
from types import TracebackType
from typing import Self

from beliefnest.bodies.protocol import Body, Sink, World
from beliefnest.bodies.scripted import ScriptedBodies
from beliefnest.errors import BodyError, UnknownNameError
from beliefnest.world.frames import Snapshot

__all__ = ["WORLDS", "LateWorld", "Worlds", "check_world", "open_world"]

WORLDS = ("embedded", "scripted")
"""Names of the worlds."""


def open_world(name: str, seed: int) -> World:
    """Start a world.

    Raises:
        BodyError: It could not be started.
        UnknownNameError: There is no world of that name.
    """
    check_world(name)
    match name:
        case "embedded":
            from beliefnest.bodies.embedded import EmbeddedWorld

            return EmbeddedWorld.start(seed)
        case "scripted":
            return ScriptedBodies()
        case _:
            raise AssertionError(f"{name} is listed in WORLDS and cannot be started")


def check_world(name: str) -> None:
    """Refuse the name of a world that there is not, before anything is started.

    Raises:
        UnknownNameError: There is no world of that name.
    """
    if name not in WORLDS:
        raise UnknownNameError(f"there is no world {name!r}; there are {', '.join(WORLDS)}")


class LateWorld:
    """A world that is started when its first body is opened.

    Args:
        name: Name of the world.
        seed: Drives every random number.

    Raises:
        UnknownNameError: There is no world of that name.
    """

    def __init__(self, name: str, seed: int) -> None:
        check_world(name)
        self._name = name
        self._seed = seed
        self._world: World | None = None

    @property
    def versions(self) -> Mapping[str, str]:
        """Program to version, of what runs; nothing runs before the first body."""
        return {} if self._world is None else self._world.versions

    def open_body(self, name: str, seed: str, snapshot: Snapshot, sink: Sink) -> Body:
        """Make a body, in a world that is started if it is the first.

        Raises:
            BodyError: The world could not be started.
        """
        if self._world is None:
            self._world = open_world(self._name, self._seed)
        return self._world.open_body(name, seed, snapshot, sink)

    def close(self) -> None:
        """End the world if it was started."""
        if self._world is not None:
            self._world.close()


class Worlds:
    """Worlds that nests live in one after the other, so that each is started once.

    What happens in one nest does not depend on those before it: bodies are isolated, and
    each has its own seed. A world in which something failed is ended, not lent again. Use
    it in a `with` block.

    Args:
        seed: Drives the random numbers of the worlds themselves.
    """

    def __init__(self, seed: int) -> None:
        self._seed = seed
        self._worlds: dict[str, World] = {}

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        for name in list(self._worlds):
            self._end(name)

    def lend(self, name: str) -> World:
        """A world whose `close` gives up the bodies that were opened in it, not the world.

        Raises:
            BodyError: It could not be started.
            UnknownNameError: There is no world of that name.
        """
        if name not in self._worlds:
            self._worlds[name] = open_world(name, self._seed)
        return _Lent(self._worlds[name], lambda: self._end(name))

    def _end(self, name: str) -> None:
        self._worlds.pop(name).close()


class _Lent:
    """A world for one nest only."""

    def __init__(self, world: World, end: Callable[[], None]) -> None:
        self._world = world
        self._end = end
        self._bodies: list[Body] = []

    @property
    def versions(self) -> Mapping[str, str]:
        """Program to version, of what runs."""
        return self._world.versions

    def open_body(self, name: str, seed: str, snapshot: Snapshot, sink: Sink) -> Body:
        """Make a body that is given up with the nest at the latest."""
        body = self._world.open_body(name, seed, snapshot, sink)
        self._bodies.append(body)
        return body

    def close(self) -> None:
        """Give up all bodies; the world too if it does not even do that."""
        try:
            for body in self._bodies:
                body.close()
        except BodyError:
            self._end()
        self._bodies.clear()
