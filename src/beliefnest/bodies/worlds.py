"""The worlds a nest can be opened in, by name."""

from collections.abc import Mapping

from beliefnest.bodies.protocol import Body, Sink, World
from beliefnest.bodies.scripted import ScriptedBodies
from beliefnest.errors import UnknownNameError
from beliefnest.world.frames import Snapshot

__all__ = ["WORLDS", "LateWorld", "check_world", "open_world"]

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
