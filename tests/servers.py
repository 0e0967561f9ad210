"""Minecraft servers for tests: processes that do what a vanilla one does for an operator bot."""

import json
import os
import signal
import subprocess
from pathlib import Path
from typing import IO, Any, Self

from beliefnest.bodies.node_files import node_path

__all__ = ["GameServer"]

_ROOM = Path(__file__).parents[1] / "src" / "beliefnest" / "bodies" / "node"


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
        """The world's name, with options of the address."""
        query = "&".join(f"{key}={value}" for key, value in options.items())
        return f"minecraft://127.0.0.1:{self.port}" + (f"?{query}" if query else "")

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
