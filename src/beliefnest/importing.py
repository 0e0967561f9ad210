"""Import of Python objects by name: those of users, and parts of this package that lie above."""

import difflib
import functools
import importlib
import importlib.util
import sys
from collections.abc import Collection
from importlib.machinery import ModuleSpec
from importlib.metadata import EntryPoint, EntryPoints, distribution, entry_points
from pathlib import Path
from types import ModuleType
from typing import Any

from beliefnest.errors import BeliefNestError, InputError

_SUFFIX = ".py"
_OWN = "beliefnest"
_PARTS = "beliefnest.parts"
"""Group of entry points that `pyproject.toml` declares for rooms that call what lies above."""


def is_object_name(text: str) -> bool:
    """Return True if a text has the form `module:NAME` or `FILE.py:NAME`."""
    place, _, name = text.rpartition(":")
    is_module = all(part.isidentifier() for part in place.split("."))
    return name.isidentifier() and (is_module or place.endswith(_SUFFIX))


def imported_object(text: str, what: str) -> object:
    """Return the object of a name.

    Args:
        text: Name in one of the two forms of `is_object_name`. A module is looked for on Python's
            path; a file is relative to the working directory.
        what: Kind of the object for messages, such as "policy".

    Raises:
        InputError: The module cannot be imported, or has no such object.
    """
    place, _, name = text.rpartition(":")
    module = _module(place, what)
    try:
        return getattr(module, name)
    except AttributeError:
        raise InputError(f"{place} has no {what} {name!r}{_hint(name, module)}") from None


def made_object(name: str, group: str, what: str, method: str, returns: str) -> Any:
    """Return an object of the user's own, which a class or function without arguments makes.

    Args:
        name: Name of an entry point of the group, or a name as for `imported_object`.
        group: Group of entry points.
        what: Kind of the object for messages, such as "policy".
        method: Method that the object must have. An object with this method that is no class
            is returned as it is.
        returns: What the method takes and returns, for messages.

    Raises:
        InputError: There is no such object, or it makes none of this kind.
    """
    entry = installed(group, name)
    made = imported_object(name, what) if entry is None else load(entry, what)
    if isinstance(made, type) or not callable(getattr(made, method, None)):
        if not callable(made):
            raise InputError(f"{name!r} is no class and no function; name one that makes a {what}")
        try:
            made = made()
        except TypeError as error:
            raise InputError(
                f"{name!r} cannot be called without arguments: {error}; give them defaults"
            ) from error
        except BeliefNestError:
            raise
        except (Exception, SystemExit) as error:  # Code of users may raise anything.
            raise InputError(f"{name!r} raised {type(error).__name__}: {error}") from error
    if not callable(getattr(made, method, None)):
        raise InputError(
            f"{name!r} makes no {what}: {type(made).__name__} has no method {method}{returns}"
        )
    return made


def part(name: str) -> Any:
    """Return a part of this package that lies above the room which calls it.

    Args:
        name: Name of an entry point, such as `imagine` or `page`.

    Raises:
        InputError: The installed package does not declare it.
    """
    for entry in _own_entries(_PARTS).select(name=name):
        return entry.load()
    raise InputError(f"the installed BeliefNest has no part {name!r}; install it again with pip")


def installed(group: str, name: str) -> EntryPoint | None:
    """Return the entry point of a name: that of this package, or else of another installed one.

    Raises:
        InputError: Two other packages use the name for different objects.
    """
    for entry in _own_entries(group).select(name=name):
        return entry
    entries = {entry.value: entry for entry in _entries(group).select(name=name)}
    if len(entries) > 1:
        raise InputError(
            f"several installed packages declare {name!r} for {group}: {', '.join(sorted(entries))}"
            "; uninstall all but one"
        )
    return next(iter(entries.values()), None)


def installed_names(group: str) -> tuple[str, ...]:
    """Return the names of all entry points of a group, those of this package first."""
    own = _own_entries(group).names
    return (*sorted(own), *sorted(_entries(group).names - own))


def installed_entries(group: str) -> tuple[EntryPoint, ...]:
    """Return the entry points of a group, as `installed` returns each."""
    entries = (installed(group, name) for name in installed_names(group))
    return tuple(entry for entry in entries if entry is not None)


def hidden_entries(group: str, built_in: Collection[str] = ()) -> tuple[EntryPoint, ...]:
    """Return the entry points of other packages whose names this package uses itself.

    Args:
        group: Group of entry points.
        built_in: Names that are no entry points of this package.
    """
    own = {*_own_entries(group).names, *built_in}
    there = (each for each in _entries(group) if each.name in own)
    return tuple(each for each in there if each.dist is None or each.dist.name != _OWN)


