"""Versions of the programs that this process runs, for run files."""

import functools
import platform
import sqlite3
from collections.abc import Mapping
from importlib import metadata
from types import MappingProxyType

from beliefnest.version import VERSION
from beliefnest.world.compression import ZSTD_VERSION

_LIBRARIES = ("jinja2", "msgspec", "numba", "numpy")


def own_versions() -> dict[str, str]:
    """Return versions by program name for this process. The world adds its own."""
    return {
        "beliefnest": VERSION,
        "python": platform.python_version(),
        "platform": f"{platform.system()} {platform.machine()}",
        "sqlite": sqlite3.sqlite_version,
        "zstd": ZSTD_VERSION,
        **_library_versions(),
    }


@functools.cache
def _library_versions() -> Mapping[str, str]:
    """Return versions of libraries, looked up once: studies begin many runs a second."""
    return MappingProxyType({name: metadata.version(name) for name in _LIBRARIES})
