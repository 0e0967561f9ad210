"""Limits that every reader keeps: 10 s, 500 MB, status 0 or 2, and one line of 400 characters."""

import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

__all__ = ["LONGEST", "MEGABYTES", "SECONDS", "ends_well"]

SECONDS = 10
MEGABYTES = 500
LONGEST = 400


# A child begins with the peak memory of the process that starts it: start it from a small one.
_MEASURED = f"""
import resource, subprocess, sys
# Processor time: other processes of the machine do not count.
resource.setrlimit(resource.RLIMIT_CPU, ({SECONDS}, {SECONDS}))
status = subprocess.call(sys.argv[1:], stdout=subprocess.DEVNULL)
print(status, resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)
"""


def ends_well(arguments: Sequence[str], folder: Path) -> str:
    """Run a command in a process of its own and return its error line, which may be empty.

    Raises:
        AssertionError: It does not end as `limits` says.
    """
    command = [sys.executable, "-m", "beliefnest", *arguments]
    done = subprocess.run(
        [sys.executable, "-c", _MEASURED, *command], cwd=folder, capture_output=True, check=True
    )
    told = done.stderr.decode(errors="replace")
    status, kilobytes = map(int, done.stdout.split())
    assert status in (0, 2), (status, told[-2000:])
    assert "Traceback" not in told
    assert kilobytes < MEGABYTES * 1000, kilobytes
    lines = [line for line in told.splitlines() if line.startswith("beliefnest: ")]
    assert len(lines) == (status == 2), told
    assert all(len(line) <= LONGEST for line in lines)
    return lines[0] if lines else ""
