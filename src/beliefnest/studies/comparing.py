"""Differences between recorded results and the same results computed again."""

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from typing import Any

import msgspec

from beliefnest.world.texts import quoted

ERROR = "error"
"""Key of a difference whose cell has no result now."""

HASH = "sha256"
"""Key of a difference whose file is not the one that was bundled."""

ADDED = "added"
"""Key of a difference whose file was not bundled."""


class PairedDifference(msgspec.Struct, frozen=True):
    """Difference of one value.

    Attributes:
        where: File, with the line of a table.
        what: Column, or keys down to the value.
        recorded: Recorded value.
        again: Value now.
    """

    where: str
    what: str
    recorded: Any
    again: Any

    @property
    def text(self) -> str:
        """Return the difference as a line for people."""
        if self.what == ERROR:
            return f"{self.where}: no result now: {self.again}"
        if self.what == HASH:
            return f"{self.where} {'is missing' if self.again is None else 'has changed'}"
        if self.what == ADDED:
            return f"{self.where} is not in the manifest"
        return f"{self.where}: {self.what} is {quoted(self.recorded)}, now {quoted(self.again)}"


def differing_rows(
    recorded: Sequence[Mapping[str, Any]],
    again: Sequence[Mapping[str, Any]],
    where: Callable[[int], str],
) -> Iterator[PairedDifference]:
    """Yield the differing values of two tables, row by row.

    Args:
        recorded: Recorded rows.
        again: Rows now.
        where: Function that returns the place of a recorded row, from its number from 1.
    """
    if len(recorded) != len(again):
        yield PairedDifference(where(len(again)), "number of rows", len(recorded), len(again))
    for number, (before, after) in enumerate(zip(recorded, again, strict=False), 1):
        # Later versions have more columns.
        for name in before:
            one, other = before[name], after.get(name, "missing")
            if one != other:
                yield PairedDifference(where(number), name, one, other)


def differing_contents(
    recorded: object, again: object, where: str, ignored: Collection[str] = (), path: str = ""
) -> Iterator[PairedDifference]:
    """Yield the differing values of two structures of plain values.

    Args:
        recorded: Recorded value.
        again: Value now.
        where: File of the recorded value.
        ignored: Keys that are not compared, at any depth.
        path: Keys down to the value.
    """
    if isinstance(recorded, Mapping) and isinstance(again, Mapping):
        for key in dict.fromkeys((*recorded, *again)):
            if key not in ignored:
                one, other = recorded.get(key, "missing"), again.get(key, "missing")
                yield from differing_contents(one, other, where, ignored, _under(path, key))
    elif isinstance(recorded, list) and isinstance(again, list) and len(recorded) == len(again):
        for number, (one, other) in enumerate(zip(recorded, again, strict=True)):
            yield from differing_contents(one, other, where, ignored, _under(path, number))
    elif recorded != again:
        yield PairedDifference(where, path or "content", recorded, again)


def _under(path: str, key: object) -> str:
    return f"{path}.{key}" if path else str(key)
