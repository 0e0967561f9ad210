"""Packages of others with filters, policies, tasks and worlds, as files of a supplement.

They stand in a folder from which Python finds them, also as entry points, if `PYTHONPATH` names it.
"""

import importlib.util
from collections.abc import Iterator, Sequence
from importlib.metadata import EntryPoint
from itertools import groupby
from pathlib import Path

from beliefnest.importing import installed_entries

PACKAGES = "packages"
"""Folder of the packages in a supplement."""

_INFO = f"{PACKAGES}/filters_of_this_supplement-1.dist-info"
_GROUPS = tuple(f"beliefnest.{what}" for what in ("filters", "policies", "tasks", "worlds"))
"""Groups of entry points on which the cells of a study may depend."""
_METADATA = b"Metadata-Version: 2.1\nName: filters-of-this-supplement\nVersion: 1\n"


def filter_packages() -> dict[str, bytes]:
    """Return the files of all packages with such plugins, by path; empty: there are none."""
    entries = [
        each
        for group in _GROUPS
        for each in installed_entries(group)
        if each.module.partition(".")[0] != "beliefnest"
    ]
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
    groups = groupby(entries, lambda entry: entry.group)
    return "".join(
        f"[{group}]\n" + "".join(f"{entry.name} = {entry.value}\n" for entry in declared)
        for group, declared in groups
    )
