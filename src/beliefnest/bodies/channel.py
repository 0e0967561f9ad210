"""Python's end of the channel to Node (design/channel.md).

Length-prefixed msgpack over a socket pair. Requests are answered one at a time; frames
arrive before the answer of the request that caused them.
"""

import contextlib
import os
import signal
import socket
import struct
import subprocess
import tempfile
from collections.abc import Callable
from typing import IO, Any, Self

import msgspec

from beliefnest.errors import BodyError, WorldError

__all__ = ["PROTOCOL", "Channel"]

PROTOCOL = 1
"""Version of the channel's messages; both sides state it."""

_HEADER = struct.Struct(">I")
_STDERR_LINES = 15
_GRACE_SECONDS = 2.0

FrameHandler = Callable[[dict[str, Any]], None]


class Channel:
    """A running Node process and the socket to it; make one with `Channel.start`."""

    def __init__(
        self,
        process: "subprocess.Popen[bytes]",
        connection: socket.socket,
        lifeline: int,
        stderr: IO[bytes],
    ) -> None:
        self._process = process
        self._connection = connection
        self._lifeline: int | None = lifeline
        self._stderr = stderr
        self._number = 0
        self._unanswered: str | None = None

    @classmethod
    def start(cls, command: list[str]) -> Self:
        """Start a process that speaks the channel's protocol.

        Args:
            command: The program and its arguments; the numbers of the two descriptors
                are appended to them.

        Raises:
            BodyError: The program could not be started.
        """
        ours, theirs = socket.socketpair()
        life_read, life_write = os.pipe()
        stderr: IO[bytes] = tempfile.TemporaryFile()  # noqa: SIM115 - closed with the channel
        try:
            process = subprocess.Popen(
                [*command, str(theirs.fileno()), str(life_read)],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=stderr,
                pass_fds=(theirs.fileno(), life_read),
                # Ctrl-C is Python's to handle: it ends Node by closing the lifeline.
                start_new_session=True,
            )
        except OSError as error:
            ours.close()
            os.close(life_write)
            stderr.close()
            raise BodyError(
                f"cannot start {command[0]}: {error.strerror}; run `beliefnest doctor`"
            ) from error
        finally:
            theirs.close()
            os.close(life_read)
        return cls(process, ours, life_write, stderr)

    @property
    def pid(self) -> int:
        """Process id of Node."""
        return self._process.pid

    def request(self, op: str, on_frame: FrameHandler | None = None, **arguments: Any) -> Any:
        """Send a request and return its result; frames on the way go to `on_frame`.

        Raises:
            WorldError: Node refused the request as impossible.
            BodyError: Node failed, or is gone; the message carries its last words.
        """
        if self._unanswered is not None:
            raise BodyError(
                f"{self._unanswered!r} was interrupted before Node had answered; "
                f"this world cannot be asked for {op!r} any more"
            )
        self._number += 1
        message = msgspec.msgpack.encode({"id": self._number, "op": op, **arguments})
        self._unanswered = op
        try:
            self._connection.sendall(_HEADER.pack(len(message)) + message)
            answer, refused = self._answer(op, on_frame)
        except (OSError, EOFError) as error:
            raise BodyError(self._death_notice(op)) from error
        self._unanswered = None
        if refused is not None:
            raise refused
        return self._result(op, answer)

    def _answer(
        self, op: str, on_frame: FrameHandler | None
    ) -> tuple[dict[str, Any], Exception | None]:
        """The answer to a request, and why a frame before it could not be taken.

        Frames are read to the end all the same, so that the next request finds its answer.
        """
        refused: Exception | None = None
        while True:
            answer = self._receive()
            if "frame" not in answer:
                return answer, refused
            if on_frame is None:
                raise BodyError(f"Node sent a frame during {op!r}, which makes none")
            if refused is None:
                try:
                    on_frame(answer["frame"])
                except Exception as error:  # noqa: BLE001 - raised again after the answer
                    refused = error

    def close(self) -> None:
        """End the process; its last requests are not waited for."""
        if self._lifeline is None:
            return
        os.close(self._lifeline)
        self._lifeline = None
        self._connection.close()
        try:
            self._process.wait(timeout=_GRACE_SECONDS)
        except subprocess.TimeoutExpired:
            self.kill()
        self._stderr.close()

    def kill(self) -> None:
        """End the process at once."""
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self._process.pid, signal.SIGKILL)
        self._process.wait()

    def _receive(self) -> dict[str, Any]:
        (length,) = _HEADER.unpack(self._read(_HEADER.size))
        try:
            answer = msgspec.msgpack.decode(self._read(length), type=dict[str, Any])
        except msgspec.MsgspecError as error:
            raise BodyError(f"Node sent {length} bytes that are no message: {error}") from error
        return answer

    def _read(self, length: int) -> bytes:
        parts = bytearray()
        while len(parts) < length:
            part = self._connection.recv(min(length - len(parts), 1 << 20))
            if not part:
                raise EOFError
            parts += part
        return bytes(parts)

    def _result(self, op: str, answer: dict[str, Any]) -> Any:
        if answer.get("id") != self._number:
            raise BodyError(f"Node answered request {answer.get('id')}, not {self._number} ({op})")
        if answer["ok"]:
            return answer.get("result")
        error = answer["error"]
        if error["kind"] == "bad_request":
            raise WorldError(error["message"])
        stack = error.get("stack", "")
        raise BodyError(
            f"the Minecraft side failed in {op!r}: {error['message']}\n{stack}".rstrip()
        )

    def _death_notice(self, op: str) -> str:
        self.kill()
        status = self._process.returncode
        how = f"signal {-status}" if status < 0 else f"status {status}"
        self._stderr.seek(0)
        lines = self._stderr.read().decode(errors="replace").strip().splitlines()
        last = "\n".join(lines[-_STDERR_LINES:])
        words = f"; its last words:\n{last}" if last else "; it said nothing"
        return f"Node ended with {how} during {op!r}{words}"
