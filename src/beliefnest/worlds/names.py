"""Names of worlds, and addresses in their place."""

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any

from beliefnest.errors import InputError, UnknownNameError
from beliefnest.importing import installed, installed_names, load, part

if TYPE_CHECKING:  # Commands that list names import no NumPy.
    from beliefnest.worlds.process_limits import ProcessLimits
    from beliefnest.worlds.protocol import World

_WORLDS = "beliefnest.worlds"
"""Group of entry points by name of the world: functions of seed and limits that return a world."""

_SERVERS = "beliefnest.servers"
"""Group of entry points by scheme, such as `minecraft` in `minecraft://HOST:PORT`: functions of the
whole address, seed and limits that return a world in real time."""

_ADDRESS = "://"


def world_names() -> tuple[str, ...]:
    """Return the names of the installed worlds. Any other name is an address."""
    return installed_names(_WORLDS)


def server_forms() -> tuple[str, ...]:
    """Return the forms of addresses that are worlds, such as `minecraft://HOST:PORT`."""
    return tuple(f"{scheme}{_ADDRESS}HOST:PORT" for scheme in installed_names(_SERVERS))


def is_address(name: str) -> bool:
    """Return True if the name of a world is the address of one in real time."""
    return _ADDRESS in name


def maker_of(name: str) -> "Callable[[int, ProcessLimits | None], World]":
    """Return the function of seed and limits that makes the world of a name; it starts nothing.

    Raises:
        UnknownNameError: There is no world of that name.
        InputError: It cannot be imported.
    """
    scheme, colon, _ = name.partition(_ADDRESS)
    entry = installed(_SERVERS, scheme.lower()) if colon else installed(_WORLDS, name)
    if entry is None:
        forms = ", ".join((*world_names(), *server_forms()))
        raise UnknownNameError(f"there is no world {name!r}; there are {forms}")
    make: Any = load(entry, "world")
    return partial(make, name) if colon else make


def check_world(name: str, *, servers: bool = True) -> None:
    """Refuse an unknown name of a world before anything is started.

    Args:
        name: The name.
        servers: True if it may be a world in real time, which plays one run at a time.

    Raises:
        UnknownNameError: There is no world of that name.
        InputError: It is a malformed address of a server.
    """
    make = maker_of(name)
    if is_address(name):
        make(0, None)
        if not servers:
            raise InputError(
                f"{name} plays one run at a time, in real time; use it with `beliefnest run` or "
                f"Nest.open, and one of the worlds {', '.join(world_names())} for all else"
            )


def world_name(world: str, *, realtime: bool, listen: int | str | None) -> str:
    """Return the name of a world, in real time if requested; `listen` is the port for people.

    Raises:
        InputError: It is not the embedded one, or `listen` is not a valid port or has no use.
    """
    if not realtime:
        if listen is not None:
            raise InputError(
                "people can join only worlds in real time: give realtime=True (--realtime) as well"
            )
        return world
    if world != "embedded":
        raise InputError(
            f"the world {world!r} has no real time; realtime is for the world embedded"
        )
    name: str = part("listening")(listen)
    return name