def told_entry(entry: EntryPoint, what: str) -> str:
    """Return an entry point in words; `what` is the kind of its object, such as "world"."""
    package = entry.dist.name if entry.dist is not None else entry.module
    return f"the {what} {entry.name!r} of the installed package {package} ({entry.value})"


def load(entry: EntryPoint, what: str) -> Any:
    """Return the object of an entry point; `what` is its kind for messages, such as "world".

    Raises:
        InputError: It cannot be imported.
    """
    try:
        return entry.load()
    except Exception as error:  # Code of users may raise anything.
        fault = f"{type(error).__name__}: {error}"
        raise InputError(f"{told_entry(entry, what)} cannot be imported: {fault}") from error


def _entries(group: str) -> EntryPoints:
    """Return the entry points of a group that all installed packages declare."""
    folders = (Path(place) for place in sys.path)
    times = (each.stat().st_mtime_ns if each.exists() else 0 for each in folders)
    declared = _entries_at(tuple(zip(sys.path, times, strict=True)))
    entries: EntryPoints = declared.select(group=group)
    return entries


@functools.lru_cache(1)
def _entries_at(places: tuple[tuple[str, int], ...]) -> Any:
    """Return what packages declare in folders, each with the time of its last change.

    To read it takes 5 ms, and longer where there are more packages. Before Python 3.12 it is no
    `EntryPoints`, but has `select`, too.
    """
    return entry_points()


@functools.cache
def _own_entries(group: str) -> EntryPoints:
    return distribution(_OWN).entry_points.select(group=group)


def is_importable(place: str) -> bool:
    """Return True if a place before the colon is a Python file's name, or a module that exists."""
    return place.endswith(_SUFFIX) or _spec(place) is not None


def text_of_object(text: str) -> str:
    """Return the text of the file in which a named object is defined; empty if it has no text.

    Raises:
        InputError: The file cannot be read.
    """
    place = text.rpartition(":")[0]
    if place.endswith(_SUFFIX):
        file = Path(place)
    else:
        origin = _spec_of(place)
        if origin is None or not origin.endswith(_SUFFIX):
            return ""
        file = Path(origin)
    try:
        return file.read_text(encoding="utf-8")
    except (OSError, ValueError) as error:
        raise InputError(f"{file} cannot be read: {error}") from None


def _hint(name: str, module: ModuleType) -> str:
    """Return a hint to the names that a module defines."""
    own = [
        defined
        for defined, value in vars(module).items()
        if callable(value) and getattr(value, "__module__", None) == module.__name__
    ]
    close = difflib.get_close_matches(name, own, n=1)
    if close:
        return f"; did you mean {close[0]!r}?"
    return f"; it defines {', '.join(own)}" if own else "; it defines no class and no function"


def _spec(module: str) -> ModuleSpec | None:
    try:
        return importlib.util.find_spec(module)
    except (ImportError, ValueError):
        return None


def _spec_of(module: str) -> str | None:
    spec = _spec(module)
    return None if spec is None else spec.origin


def _module(place: str, what: str) -> ModuleType:
    try:
        return _of_file(Path(place)) if place.endswith(_SUFFIX) else importlib.import_module(place)
    except FileNotFoundError:
        raise InputError(f"there is no file {place}; check the path of the {what}") from None
    except ModuleNotFoundError as error:
        if error.name == place.partition(".")[0] or error.name == place:
            raise InputError(
                f"there is no module {place!r} for a {what}; put its folder into PYTHONPATH, or "
                f"name its file, as FILE.py:NAME"
            ) from error
        beside = " (to import modules beside it, put its folder into PYTHONPATH)"
        hint = beside if place.endswith(_SUFFIX) else ""
        raise InputError(f"{place} of a {what} cannot be imported: {error}{hint}") from error
    except (Exception, SystemExit) as error:  # Code of users may raise anything.
        fault = f"{type(error).__name__}: {error}"
        raise InputError(f"{place} of a {what} cannot be imported: {fault}") from error


def _of_file(file: Path) -> ModuleType:
    """Return the module of a file, imported once per process as `import` does."""
    name = f"beliefnest_user_{file.resolve()}"
    if name in sys.modules:
        return sys.modules[name]
    spec = importlib.util.spec_from_file_location(name, file)
    assert spec is not None  # the file's name ends in .py
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    # Dataclasses and pickle look classes up by the name of their module.
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
    except BaseException:
        del sys.modules[name]
        raise
    return module
