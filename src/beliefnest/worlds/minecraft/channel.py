"""Python's end of the channel to Node (design/channel.md).

Length-prefixed msgpack over a socket pair. Requests are answered one at a time; frames
arrive before the answer of the request that caused them. Node ends with this process and stays
within its limits.
"""

import contextlib
import os
import resource
import signal
import socket
import struct
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import IO, Any, Self, TypeVar

import msgspec

from beliefnest.errors import BodyError, BodyLostError, InputError, WorldError
from beliefnest.owned import Owned
from beliefnest.world.texts import escaped
from beliefnest.worlds.process_limits import ProcessLimits

_STDERR_LINES = 15
_STDERR_BYTES = 1 << 16
_GRACE_SECONDS = 2.0
_MEGABYTE = 1 << 20

_HEAP_FULL = "JavaScript heap out of memory"
_HEAP_ADVICE = (
    f"{_HEAP_FULL}. Make the box smaller, or allow more with "
    "`limits=bn.ProcessLimits(heap=MEGABYTES)`"
)

# With the caller's environment the process would know its keys and obey NODE_OPTIONS.
_ENVIRONMENT = {"TZ": "UTC"}


class _Child(Owned):
    """Running process; made by `Child.start`.

    In a fork of the process that started it, the child counts as ended; the fork can neither end it
    nor keep it alive.
    """

    def __init__(
        self, process: "subprocess.Popen[bytes]", lifeline: int, stderr: IO[bytes]
    ) -> None:
        super().__init__()
        self._process = process
        self._lifeline: int | None = lifeline
        self._stderr = stderr

    @classmethod
    def start(cls, command: Sequence[str], descriptor: int, limits: ProcessLimits) -> Self:
        """Start a process.

        Args:
            command: The program and its arguments. The numbers of two descriptors are appended: the
                inherited one, and the lifeline, whose closing ends the process.
            descriptor: Descriptor that the process inherits.
            limits: Limits of the process.

        Raises:
            BodyError: The program could not be started.
        """
        life_read, life_write = os.pipe()
        stderr: IO[bytes] = tempfile.TemporaryFile()  # noqa: SIM115 - closed with the child
        try:
            process = subprocess.Popen(
                [*command, str(descriptor), str(life_read)],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=stderr,
                env=_ENVIRONMENT,
                pass_fds=(descriptor, life_read),
                # Python handles Ctrl-C: it ends the child by closing the lifeline.
                start_new_session=True,
            )
        except OSError as error:
            os.close(life_write)
            stderr.close()
            raise BodyError(
                f"cannot start {command[0]}: {error.strerror}; run `beliefnest doctor`"
            ) from error
        finally:
            os.close(life_read)
        _limit(process.pid, limits)
        return cls(process, life_write, stderr)

    @property
    def pid(self) -> int:
        """Process id."""
        return self._process.pid

    @property
    def alive(self) -> bool:
        """True if the process runs and belongs to this process."""
        return self.is_own and self._process.poll() is None

    def ends(self) -> bool:
        """Wait a moment for the end of the process; return True if it has ended."""
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(timeout=_GRACE_SECONDS)
        return not self.alive

    def kill(self) -> None:
        """Kill the process at once, unless it has ended."""
        if not self.is_own:
            return
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self._process.pid, signal.SIGKILL)
        self._process.wait()

    def close(self) -> None:
        """End the process by its lifeline; a second call does nothing."""
        if self._lifeline is None or not self.is_own:
            return
        os.close(self._lifeline)
        self._lifeline = None
        if not self.ends():
            self.kill()
        self._stderr.close()

    def disown(self) -> None:
        """Close the lifeline in a forked child, so that only the parent keeps the process alive."""
        if self._lifeline is not None:
            os.close(self._lifeline)
            self._lifeline = None

    def obituary(self) -> tuple[str, str]:
        """Return how an ended process ended, and its last lines of output, if any.

        Advice takes the place of the stack trace of a process that ran out of memory.
        """
        status = self._process.returncode
        how = f"with status {status}" if status >= 0 else f"by signal {-status} ({_name(-status)})"
        self._stderr.seek(0, os.SEEK_END)
        self._stderr.seek(max(self._stderr.tell() - _STDERR_BYTES, 0))
        text = self._stderr.read().decode(errors="replace").strip()
        if _HEAP_FULL in text:
            return how, _HEAP_ADVICE
        lines = text.splitlines()
        return how, "\n".join(lines[-_STDERR_LINES:])


def _name(number: int) -> str:
    try:
        return signal.Signals(number).name
    except ValueError:
        return "unknown"


