"""Limits of the kind that `ulimit` sets, below which Node or threads do not start."""

import sys
import threading
from collections.abc import Iterator

# Measured with Node 24 on Linux; a limit may be a little higher and still be too low.
_NEEDS = (
    ("RLIMIT_AS", "-v", 2_500_000, 1024),
    ("RLIMIT_DATA", "-d", 1_500_000, 1024),
    ("RLIMIT_NOFILE", "-n", 64, 1),
    ("RLIMIT_NPROC", "-u", 64, 1),
)
"""Names of limits, options of `ulimit`, needed values in its units, and bytes of a unit."""


def low_limits() -> str | None:
    """Return a message on the limits that are too low, with what to do; None: none is.

    The number of processes (`ulimit -u`) counts all that the user runs. It is named if it is low or
    if no thread can be started now.
    """
    limits = list(_low())
    if not limits and not _threads_start():
        limits.append(f"no further thread can be started ('ulimit -u' is {_value('RLIMIT_NPROC')})")
    if not limits:
        return None
    return f"{' and '.join(limits)}; raise the limit in this shell, or ask who set it"


def _low() -> Iterator[str]:
    if sys.platform == "win32":
        return
    import resource

    for name, option, needed, unit in _NEEDS:
        most, _ = resource.getrlimit(getattr(resource, name))
        if most != resource.RLIM_INFINITY and most < needed * unit:
            yield f"'ulimit {option}' is {most // unit:,}, and about {needed:,} are needed"


def _value(name: str) -> str:
    if sys.platform == "win32":
        return "unknown"
    import resource

    most, _ = resource.getrlimit(getattr(resource, name))
    return "unlimited" if most == resource.RLIM_INFINITY else str(most)


def _threads_start() -> bool:
    thread = threading.Thread(target=lambda: None)
    try:
        thread.start()
    except RuntimeError:
        return False
    thread.join()
    return True
