"""Limits of memory, read from the files and calls of the system."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from beliefnest.world.memory import memory_limit

_HUGE = 1 << 60


def _system(root: Path, cgroup: str, limits: dict[str, int | str], swap_kb: int = 0) -> Path:
    """Write a `proc` and a `sys` with limits by the path of their files, and return their root."""
    (root / "proc/self").mkdir(parents=True)
    (root / "proc/meminfo").write_text(f"MemTotal: 1 kB\nSwapTotal: {swap_kb} kB\n")
    (root / "proc/self/cgroup").write_text(cgroup)
    for file, value in limits.items():
        (root / file).parent.mkdir(parents=True, exist_ok=True)
        (root / file).write_text(f"{value}\n")
    return root


@pytest.mark.parametrize(
    ("cgroup", "limits"),
    [
        ("0::/a/b\n", {"sys/fs/cgroup/a/b/memory.max": "max", "sys/fs/cgroup/a/memory.max": 5000}),
        ("0::/elsewhere\n", {"sys/fs/cgroup/memory.max": 5000}),
        ("4:cpu:/\n3:memory:/a\n", {"sys/fs/cgroup/memory/a/memory.limit_in_bytes": 5000}),
        ("3:memory:/out\n", {"sys/fs/cgroup/memory/memory.limit_in_bytes": 5000}),
    ],
    ids=["v2 above", "v2 in a container", "v1", "v1 in a container"],
)
def test_a_containers_limit_counts(
    tmp_path: Path, cgroup: str, limits: dict[str, int | str]
) -> None:
    """The lowest limit of the group and of the groups above it holds."""
    found = memory_limit(_system(tmp_path, cgroup, limits))
    assert found is not None
    assert (found.bytes, found.source) == (5000, "its container's limit")


def test_swap_is_added(tmp_path: Path) -> None:
    """Swap counts as memory, so that nothing is refused that can work."""
    root = _system(tmp_path, "0::/\n", {"sys/fs/cgroup/memory.max": 5000}, swap_kb=2)
    found = memory_limit(root)
    assert found is not None
    assert found.bytes == 5000 + 2048


def test_a_group_without_a_limit_leaves_the_machines(tmp_path: Path) -> None:
    """Version 1 writes a huge number for no limit."""
    limits: dict[str, int | str] = {"sys/fs/cgroup/memory/memory.limit_in_bytes": _HUGE}
    found = memory_limit(_system(tmp_path, "3:memory:/\n", limits))
    assert found is not None
    assert found.bytes == os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")


def test_the_shells_limit_counts() -> None:
    """A limit of `ulimit -v` is found, and named."""
    code = (
        "import resource; from beliefnest.world.memory import memory_limit;"
        "resource.setrlimit(resource.RLIMIT_AS, (10**9, 10**9)); print(*memory_limit())"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "1000000000 its limit of 'ulimit -v'"
