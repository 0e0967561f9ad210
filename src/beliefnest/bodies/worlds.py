"""The worlds a nest can be opened in, by name."""

from beliefnest.bodies.protocol import World
from beliefnest.bodies.scripted import ScriptedBodies
from beliefnest.errors import UnknownNameError

__all__ = ["WORLDS", "check_world", "open_world"]

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
