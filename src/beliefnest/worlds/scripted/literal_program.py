"""Programs that only call skills with literal values: they need no interpreter.

Most scripts and most answers of models are of this kind: `await` before each call, and numbers,
texts, positions and counted items as arguments. Here such a program is read and carried out as it
stands, with the outcome that the interpreter gives, in a tenth of the time.
"""

import re
from collections import deque
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from beliefnest.world.event_words import Announcement
from beliefnest.worlds.protocol import Fault, Unfinished
from beliefnest.worlds.scripted.bot_reads import BotReads
from beliefnest.worlds.scripted.desk import Desk, DeskFacts
from beliefnest.worlds.scripted.requests import Request, error_of, fault_of

_MOST_CALLS = 200
"""Programs with more calls go to the interpreter, where their fuel is counted."""
_LONGEST = 10_000

# JavaScript's line ends: each ends a comment, and a string literal here contains none.
_ENDS = r"\n\r\u2028\u2029"
_GAP = rf"(?:\s|//[^{_ENDS}]*+(?:[{_ENDS}]|\Z))*+"
_WORD = r"[A-Za-z]\w*+"
_NUMBER = r"-?(?:0|[1-9]\d{0,14}+)(?:\.\d{1,15}+)?+(?![\w.])"
_TEXT = rf"""(?:"[^"\\{_ENDS}]*+"|'[^'\\{_ENDS}]*+')"""
_PLACE = rf"new\s+Vec3\s*\(\s*{_NUMBER}\s*,\s*{_NUMBER}\s*,\s*{_NUMBER}\s*\)"
_ITEM = rf"(?:{_WORD}|{_TEXT})\s*:\s*{_NUMBER}"
_ITEMS = rf"\{{\s*{_ITEM}\s*(?:,\s*{_ITEM}\s*)*+\}}"
_VALUE = rf"(?:{_NUMBER}|{_TEXT}|{_PLACE}|{_ITEMS})"
_CALL = re.compile(
    rf"{_GAP}await\s+(?P<name>{_WORD})\s*\(\s*bot\s*(?P<args>(?:,\s*{_VALUE}\s*)*+)\)\s*;?",
    re.ASCII,
)
_END = re.compile(_GAP, re.ASCII)
_ARGUMENT = re.compile(rf",\s*({_VALUE})\s*", re.ASCII)
_PART = re.compile(_NUMBER, re.ASCII)
_COUNTED = re.compile(rf"({_WORD}|{_TEXT})\s*:\s*({_NUMBER})", re.ASCII)
_KEY = re.compile(r"[A-Za-z][\w ]*", re.ASCII)
_BOT = {"$": "h", "id": 0}
_NEGATIVE_ZERO = re.compile(r"-0(?:\.0*)?(?![\d.])")


@dataclass(frozen=True, slots=True)
class LiteralCall:
    """Call of a skill.

    Attributes:
        name: Name of the skill.
        wires: Arguments, as the interpreter would hand them over.
        start: Offset of the name in the text.
    """

    name: str
    wires: tuple[Any, ...]
    start: int


def literal_calls(code: str, skills: Collection[str]) -> tuple[LiteralCall, ...] | None:
    """Return the calls of a program if it consists of nothing else; None otherwise."""
    if len(code) > _LONGEST or _NEGATIVE_ZERO.search(code) is not None:
        return None
    calls: list[LiteralCall] = []
    at = 0
    while call := _CALL.match(code, at):
        if call["name"] not in skills or len(calls) >= _MOST_CALLS:
            return None
        wires = [_wire(each[1]) for each in _ARGUMENT.finditer(call["args"])]
        if None in wires:
            return None
        calls.append(LiteralCall(call["name"], (_BOT, *wires), call.start("name")))
        at = call.end()
    return tuple(calls) if _END.fullmatch(code, at) is not None else None


def _wire(text: str) -> Any:
    """Return a literal as the interpreter would hand it over; None if that is not certain."""
    if text[0] in "\"'":
        return text[1:-1]
    if text[0] == "n":
        return {
            "$": "v",
            "c": [_number(each[0]) for each in _PART.finditer(text.partition("(")[2])],
        }
    if text[0] != "{":
        return _number(text)
    items = {each[1].strip("\"'"): _number(each[2]) for each in _COUNTED.finditer(text)}
    # Other names may be in another order in JavaScript, or mean something there.
    if not all(_KEY.fullmatch(name) for name in items):
        return None
    return {"$": "o", "o": [[name, count] for name, count in items.items()]}


def _number(text: str) -> int | float:
    return float(text) if "." in text else int(text)


class LiteralProgram:
    """Program that begins with `start`, as `JavaScriptProgram`.

    Args:
        reads: What it may read; it also says whose program it is.
        code: Its text.
        calls: Its calls.
        desk: Desk to share.
    """

    listens = False
    draws = 0
    log: tuple[str, ...] = ()

    def __init__(
        self, reads: BotReads, code: str, calls: Sequence[LiteralCall], desk: Desk
    ) -> None:
        self._reads, self._code, self._desk = reads, code, desk
        self._calls = deque(calls)
        self._requests: list[Request] = []
        self._number = 0
        self._under_way: LiteralCall | None = None
        self.ended = False
        self.fault: Fault | None = None

    def start(self) -> None:
        """Start the program, and run it until it waits."""
        self._go_on()

    def reseed(self, seed: str) -> None:
        """Do nothing: the program draws no random numbers."""

    def end(self) -> None:
        """Do nothing: the program holds nothing."""

    def hear(self, news: Sequence[Announcement]) -> None:
        """Do nothing: the program does not listen."""

    def settle(self, number: int, value: object) -> None:
        """Give a call its result, and run until the program waits again."""
        if number == self._number and not self.ended:
            self._go_on()

    def fail(self, number: int, error: Mapping[str, Any]) -> None:
        """Let a call fail, and with it the program; `error` as for `JavaScriptProgram`."""
        if number == self._number and not self.ended and self._under_way is not None:
            self._end(error_of(self._under_way.name, error))

    def requests(self) -> list[Request]:
        """Return the calls since the last request."""
        made, self._requests = self._requests, []
        return made

    def unfinished(self, number: int, name: str) -> Unfinished:
        """Describe a call that was stopped."""
        return Unfinished(name, None if self._under_way is None else self._place()[0])

    def _go_on(self) -> None:
        if not self._calls:
            self._under_way, self.ended = None, True
            return
        call = self._under_way = self._calls.popleft()
        facts = DeskFacts(self._reads.name, self._reads.agents, ("bot",))
        admission = self._desk.admit_skill(call.name, call.wires, facts)
        if "error" in admission and not admission.get("later"):
            self._end(admission["error"])
            return
        self._number += 1
        self._requests.append(Request.admitted(self._number, call.name, admission))

    def _end(self, error: Mapping[str, Any]) -> None:
        line, column = self._place()
        self.ended = True
        self.fault = fault_of({**error, "line": line, "column": column})

    def _place(self) -> tuple[int, int]:
        assert self._under_way is not None
        before = re.split(rf"\r\n|[{_ENDS}]", self._code[: self._under_way.start])
        return len(before), len(before[-1]) + 1
