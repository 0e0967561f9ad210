"""Limits that every reader keeps: 10 s, 500 MB, status 0 or 2, and one line of 400 characters."""

import os
import resource
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

__all__ = ["LONGEST", "MEGABYTES", "SECONDS", "ends_well"]

SECONDS = 10
MEGABYTES = 500
LONGEST = 400


def _limit() -> None:
    # Processor time: other processes of the machine do not count.
    resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS))


def ends_well(arguments: Sequence[str], folder: Path) -> str:
    """Run a command in a process of its own and return its error line, which may be empty.

    Raises:
        AssertionError: It does not end as `limits` says.
    """
    command = [sys.executable, "-m", "beliefnest", *arguments]
    with subprocess.Popen(
        command,
        cwd=folder,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        preexec_fn=_limit,  # noqa: PLW1509  # the tests start no threads
    ) as process:
        assert process.stderr is not None
        told = process.stderr.read().decode(errors="replace")
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    assert process.returncode in (0, 2), (process.returncode, told[-2000:])
    assert "Traceback" not in told
    assert used.ru_maxrss < MEGABYTES * 1000, used.ru_maxrss
    lines = [line for line in told.splitlines() if line.startswith("beliefnest: ")]
    assert len(lines) == (process.returncode == 2), told
    assert all(len(line) <= LONGEST for line in lines)
    return lines[0] if lines else ""
