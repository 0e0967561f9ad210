"""Child process that ends with this one and stays within its limits."""

import contextlib
import os
import resource
import signal
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from typing import IO, Self

from beliefnest.errors import BodyError
from beliefnest.owned import Owned
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


class Child(Owned):
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
