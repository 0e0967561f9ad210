"""Addresses of Minecraft servers: `minecraft://HOST:PORT?option=value&...`."""

import re
from pathlib import Path
from typing import Any
from urllib.parse import parse_qsl, urlsplit

import msgspec
from msgspec.structs import asdict

from beliefnest.errors import InputError

SCHEME = "minecraft"

_PORT = 25565
_CHUNK = 16
_FARTHEST = 29_000_000
_NAME = re.compile(r"[A-Za-z0-9_]{1,16}")
_FORM = "write minecraft://HOST:PORT, with options as ?version=1.20.4&at=0,160&overwrite=yes"


def is_server(world: str) -> bool:
    """Return True if the name of a world is the address of a Minecraft server."""
    return world.lower().startswith(f"{SCHEME}://")


def overwriting(world: str) -> str:
    """Return a server's address with the permission to replace blocks in the box.

    Raises:
        InputError: The world is not a server.
    """
    if not is_server(world):
        raise InputError(
            f"the world {world!r} is no server; only blocks on a server can be overwritten"
        )
    if ServerAddress.parse(world).overwrite:
        return world
    return f"{world}{'&' if '?' in world else '?'}overwrite=yes"


class ServerAddress(msgspec.Struct, frozen=True):
    """Address of a Minecraft server, with options of playing on it.

    Attributes:
        host: Host name or IP address.
        port: TCP port.
        version: Minecraft version to speak; None to ask the server.
        operator: Name of the bot that sets up and observes the place. It must be an operator.
        at: Position of scenario (0, y, 0) in the server's world: x and z, multiples of 16.
        overwrite: True if blocks in the box that are not the scenario's may be replaced.
        keep: True if the box stays as it is at the end; False: it is restored.
        accounts: Folder with tokens of the Microsoft accounts with which players log in; None if
            the server is in offline mode.
        patience: Seconds to wait for a lost connection or for a server that hangs.
    """

    host: str
    port: int = _PORT
    version: str | None = None
    operator: str = "BeliefNest"
    at: tuple[int, int] = (0, 0)
    overwrite: bool = False
    keep: bool = False
    accounts: str | None = None
    patience: float = 30.0

    @classmethod
    def parse(cls, text: str) -> "ServerAddress":
        """Parse the text of an address.

        Raises:
            InputError: The text is not an address, or an option is unknown or malformed.
        """
        parts = urlsplit(text)
        if parts.username is not None or parts.password is not None:
            raise InputError(
                "the address of a server must not contain a name or password, because every run "
                "would store it; give ?accounts=FOLDER for a server with accounts"
            )
        try:
            host, port = parts.hostname, parts.port
        except ValueError as error:
            raise InputError(f"{text!r} has no valid port: {_FORM}") from error
        if parts.scheme != SCHEME or not host or parts.path not in ("", "/") or parts.fragment:
            raise InputError(f"{text!r} is not the address of a server: {_FORM}")
        options: dict[str, Any] = {}
        for key, value in parse_qsl(parts.query, keep_blank_values=True):
            if key not in _OPTIONS:
                known_options = ", ".join(_OPTIONS)
                raise InputError(
                    f"{text!r} has the unknown option {key!r}; known options are {known_options}"
                )
            if key in options:
                raise InputError(f"{text!r} has the option {key!r} twice; give it once")
            options[key] = _OPTIONS[key](key, value)
        return cls(host, _PORT if port is None else port, **options)

    @property
    def told(self) -> dict[str, Any]:
        """Return the part of the address that the Minecraft side gets."""
        return asdict(self)

    def __str__(self) -> str:
        return f"{SCHEME}://{self.host}:{self.port}"


def _text(key: str, value: str) -> str:
    if not value:
        raise InputError(f"the option {key} is empty: {_FORM}")
    return value


def _name(key: str, value: str) -> str:
    if _NAME.fullmatch(value) is None:
        raise InputError(
            f"the option {key} is {value!r}; a player's name has 1 to 16 letters, digits or _"
        )
    return value


def _yes(key: str, value: str) -> bool:
    if value not in ("yes", "no"):
        raise InputError(f"the option {key} is {value!r}; give yes or no")
    return value == "yes"


def _place(key: str, value: str) -> tuple[int, int]:
    match = re.fullmatch(r"(-?\d{1,8}),(-?\d{1,8})", value)
    if match is not None:
        x, z = int(match[1]), int(match[2])
        if x % _CHUNK == z % _CHUNK == 0 and max(abs(x), abs(z)) <= _FARTHEST:
            return x, z
    raise InputError(
        f"the option {key} is {value!r}; give X,Z, both multiples of {_CHUNK}, as at=0,160"
    )


def _folder(key: str, value: str) -> str:
    return str(Path(_text(key, value)).expanduser().resolve())


def _seconds(key: str, value: str) -> float:
    try:
        seconds = float(value)
    except ValueError:
        seconds = 0.0
    if not 1 <= seconds <= 3600:
        raise InputError(f"the option {key} is {value!r}; give seconds from 1 to 3600")
    return seconds


_OPTIONS = {
    "version": _text,
    "operator": _name,
    "at": _place,
    "overwrite": _yes,
    "keep": _yes,
    "accounts": _folder,
    "patience": _seconds,
}
