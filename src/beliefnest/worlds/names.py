"""Names of worlds, and addresses in their place."""

from beliefnest.errors import InputError, UnknownNameError
from beliefnest.worlds.servers.address import SCHEME, ServerAddress, is_server
from beliefnest.worlds.servers.listening import DEFAULT_PORT, ListenAddress, is_hosted

WORLDS = ("embedded", "scripted")
"""Names of the worlds.

Any other name is the address of a server, `minecraft://HOST:PORT`, or of the embedded world in real
time, `embedded://HOST:PORT`.
"""


def check_world(name: str, *, servers: bool = True) -> None:
    """Refuse an unknown name of a world before anything is started.

    Args:
        name: The name.
        servers: True if it may be a world in real time, which plays one run at a time.

    Raises:
        UnknownNameError: There is no world of that name.
        InputError: It is a malformed address of a server.
    """
    if is_server(name) or is_hosted(name):
        if is_server(name):
            ServerAddress.parse(name)
        else:
            ListenAddress.parse(name)
        if not servers:
            raise InputError(
                f"{name} plays one run at a time, in real time; use it with `beliefnest run` or "
                f"Nest.open, and one of the worlds {', '.join(WORLDS)} for all else"
            )
    elif name not in WORLDS:
        raise UnknownNameError(
            f"there is no world {name!r}; there are {', '.join(WORLDS)}, {SCHEME}://HOST:PORT"
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
    return ListenAddress.of(DEFAULT_PORT if listen is None else listen).world
