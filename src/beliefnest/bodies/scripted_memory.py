"""What a program of the scripted world has called, so that it can go on where it was cut."""

import json
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

from beliefnest.bodies.protocol import Called

__all__ = ["Memory"]

_MOST = 2000
"""Calls that are remembered; a program that makes more is begun anew."""
_WAITS = "waitTicks"


@dataclass
class _Entry:
    """A call, and since when it is under way."""

    call: Called
    begun: int
    before: int = 0


class Memory:
    """The calls of one program.

    Args:
        past: Those that it made before it was cut, in order.
    """

    def __init__(self, past: Iterable[Called] = ()) -> None:
        self._past = list(past)
        self._entries: dict[int, _Entry] = {}

    def called(self, number: int, name: str, args: list[Any], tick: int) -> tuple[bool, Any] | None:
        """Take note of a call; what came of it if it was over before the cut, else None."""
        given = json.dumps(args)
        known = self._past.pop(0) if self._past else None
        if known is not None and (known.name, known.given) != (name, given):
            # From here on it does something else.
            self._past.clear()
            known = None
        before = 0 if known is None else known.ticks
        answer = None if known is None else known.answer
        since = tick if known is None else known.since
        call = Called(name, given, answer, since=since)
        self._entries[number] = _Entry(call, tick, before)
        if answer is None:
            return None
        told = json.loads(answer)
        return told["ok"], told["value"]

    def left(self, number: int, args: list[Any]) -> list[Any]:
        """Return the arguments of a call that was under way: who waits has waited for some time."""
        entry = self._entries[number]
        if entry.call.name != _WAITS or not entry.before:
            return args
        return [max(0, args[0] - entry.before)]

    def answered(self, number: int, *, ok: bool, value: object) -> None:
        """Take note of what came of a call."""
        entry = self._entries[number]
        answer = json.dumps({"ok": ok, "value": value})
        entry.call = replace(entry.call, answer=answer)

    def calls(self, tick: int) -> tuple[Called, ...]:
        """Return all of them, as of a tick; none if they are too many."""
        if len(self._entries) > _MOST:
            return ()
        return tuple(
            entry.call
            if entry.call.answer is not None
            else replace(entry.call, ticks=entry.before + tick - entry.begun)
            for entry in self._entries.values()
        )
