"""Peak memory of this process."""

import re
import resource
import sys
from pathlib import Path

__all__ = ["megabytes", "peak_megabytes"]

_STATUS = Path("/proc/self/status")


def peak_megabytes() -> float:
    """Return the most memory that this process has held at once, in MB (10^6 bytes).

    On Linux `ru_maxrss` of a started process begins with what its parent held, so the kernel's
    own account of the process is read there.
    """
    if _STATUS.is_file():
        peak = re.search(r"VmHWM:\s+(\d+) kB", _STATUS.read_text(encoding="ascii"))
        if peak is not None:
            return int(peak[1]) * 1024 / 1e6
    unit = 1e6 if sys.platform == "darwin" else 1e3
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / unit


def megabytes() -> float:
    """Return the memory that this process holds now, in MB (10^6 bytes).

    Where the system does not tell, return the most that it has held.
    """
    if _STATUS.is_file():
        held = re.search(r"VmRSS:\s+(\d+) kB", _STATUS.read_text(encoding="ascii"))
        if held is not None:
            return int(held[1]) * 1024 / 1e6
    return peak_megabytes()
