"""Minecraft servers for tests: processes that do what a vanilla one does for an operator bot.

`BELIEFNEST_TEST_SERVER=minecraft://HOST:PORT?version=1.21.8` lets tests that need no console play
on a server that runs already, in the middle of its world; `design/servers.md` says which tests.
"""

import json
import os
import signal
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any, Protocol, Self
from urllib.parse import parse_qs, urlsplit

from beliefnest.worlds.minecraft.node_files import node_path

__all__ = ["GameServer", "Served", "given_version", "serving"]

_GIVEN = "BELIEFNEST_TEST_SERVER"
_ROOM = Path(__file__).parents[1] / "src" / "beliefnest" / "worlds" / "minecraft" / "node"


class Served(Protocol):
    """A server that tests may play on."""

    def address(self, **options: str | int) -> str:
        """Return the world's name, with options of the address."""


@contextmanager
def serving(**options: Any) -> Iterator[Served]:
    """Yield a server of our own with these options, or the one that runs already."""
    given = os.environ.get(_GIVEN)
    if given is not None:
        yield _GivenServer(given)
        return
    with GameServer(**options) as running:
        yield running


def given_version() -> list[str]:
    """Return the version of the server that runs already, if there is one."""
    return parse_qs(urlsplit(os.environ.get(_GIVEN, "")).query).get("version", [])


def _with_options(address: str, options: dict[str, str | int]) -> str:
    query = "&".join(f"{key}={value}" for key, value in options.items())
    if query == "":
        return address
    return f"{address}{'&' if '?' in address else '?'}{query}"


class _GivenServer:
    def __init__(self, address: str) -> None:
        self._address = address

    def address(self, **options: str | int) -> str:
        return _with_options(self._address, options)


class GameServer:
    """A running server; see `test/vanilla/server.js` for its options and its console.

    Attributes:
        port: Where it listens, on this machine alone.
    """

    def __init__(self, **options: Any) -> None:
        self._process = subprocess.Popen(
            [node_path(), "test/vanilla/server.js", json.dumps(options)],
            cwd=_ROOM,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        self.port: int = json.loads(self._stream(self._process.stdout).readline())["port"]

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.go_on()
        self._process.kill()
        self._process.communicate()

    def address(self, **options: str | int) -> str:
        """Return the world's name, with options of the address."""
        return _with_options(f"minecraft://127.0.0.1:{self.port}", options)

    def type(self, line: str) -> None:
        """Type a line on its console."""
        stream = self._stream(self._process.stdin)
        stream.write(f"{line}\n")
        stream.flush()

    def kill(self) -> None:
        """End it at once, as a crash does."""
        self._process.kill()
        self._process.wait()

    def freeze(self) -> None:
        """Let it stand still; connections stay open."""
        os.kill(self._process.pid, signal.SIGSTOP)

    def go_on(self) -> None:
        """End a `freeze`."""
        if self._process.poll() is None:
            os.kill(self._process.pid, signal.SIGCONT)

    @staticmethod
    def _stream(stream: IO[str] | None) -> IO[str]:
        assert stream is not None
        return stream
