"""Memory of a scripted-world program's calls, with which an interrupted program can continue."""

import json
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from msgspec.structs import replace

from beliefnest.worlds.protocol import Called

_MOST = 2000
"""Largest number of remembered calls; a program with more begins anew."""
_WAITS = frozenset(("waitTicks", "waitForChat"))


@dataclass
class _Entry:
    """Call, with the tick at which it began."""

    call: Called
    begun: int
    before: int = 0


class Memory:
    """Calls of one program.

    Args:
        past: The calls before its interruption, in order.
    """

    def __init__(self, past: Iterable[Called] = ()) -> None:
        self._past = list(past)
        self._entries: dict[int, _Entry] = {}

    def called(self, number: int, name: str, args: list[Any], tick: int) -> tuple[bool, Any] | None:
        """Record a call; return its result from before the interruption, or None."""
        arguments = json.dumps(args)
        past = self._past.pop(0) if self._past else None
        if past is not None and (past.name, past.given) != (name, arguments):
            # From here on the program takes another course.
            self._past.clear()
            past = None
        before = 0 if past is None else past.ticks
        answer = None if past is None else past.answer
        since = tick if past is None else past.since
        call = Called(name, arguments, answer, since=since)
        self._entries[number] = _Entry(call, tick, before)
        if answer is None:
            return None
        reply = json.loads(answer)
        return reply["ok"], reply["value"]

    def done(self, number: int) -> int:
        """Return the ticks of an interrupted call that need not pass again."""
        return self._entries[number].before

    def answered(self, number: int, *, ok: bool, value: object) -> None:
        """Record the result of a call."""
        entry = self._entries[number]
        answer = json.dumps({"ok": ok, "value": value})
        entry.call = replace(entry.call, answer=answer)

    def calls(self, first: int, tick: int, *, walked: bool) -> tuple[Called, ...]:
        """Return all calls, as of a tick; empty if there are too many.

        An interrupted wait goes on. So does what takes more than all ticks in the same place, which
        would otherwise never end. Other interrupted calls begin anew.

        Args:
            first: Tick at which the program began or went on.
            tick: The present tick.
            walked: True if the agent has walked since then.
        """
        if len(self._entries) > _MOST:
            return ()
        return tuple(
            replace(entry.call, ticks=entry.before + tick - entry.begun)
            if entry.call.answer is None
            and (entry.call.name in _WAITS or (entry.begun == first and not walked))
            else entry.call
            for entry in self._entries.values()
        )
