"""People for tests: processes with a Minecraft client that do as they are told."""

import json
import queue
import subprocess
import threading
from pathlib import Path
from typing import IO, Any, Self

from tests.servers import given_version

from beliefnest.worlds.minecraft.node_files import node_path

__all__ = ["Person"]

_ROOM = Path(__file__).parents[1] / "src" / "beliefnest" / "worlds" / "minecraft" / "node"
_LIMIT_S = 120


class Person:
    """Somebody who joins; see `test/people/person.js`.

    Their client is of the version that the address of a server under test names.

    Attributes:
        read: What they were told in the game.
    """

    def __init__(self, address: str | None, name: str) -> None:
        assert address is not None
        version = given_version()
        self._process = subprocess.Popen(
            [node_path(), "test/people/person.js", address.rpartition(":")[2], name, *version],
            cwd=_ROOM,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        self.read: list[str] = []
        self._told: queue.Queue[dict[str, Any]] = queue.Queue()
        self._asked = self._done = 0
        self._listening = threading.Thread(target=self._listen, daemon=True)
        self._listening.start()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._process.kill()
        self._process.wait()
        self._listening.join()
        for stream in (self._process.stdin, self._process.stdout):
            self._stream(stream).close()

    def does(self, program: str) -> None:
        """Let them begin to do something, as a program's text says."""
        stream = self._stream(self._process.stdin)
        stream.write(json.dumps(program) + "\n")
        stream.flush()
        self._asked += 1

    @property
    def is_done(self) -> bool:
        """Return True if they have done all their tasks; raise the error of a failed one."""
        while not self._told.empty():
            self._note(self._told.get())
        return self._done == self._asked

    def finish(self) -> None:
        """Wait until they have done all their tasks; raise the error of a failed one."""
        while self._done < self._asked:
            self._note(self._told.get(timeout=_LIMIT_S))

    def _note(self, told: dict[str, Any]) -> None:
        assert "failed" not in told and "left" not in told, told
        self._done += "done" in told

    def leave(self) -> None:
        """Let them do what they were told, and go."""
        self._stream(self._process.stdin).close()
        self.left()

    def left(self) -> str:
        """Wait until they are no longer there; why."""
        while "left" not in (told := self._told.get(timeout=_LIMIT_S)):
            assert "failed" not in told, told
        return str(told["left"])

    def _listen(self) -> None:
        for line in self._stream(self._process.stdout):
            told = json.loads(line)
            if "read" in told:
                self.read.append(told["read"])
            else:
                self._told.put(told)

    @staticmethod
    def _stream(stream: IO[str] | None) -> IO[str]:
        assert stream is not None
        return stream
