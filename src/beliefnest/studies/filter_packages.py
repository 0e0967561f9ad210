"""Packages of installed prompt filters, as files of a supplement.

They stand in a folder from which Python finds them, also as entry points, if `PYTHONPATH` names it.
"""

import importlib.util
from collections.abc import Iterator, Sequence
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path

from beliefnest.prompts.filterset import FILTER_GROUP

PACKAGES = "packages"
"""Folder of the packages in a supplement."""

_INFO = f"{PACKAGES}/filters_of_this_supplement-1.dist-info"
_METADATA = b"Metadata-Version: 2.1\nName: filters-of-this-supplement\nVersion: 1\n"


def filter_packages() -> dict[str, bytes]:
    """Return the files of all packages with installed filters, by path; empty: there are none."""
    entries = sorted(entry_points(group=FILTER_GROUP), key=lambda each: (each.name, each.value))
    if not entries:
        return {}
    files = {
        f"{PACKAGES}/{path}": content
        for package in sorted({entry.module.partition(".")[0] for entry in entries})
        for path, content in _sources(package)
    }
    return files | {
        f"{_INFO}/METADATA": _METADATA,
        f"{_INFO}/entry_points.txt": _declared(entries).encode(),
    }


def _sources(package: str) -> Iterator[tuple[str, bytes]]:
    """Yield the Python files of a top-level package or module, by path."""
    spec = importlib.util.find_spec(package)
    if spec is None:
        return
    for place in spec.submodule_search_locations or ():
        folder = Path(place)
        for file in sorted(folder.rglob("*.py")):
            yield f"{package}/{file.relative_to(folder).as_posix()}", file.read_bytes()
    if spec.submodule_search_locations is None and spec.origin is not None:
        yield f"{package}.py", Path(spec.origin).read_bytes()


def _declared(entries: Sequence[EntryPoint]) -> str:
    lines = dict.fromkeys(f"{entry.name} = {entry.value}" for entry in entries)
    return "\n".join([f"[{FILTER_GROUP}]", *lines, ""])
