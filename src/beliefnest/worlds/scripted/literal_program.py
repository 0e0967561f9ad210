"""Programs that only call skills with literal values: they need no interpreter.

Most scripts and most answers of models are of this kind: `await` before each call, and numbers,
texts, positions, counted items and lists of claims as arguments. Here such a program is read and
carried out as it stands, with the outcome that the interpreter gives, in a tenth of the time.
"""

import re
from collections import deque
from collections.abc import Collection, Mapping, Sequence
from typing import Any

import msgspec

from beliefnest.skills.calls import CLAIM_CALLS
from beliefnest.skills.javascript import parsed
from beliefnest.world.event_words import Announcement
from beliefnest.worlds.protocol import Fault, Unfinished
from beliefnest.worlds.scripted.bot_reads import BotReads
from beliefnest.worlds.scripted.desk import Desk, DeskFacts
from beliefnest.worlds.scripted.requests import Request, error_of, fault_of

_MOST_CALLS = 200
"""Programs with more calls go to the interpreter, where their fuel is counted."""
_LONGEST = 10_000

_ENDS = re.compile("\r\n|[\n\r\u2028\u2029]")
"""JavaScript's line ends."""
_FOREIGN = re.compile("[\u200b\u2060\ud800-\udfff]")
"""Characters that may be white space for the parser, and are none for the interpreter."""
_NUMBER = re.compile(r"(?!-0(?:\.0*)?$)-?(?:0|[1-9]\d{0,14})(?:\.\d{1,15})?", re.ASCII)
_KEY = re.compile(r"[A-Za-z][\w ]*", re.ASCII)
"""Keys that keep their order in JavaScript and mean nothing there."""
_BOT = {"$": "h", "id": 0}
_CLAIMS = {call.encode(): (kind, *names) for kind, (call, *names) in CLAIM_CALLS.items()}
"""Functions that make claims: the kind, and the names of the arguments in order."""
_ONE, _TWO, _THREE, _SOME = range(1, 2), range(2, 3), range(3, 4), range(1, 100)
"""Numbers of parts."""


class _OtherProgramError(Exception):
    """A part of a program is no call of a skill with literal values."""


class LiteralCall(msgspec.Struct, frozen=True):
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
    if len(code) > _LONGEST or _FOREIGN.search(code) is not None:
        return None
    source = code.encode()
    root = parsed(source)
    if root.has_error:
        return None
    try:
        statements = _parts(root, "program", range(_MOST_CALLS + 1))
        return tuple(_call(each, source, skills) for each in statements)
    except _OtherProgramError:
        return None


def _call(statement: Any, source: bytes, skills: Collection[str]) -> LiteralCall:
    """Return the call of a statement `await NAME(bot, ...)`."""
    (awaited,) = _parts(statement, "expression_statement", _ONE)
    (call,) = _parts(awaited, "await_expression", _ONE)
    name, (bot, *others) = _named(call, _SOME)
    if bot.text != b"bot" or name.text.decode() not in skills:
        raise _OtherProgramError
    # Errors name the first line of the statement, so the name of the call must be in it.
    if _ENDS.search(source[statement.start_byte : name.start_byte].decode()):
        raise _OtherProgramError
    start = len(source[: name.start_byte].decode())
    return LiteralCall(name.text.decode(), (_BOT, *map(_wire, others)), start)


def _named(call: Any, numbers: range) -> tuple[Any, list[Any]]:
    """Return what a call names, and its arguments."""
    name, arguments = _parts(call, "call_expression", _TWO)
    return name, _parts(arguments, "arguments", numbers)


def _parts(node: Any, kind: str, numbers: range) -> list[Any]:
    """Return the parts of a node of a kind, without comments."""
    parts = [each for each in node.named_children if each.type != "comment"]
    if node.type != kind or len(parts) not in numbers:
        raise _OtherProgramError
    return parts


def _wire(node: Any) -> Any:
    """Return a literal as the interpreter would hand it over."""
    match node.type:
        case "array":
            claims = [_claim(each) for each in node.named_children]
            # A comma more may leave a hole.
            if len(node.children) == 2 * len(claims) + 1:
                return claims
        case "object":
            pairs = [_parts(each, "pair", _TWO) for each in _parts(node, node.type, _SOME)]
            items = {_key(key): _number(count) for key, count in pairs}
            return {"$": "o", "o": [[*each] for each in items.items()]}
    return _word(node)


def _claim(node: Any) -> Any:
    """Return what a call of a function of `_CLAIMS` makes."""
    name, parts = _named(node, _TWO)
    if name.text not in _CLAIMS:
        raise _OtherProgramError
    kind, *keys = _CLAIMS[name.text]
    words = zip(keys, map(_word, parts), strict=True)
    return {"$": "o", "o": [["kind", kind], *map(list, words)]}


def _word(node: Any) -> Any:
    """Return a text, a position or a number."""
    if node.type == "string":
        return _string(node)
    if node.type == "new_expression":
        name, arguments = _parts(node, node.type, _TWO)
        if name.text == b"Vec3":
            return {"$": "v", "c": [*map(_number, _parts(arguments, "arguments", _THREE))]}
    return _number(node)


def _key(node: Any) -> str:
    key = _string(node) if node.type == "string" else node.text.decode()
    if not _KEY.fullmatch(key):
        raise _OtherProgramError
    return key


def _string(node: Any) -> str:
    """Return the content of a string without escapes."""
    if any(part.type != "string_fragment" for part in node.named_children):
        raise _OtherProgramError
    return str(node.text.decode()[1:-1])


def _number(node: Any) -> int | float:
    """Return a decimal number other than -0."""
    text = node.text.decode()
    if not _NUMBER.fullmatch(text):
        raise _OtherProgramError
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
    log = ()

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
        admission = self._admission(call)
        if "error" in admission and not admission.get("later"):
            self._end(admission["error"])
            return
        self._number += 1
        self._requests.append(Request.admitted(self._number, call.name, admission))

    def _admission(self, call: LiteralCall) -> Mapping[str, Any]:
        facts = DeskFacts(self._reads.name, self._reads.agents, ("bot",))
        return self._desk.admit_skill(call.name, call.wires, facts)

    def _end(self, error: Mapping[str, Any]) -> None:
        line, column = self._place()
        self.ended = True
        self.fault = fault_of({**error, "line": line, "column": column})

    def _place(self) -> tuple[int, int]:
        assert self._under_way is not None
        before = _ENDS.split(self._code[: self._under_way.start])
        return len(before), len(before[-1]) + 1
