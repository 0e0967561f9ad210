"""Comparison of two histories: the first entry where a replay differs from the record."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import fields, is_dataclass
from itertools import zip_longest
from typing import Any

import msgspec
from msgspec import structs

from beliefnest.timeline.journal import Entry

_ABSENT = object()


class EntryDifference(msgspec.Struct, frozen=True):
    """First difference between two histories.

    Attributes:
        tick: Tick of the earlier of the two entries.
        entry: Index of the entries, from 0.
        field: Place inside the entry, such as `agents.sally.position.0`. Empty if one history has
            no such entry or has another kind of entry.
        recorded: Value in the first history; None if it has none.
        found: Value in the second history; None if it has none.
    """

    tick: int
    entry: int
    field: str
    recorded: Any
    found: Any


def first_difference(recorded: Iterable[Entry], again: Iterable[Entry]) -> EntryDifference | None:
    """Return the first difference between two histories; None if they are the same."""
    for number, (old, new) in enumerate(zip_longest(recorded, again)):
        if old == new:
            continue
        tick = min(entry.tick for entry in (old, new) if entry is not None)
        # If the entries differ in tick or kind, one history lacks an entry at this tick.
        if old is None or new is None or type(old) is not type(new) or old.tick != new.tick:
            then = [None if e is None or e.tick > tick else e for e in (old, new)]
            return EntryDifference(tick, number, "", *then)
        place, a, b = next(_differences("", old, new))
        return EntryDifference(tick, number, place, a, b)
    return None


def _differences(place: str, old: Any, new: Any) -> Iterator[tuple[str, Any, Any]]:
    """Yield each innermost place where two values differ, with both values there."""
    if old == new:
        return
    parts_old, parts_new = _parts(old), _parts(new)
    if type(old) is not type(new) or parts_old is None or parts_new is None:
        yield place, _shown(old), _shown(new)
        return
    for name in [*parts_old, *(n for n in parts_new if n not in parts_old)]:
        inner = f"{place}.{_name(name)}" if place else _name(name)
        yield from _differences(inner, parts_old.get(name, _ABSENT), parts_new.get(name, _ABSENT))


def _parts(value: Any) -> Mapping[Any, Any] | None:
    """Return the parts of a value by name; None if the value has no parts."""
    if isinstance(value, msgspec.Struct):
        return structs.asdict(value)
    if is_dataclass(value) and not isinstance(value, type):
        return {field.name: getattr(value, field.name) for field in fields(value)}
    if isinstance(value, Mapping):
        return value
    if isinstance(value, tuple):
        return dict(enumerate(value))
    return None


def _name(name: Any) -> str:
    return ",".join(map(str, name)) if isinstance(name, tuple) else str(name)


def _shown(value: Any) -> Any:
    return None if value is _ABSENT else value