def _limit(pid: int, limits: ProcessLimits) -> None:
    """Apply the limits that the operating system can enforce from outside."""
    if sys.platform != "linux":
        return
    memory = limits.memory * _MEGABYTE
    with contextlib.suppress(ProcessLookupError):
        # An ordinary user may not raise a hard limit that the shell has set.
        soft, hard = (
            memory if most == resource.RLIM_INFINITY else min(memory, most)
            for most in resource.prlimit(pid, resource.RLIMIT_DATA)
        )
        resource.prlimit(pid, resource.RLIMIT_DATA, (soft, hard))
        resource.prlimit(pid, resource.RLIMIT_CORE, (0, 0))


PROTOCOL = 6
"""Version of the channel's messages; both sides state it."""

_HEADER = struct.Struct(">I")
_MAX_MESSAGE = 1 << 30
_WAIT_SECONDS = 1.0

FrameHandler = Callable[[dict[str, Any]], None]
PerceptsHandler = Callable[[], dict[str, Any]]
A = TypeVar("A")
T = TypeVar("T")


class _BrokenError(Exception):
    """Failure of Node to follow the protocol, or to answer at all."""


class Channel(Owned):
    """Running Node process and the socket to it; made by `Channel.start`.

    A forked child of this process cannot use the channel: `request` and `post` raise ForkedError.
    """

    def __init__(self, child: _Child, connection: socket.socket, silence: float) -> None:
        super().__init__()
        self._child = child
        self._connection = connection
        self._silence = silence
        self._wait = min(_WAIT_SECONDS, silence)
        connection.settimeout(self._wait)
        self._number = 0
        self._op = ""
        self._tick: int | None = None
        self._closed = False

    @classmethod
    def start(cls, command: Sequence[str], limits: ProcessLimits | None = None) -> Self:
        """Start a process that speaks the channel's protocol.

        Args:
            command: The program and its arguments; the numbers of the two descriptors are appended.
            limits: Limits of the process.

        Raises:
            BodyError: The program could not be started.
        """
        limits = limits or ProcessLimits()
        ours, theirs = socket.socketpair()
        try:
            child = _Child.start(command, theirs.fileno(), limits)
        except BaseException:
            ours.close()
            raise
        finally:
            theirs.close()
        return cls(child, ours, limits.silence)

    @property
    def pid(self) -> int:
        """Process id of Node."""
        return self._child.pid

    @property
    def lost(self) -> bool:
        """True if Node has ended and will answer nothing more."""
        return not self._child.alive

    def request(
        self,
        op: str,
        on_frame: FrameHandler | None = None,
        percepts: PerceptsHandler | None = None,
        **arguments: Any,
    ) -> Any:
        """Send a request and return its result; frames that arrive before it go to `on_frame`.

        If Node asks for the agents' present percepts, `percepts` answers.

        Raises:
            InputError: A text of the request contains half a character and cannot be sent.
            WorldError: Node refused the request as impossible.
            BodyLostError: Node ended or had to be killed; the message contains its last output.
            BodyError: Node failed to fulfil the request.
        """
        self.begin(op, **arguments)
        return self.finish(on_frame, percepts)

    def begin(self, op: str, **arguments: Any) -> None:
        """Send a request; `finish` waits for its answer. No other request may come between.

        Raises:
            InputError: A text of the request contains half a character and cannot be sent.
            BodyLostError: Node ended or had to be killed.
        """
        self.check_own("the Minecraft side")
        if self._closed:
            raise BodyError(f"the world was closed and cannot do {op!r} any more; open another one")
        message = _encoded(op, {"id": self._number + 1, "op": op, **arguments})
        self._number += 1
        self._op = op
        self._tick = None
        with self._watched(op):
            self._send(message)

    def finish(
        self, on_frame: FrameHandler | None = None, percepts: PerceptsHandler | None = None
    ) -> Any:
        """Return the result of the request that was begun; arguments and errors as in `request`."""
        self.check_own("the Minecraft side")
        with self._watched(self._op):
            answer, refused = self._answer(on_frame, percepts)
        if refused is not None:
            raise refused
        return _result(self._op, answer)

    @contextmanager
    def _watched(self, op: str) -> Iterator[None]:
        """Turn a failure of the connection into the error that says how Node ended."""
        try:
            yield
        except (OSError, EOFError) as error:
            raise self._lost(op) from error
        except _BrokenError as error:
            raise self._lost(op, str(error)) from error
        except BaseException:
            # Kill Node: its late answer would be taken for that of the next request.
            self._child.kill()
            raise

    def post(self, op: str, **arguments: Any) -> None:
        """Send a message that has no answer; this is possible during a request.

        Raises:
            BodyLostError: Node accepts nothing any more and was killed. If it had ended before, the
                next request raises the error.
        """
        self.check_own("the Minecraft side")
        try:
            self._send(_packed({"op": op, **arguments}))
        except _BrokenError as error:
            raise self._lost(op, str(error)) from error
        except OSError:
            return

    def kill(self) -> None:
        """Kill the process at once."""
        self._child.kill()

    def close(self) -> None:
        """End the process without waiting for its last requests."""
        self._closed = True
        self._connection.close()
        self._child.close()

    def disown(self) -> None:
        """Close the socket in a forked child; the parent's copy stays open."""
        self._connection.close()

    def _answer(
        self, on_frame: FrameHandler | None, percepts: PerceptsHandler | None
    ) -> tuple[dict[str, Any], Exception | None]:
        """Return the answer to a request, and the error of handling a frame or question before it.

        Frames are read to the end in any case, so that the next request finds its own answer.
        """
        refused: Exception | None = None
        while True:
            message = self._receive()
            if "beat" in message or "notice" in message:
                self._note(message)
            elif "frame" in message:
                if on_frame is None:
                    raise _BrokenError("sent a frame of its own accord")
                self._tick = message["frame"]["tick"]
                if refused is None:
                    try:
                        on_frame(message["frame"])
                    except Exception as error:  # noqa: BLE001 - raised again after the answer
                        refused = error
            elif "perceive" in message:
                if percepts is None:
                    raise _BrokenError("asked for percepts in a request without any")
                answer = None
                if refused is None:
                    try:
                        answer = percepts()
                    except Exception as error:  # noqa: BLE001 - raised again after the answer
                        refused = error
                self._send(_packed({"percepts": answer}))
            elif message.get("id") == self._number:
                return message, refused
            else:
                raise _BrokenError(f"answered request {message.get('id')}, not {self._number}")

    def _note(self, message: dict[str, Any]) -> None:
        """Handle a heartbeat, or show the user a text from Node."""
        if "notice" in message:
            sys.stderr.write(f"{escaped(message['notice'])}\n")
        elif message["beat"] is not None:
            self._tick = message["beat"]

    def _send(self, message: bytes) -> None:
        rest = memoryview(message)
        while rest:
            rest = rest[self._patiently(self._connection.send, rest) :]

    def _receive(self) -> dict[str, Any]:
        (length,) = _HEADER.unpack(self._read(_HEADER.size))
        if length > _MAX_MESSAGE:
            raise _BrokenError(f"announced a message of {length} bytes")
        try:
            message = msgspec.msgpack.decode(self._read(length), type=dict[str, Any])
        except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError) as error:
            raise _BrokenError(f"sent {length} bytes that are no message ({error})") from error
        return message

    def _read(self, length: int) -> bytes:
        parts = bytearray()
        while len(parts) < length:
            wanted = min(length - len(parts), 1 << 20)
            part = self._patiently(self._connection.recv, wanted)
            if not part:
                raise EOFError
            parts += part
        return bytes(parts)

    def _patiently(self, act: Callable[[A], T], argument: A) -> T:
        """Read or write as soon as that is possible.

        The method counts short waits instead of reading the clock, because time in which this
        process itself was stopped is not Node's silence.
        """
        waited = 0.0
        while True:
            try:
                return act(argument)
            except TimeoutError:
                waited += self._wait
                if waited >= self._silence:
                    raise _BrokenError(f"gave no sign of life for {self._silence:g} s") from None

    def _lost(self, op: str, fault: str | None = None) -> BodyLostError:
        """Return the error for a Node that ended by itself, or that is killed for a fault."""
        if fault is not None:
            self._child.kill()
        elif not self._child.ends():
            fault = "closed the channel"
            self._child.kill()
        how, words = self._child.obituary()
        ended = f"ended {how}" if fault is None else f"{fault} and was killed"
        when = f"during {op!r}" if self._tick is None else f"during {op!r}, after tick {self._tick}"
        last_words = f"; its last words:\n{words}" if words else "; it said nothing"
        return BodyLostError(f"Node {ended} {when}{last_words}")


def _packed(message: dict[str, Any]) -> bytes:
    body = msgspec.msgpack.encode(message)
    return _HEADER.pack(len(body)) + body


def _encoded(op: str, message: dict[str, Any]) -> bytes:
    try:
        return _packed(message)
    except UnicodeEncodeError as error:
        half = error.object[error.start]
        raise InputError(
            f"a text in the request {op!r} contains half a character ({half!a}); "
            "give whole characters"
        ) from error


def _result(op: str, answer: dict[str, Any]) -> Any:
    if answer["ok"]:
        return answer.get("result")
    error = answer["error"]
    if error["kind"] == "bad_request":
        raise WorldError(error["message"])
    if error["kind"] == "world":
        raise BodyError(error["message"])
    stack = error.get("stack", "")
    raise BodyError(f"the Minecraft side failed in {op!r}: {error['message']}\n{stack}".rstrip())
