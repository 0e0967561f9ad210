"""What runs on this side of a nest, for the record."""

import functools
import platform
import sqlite3
from collections.abc import Mapping
from importlib import metadata
from types import MappingProxyType

from beliefnest.version import VERSION

__all__ = ["own_versions"]

_LIBRARIES = ("jinja2", "msgspec", "numba", "numpy", "zstandard")


def own_versions() -> dict[str, str]:
    """Return the program to version of what this process runs; the world adds its own."""
    return {
        "beliefnest": VERSION,
        "python": platform.python_version(),
        "platform": f"{platform.system()} {platform.machine()}",
        "sqlite": sqlite3.sqlite_version,
        **_library_versions(),
    }


@functools.cache
def _library_versions() -> Mapping[str, str]:
    """Looked up in files once: studies begin many runs a second."""
    return MappingProxyType({name: metadata.version(name) for name in _LIBRARIES})
