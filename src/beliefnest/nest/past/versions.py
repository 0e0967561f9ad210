"""What runs on this side of a nest, for the record."""

import platform
import sqlite3
from importlib import metadata

from beliefnest.version import VERSION

__all__ = ["own_versions"]

_LIBRARIES = ("jinja2", "msgspec", "numba", "numpy", "zstandard")


def own_versions() -> dict[str, str]:
    """Program to version of what this process runs; the world adds its own."""
    return {
        "beliefnest": VERSION,
        "python": platform.python_version(),
        "platform": f"{platform.system()} {platform.machine()}",
        "sqlite": sqlite3.sqlite_version,
        **{name: metadata.version(name) for name in _LIBRARIES},
    }
