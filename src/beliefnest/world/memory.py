"""Greatest memory of this process, as the machine, its container or the shell limits it."""

import functools
import os
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

MEGABYTE = 1_000_000


class MemoryLimit(NamedTuple):
    """Greatest memory of this process.

    Attributes:
        bytes: The number of bytes.
        source: Name of what sets the limit, for messages.
    """

    bytes: int
    source: str


@functools.cache
def memory_limit(root: Path = Path("/")) -> MemoryLimit | None:
    """Return the lowest limit of this process's memory; None: the system tells none.

    Free memory is not considered, so that the answer is the same at any time. Swap counts as memory
    of the machine and of a container.

    Args:
        root: Folder with `proc` and `sys`.
    """
    swap = _swap(root)
    limits = [
        *_machine(swap),
        *(MemoryLimit(size + swap, "its container's limit") for size in _cgroups(root)),
        *_shell(),
    ]
    return min(limits, default=None)


def _machine(swap: int) -> Iterator[MemoryLimit]:
    names = getattr(os, "sysconf_names", {})
    if "SC_PHYS_PAGES" in names and "SC_PAGE_SIZE" in names:
        pages, size = os.sysconf("SC_PHYS_PAGES"), os.sysconf("SC_PAGE_SIZE")
        if pages > 0 and size > 0:
            yield MemoryLimit(pages * size + swap, "the memory of this machine")


def _shell() -> Iterator[MemoryLimit]:
    """Yield limits of the kind that `ulimit` sets."""
    try:
        import resource
    except ImportError:  # Windows has none.
        return
    kinds = ((resource.RLIMIT_AS, "ulimit -v"), (resource.RLIMIT_DATA, "ulimit -d"))
    for kind, command in kinds:
        most, _ = resource.getrlimit(kind)
        if most != resource.RLIM_INFINITY:
            yield MemoryLimit(most, f"its limit of '{command}'")


def _swap(root: Path) -> int:
    """Return the bytes of swap space; 0 where the system does not tell."""
    for line in _text(root / "proc/meminfo").splitlines():
        if line.startswith("SwapTotal:"):
            return int(line.split()[1]) * 1024
    return 0


def _cgroups(root: Path) -> Iterator[int]:
    """Yield the limits of the control groups of this process, versions 1 and 2, and above them."""
    for line in _text(root / "proc/self/cgroup").splitlines():
        number, kinds, place = line.split(":", 2)
        if number == "0" and not kinds:
            folder, file = root / "sys/fs/cgroup", "memory.max"
        elif "memory" in kinds.split(","):
            folder, file = root / "sys/fs/cgroup/memory", "memory.limit_in_bytes"
        else:
            continue
        # In a container the path may be that outside it; the container's own group is then the
        # uppermost folder.
        here = Path(place.lstrip("/"))
        for group in (here, *here.parents):
            text = _text(folder / group / file).strip()
            if text.isdecimal():
                yield int(text)


def _text(file: Path) -> str:
    try:
        return file.read_text(encoding="utf-8", errors="replace")
    except OSError:
        return ""
