"""Address on which people join the embedded world in real time: `embedded://HOST:PORT`."""

from typing import Any
from urllib.parse import urlsplit

import msgspec
from msgspec.structs import asdict

from beliefnest.errors import InputError

LOOPBACK = "127.0.0.1"
"""Address for people at this machine only."""

DEFAULT_PORT = 25565
"""Port on which Minecraft expects a server."""

_SCHEME = "embedded"
_HIGHEST = 65535


def is_hosted(world: str) -> bool:
    """Return True if the name of a world is that of an embedded one in real time."""
    return world.startswith(f"{_SCHEME}://")


class ListenAddress(msgspec.Struct, frozen=True):
    """Address on which an embedded world in real time listens.

    Attributes:
        host: Address of this machine.
        port: Port; 0 for any free one.
    """

    host: str = LOOPBACK
    port: int = DEFAULT_PORT

    @classmethod
    def of(cls, listen: int | str) -> "ListenAddress":
        """Return the address for a port of the loopback, or for `HOST:PORT`.

        Raises:
            InputError: The value is neither.
        """
        if isinstance(listen, int):
            return cls._checked(LOOPBACK, listen, listen)
        try:
            parts = urlsplit(f"{_SCHEME}://{listen}")
            host, port = parts.hostname, parts.port
        except ValueError:
            host, port = None, None
        if host is None or port is None or parts.path or parts.username is not None:
            raise InputError(f"listen is {listen!r}; give a port, or HOST:PORT as 0.0.0.0:25565")
        return cls._checked(host, port, listen)

    @classmethod
    def parse(cls, world: str) -> "ListenAddress":
        """Return the address in the name of a world.

        Raises:
            InputError: The name contains no valid address.
        """
        return cls.of(world.removeprefix(f"{_SCHEME}://"))

    @classmethod
    def _checked(cls, host: str, port: int, value: object) -> "ListenAddress":
        if isinstance(port, bool) or not 0 <= port <= _HIGHEST:
            raise InputError(
                f"listen is {value!r}; a port is a number from 1 to {_HIGHEST}, 0 is any free one"
            )
        return cls(host, port)

    @property
    def told(self) -> dict[str, Any]:
        """Return the message about it to the Minecraft side."""
        return asdict(self)

    @property
    def world(self) -> str:
        """Name of the world."""
        return f"{_SCHEME}://{self}"

    def __str__(self) -> str:
        host = f"[{self.host}]" if ":" in self.host else self.host
        return f"{host}:{self.port}"


def listening(listen: int | str | None) -> str:
    """Return the name of the world that people join at a port, or HOST:PORT; None: Minecraft's.

    Raises:
        InputError: The value is neither.
    """
    return ListenAddress.of(DEFAULT_PORT if listen is None else listen).world
