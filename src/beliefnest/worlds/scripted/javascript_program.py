"""Agent program of the scripted world: its session with the host, which answers what it asks for.

It is the twin of `worlds/minecraft/node/src/sandbox/session.js`. What both check, the desk checks.
"""

import json
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from typing import Any

from beliefnest.world.event_words import Announcement
from beliefnest.world.registry import Registry
from beliefnest.worlds.protocol import Fault, Unfinished
from beliefnest.worlds.scripted.bot_reads import BotBody, BotReads, OpenWindow, state_of
from beliefnest.worlds.scripted.desk import Desk, DeskFacts, Prepared, TooIntricateError
from beliefnest.worlds.scripted.guest import Guest, GuestEndedError, parsed, too_much
from beliefnest.worlds.scripted.hand import mute_fault
from beliefnest.worlds.scripted.requests import Request, at_place, error_of, fault_of, is_near
from beliefnest.worlds.scripted.sandbox_parts import parts
from beliefnest.worlds.scripted.sfc32 import Sfc32

_UNDEFINED = {"$": "u"}
_NOTHING: Mapping[str, Any] = {"waitForChat": None}
"""Results, for programs, of skills that return nothing, where that is not `undefined`."""
_NOBODY = 0
_ERROR_COST = 30_000
"""Fuel for an error that the desk describes, about what the desk itself computes for it."""
_LOG_CUT = " ... (the rest of the output is left out)"
_INTRICATE = "the program is too intricate to be read; write it in simpler parts"
_TOO_LARGE = "the arguments are too large"
_ELSEWHERE = 'open the nest with world="embedded" for that'
_HAS: Mapping[str, tuple[str, ...]] = {
    "bot": (
        *("username", "entity", "entities", "players", "inventory", "health", "food", "blockAt"),
        *("chat", "whisper", "openContainer", "openChest", "closeWindow", "waitForTicks"),
        *("on", "once", "off"),
    ),
    "entity": ("type", "name", "username", "position", "yaw", "pitch", "height"),
}


class RefusedError(Exception):
    """Something that a program cannot have, described for its author."""


class _RequestError(Exception):
    """Error for the program, as the desk wrote it."""

    def __init__(self, wire: Mapping[str, Any]) -> None:
        super().__init__(wire["message"])
        self.wire = wire


class JavaScriptProgram:
    """Program that begins with `start`.

    Args:
        reads: What it may read; it also says whose program it is.
        skills: Names of the skills that the world has.
        code: Its text.
        seed: Seed of its random numbers.
        desk: Desk to share.
        speech_lasts: True if what it says takes time, so that its bot returns promises.
        mute: True if its bot cannot speak.
    """

    def __init__(
        self,
        reads: BotReads,
        skills: Collection[str],
        code: str,
        seed: str,
        desk: Desk,
        *,
        speech_lasts: bool = False,
        mute: bool = False,
    ) -> None:
        self._reads, self._skills, self._code, self._desk = reads, skills, code, desk
        self._speech_lasts, self._mute = speech_lasts, mute
        self._random = Sfc32(seed)
        self._bag = OpenWindow("bot.inventory", lambda: reads.me.inventory, "items")
        self._guest: Guest | None = None
        self._prepared: Prepared | None = None
        self._objects: list[object] = [None]
        self._kinds = ["bot"]
        self._requests: list[Request] = []
        self._under_way: dict[int, tuple[str, int]] = {}
        self._began: dict[int, int] = {}
        self._listeners: list[tuple[str, int, bool]] = []
        self._next = 1
        self.log: list[str] = []
        self._room = parts().limits.log_characters
        self._outcome: Mapping[str, Any] | None = None
        self._last = 0
        self._under: list[str] = []
        self.fault: Fault | None = None

    # For the host

    def start(self) -> None:
        """Start the program, and run it until it waits."""
        try:
            prepared = self._desk.prepare(self._code)
        except TooIntricateError:
            prepared = {"message": _INTRICATE, "kind": "syntax"}
        if not isinstance(prepared, Prepared):
            self._outcome, self.fault = {"ok": False}, fault_of(prepared)
            return
        self._prepared = prepared
        guest = self._guest = Guest(self._answer, lambda: self._reads.now_ms, self._random.fraction)
        try:
            guest.start(prepared.text, prepared.marks)
            self._look()
        except GuestEndedError as ended:
            self._finish({"ok": False, "ended": ended})

    @property
    def draws(self) -> int:
        """Number of random numbers that it has drawn."""
        return self._random.draws

    def reseed(self, seed: str) -> None:
        """Let a seed decide about its random numbers from now on."""
        self._random.reseed(seed)

    def end(self) -> None:
        """Free what the program holds; it must not continue."""
        if self._guest is not None:
            self._guest.close()
            self._guest = None

    @property
    def listens(self) -> bool:
        """True if the program listens for speech."""
        return bool(self._listeners) and not self.ended

    def hear(self, news: Sequence[Announcement]) -> None:
        """Call its listeners to the events of its bot."""
        for name, *values in news:
            self._tell(name, *values)

    def settle(self, number: int, value: object) -> None:
        """Give a call its result, and run until the program waits again."""
        if number in self._under_way:
            name = self._under_way.pop(number)[0]
            self._wake(["settle", number, True, self._wire(name, value)])

    def fail(self, number: int, error: Mapping[str, Any]) -> None:
        """Let a call fail, and run until the program waits again.

        Args:
            number: The call.
            error: Message, and a reason or None; or an error of the desk.
        """
        if number in self._under_way:
            name = self._under_way.pop(number)[0]
            self._wake(["settle", number, False, error_of(name, error)])

    def requests(self) -> list[Request]:
        """Return the calls since the last request."""
        made, self._requests = self._requests, []
        return made

    @property
    def ended(self) -> bool:
        """True if the program has ended."""
        return self._outcome is not None

    def unfinished(self, number: int, name: str) -> Unfinished:
        """Describe a call that was stopped."""
        if self._prepared is None:
            return Unfinished(name)
        return Unfinished(name, self._desk.line(self._prepared, self._began[number]))

    # Its end

    def _look(self) -> None:
        """Look whether it has ended, or waits for what can never happen."""
        assert self._guest is not None
        result = self._guest.result()
        failed = result is not None and not result["ok"]
        stray = None if failed else self._guest.stray_error()
        if stray is not None:
            self._finish({"ok": False, "error": stray, "stray": True})
        elif result is not None:
            self._finish(result)
        elif not self._under_way and not self._listeners:
            message = "the program waits for a promise that nothing will settle"
            self._finish({"ok": False, "ended": GuestEndedError("stuck", message)})

    def _finish(self, outcome: Mapping[str, Any]) -> None:
        """End the program; only the first outcome counts."""
        if self._outcome is not None:
            return
        assert self._guest is not None and self._prepared is not None
        self._outcome = outcome
        under = [what for what, _ in self._under_way.values()]
        last = self._guest.last_statement
        self._guest.end("ended", "the program has ended")
        if outcome["ok"]:
            return
        outcome = {**outcome, "full": self._guest.is_full}
        ended = outcome.get("ended")
        if isinstance(ended, GuestEndedError):
            fault = {"kind": ended.kind, "message": ended.message, "guestStack": ended.stack}
            outcome = {**outcome, "ended": fault}
        try:
            error = self._desk.outcome(self._prepared, outcome, last, under)
        except TooIntricateError:
            error = {"message": _INTRICATE, "kind": "error"}
        self.fault = fault_of(error or {})

    def _wake(self, message: list[object]) -> None:
        """Send a message; its error ends the program, for nobody else can catch it."""
        if self._outcome is not None:
            return
        assert self._guest is not None
        try:
            answer = self._guest.send(message)
            if not answer["ok"]:
                self._finish({"ok": False, "error": answer["value"]})
            elif self._guest.idle:
                self._look()
        except GuestEndedError as ended:
            self._finish({"ok": False, "ended": ended})

    def _tell(self, event: str, *values: str) -> None:
        for each in [each for each in self._listeners if each[0] == event]:
            if each not in self._listeners:
                continue
            if each[2]:
                self._listeners.remove(each)
            self._wake(["invoke", each[1], list(values), _NOBODY])

    # What it asks for

    def _answer(self, text: str) -> str:
        """Answer a request of the program."""
        assert self._guest is not None
        cost, most = parts().cost, parts().limits.message
        self._guest.charge(cost.each + cost.character * min(len(text), most))
        try:
            answer = json.dumps({"ok": True, "value": self._asked(text)})
        except _RequestError as error:
            return json.dumps({"ok": False, "value": error.wire})
        except (RefusedError, TooIntricateError) as error:
            message = str(error) if isinstance(error, RefusedError) else _TOO_LARGE
            fault = {"$": "e", "message": message, "name": "Error", "skill": None}
            return json.dumps({"ok": False, "value": {**fault, "kind": "refused"}})
        self._guest.charge(cost.answered * len(answer))
        return answer

    def _asked(self, text: str) -> Any:
        most = parts().limits.message
        if len(text) > most:
            raise RefusedError(too_much(most))
        action, *args = parsed(text)
        return _ACTIONS[action](self, *args)

    def _object(self, wire: Any) -> tuple[str, object]:
        number = wire["id"]
        return self._kinds[number], self._objects[number]

    def _handle(self, kind: str, value: object) -> dict[str, Any]:
        if value not in self._objects:
            self._objects.append(value)
            self._kinds.append(kind)
        return {"$": "h", "id": self._objects.index(value), "k": kind}

    @property
    def _facts(self) -> DeskFacts:
        return DeskFacts(self._reads.name, self._reads.agents, self._kinds)

    def _get(self, wire: Any, name: str) -> Any:
        kind, body = self._object(wire)
        if isinstance(body, BotBody):
            value = self._reads.member(body, name)
            if value is not None:
                return value
        if kind == "bot" and name in _GETS:
            return _GETS[name](self)
        raise self._lacks(kind, body, name)

    def _set(self, wire: Any, name: str, _: Any) -> Any:
        raise self._lacks(*self._object(wire), name)

    def _call(self, wire: Any, name: str, wires: list[Any]) -> Any:
        kind, window = self._object(wire)
        if isinstance(window, OpenWindow):
            if name == window.gives:
                return _plain([*_stacks(window.items())])
            if name == "close":
                return _UNDEFINED
        if kind != "bot" or name not in _CALLS:
            raise self._lacks(kind, window, name)
        if name == "blockAt" and is_near(wires):
            return self._reads.block(tuple(wires[0]["c"]))
        admission = self._desk.admit_call("bot", name, wires, self._facts)
        self._charge(admission)
        if "error" in admission:
            raise _RequestError(admission["error"])
        return _CALLS[name](self, admission)

    def _skill(self, name: str, wires: list[Any]) -> Any:
        if name not in self._skills:
            raise RefusedError(f"the scripted world has no {name}; {_ELSEWHERE}")
        admission = self._desk.admit_skill(name, wires, self._facts)
        self._charge(admission)
        if "error" in admission and not admission.get("later"):
            raise _RequestError(admission["error"])
        return self._promise(name, admission)

    def _charge(self, admission: Mapping[str, Any]) -> None:
        assert self._guest is not None
        self._guest.charge(admission["cost"] + (_ERROR_COST if "error" in admission else 0))

    def _promise(self, name: str, admission: Mapping[str, Any], label: str | None = None) -> Any:
        """Note a call, and return the promise of its result.

        Args:
            name: The call, for the world.
            admission: What the desk says of it.
            label: The call, for the program's author; by default its name.
        """
        most = parts().limits.calls
        if len(self._under_way) >= most:
            raise RefusedError(f"{most} calls are under way, which is the limit")
        number = self._ask(name, admission)
        self._under_way[number] = (label or name, self._began[number])
        return {"$": "p", "id": number}

    def _ask(self, name: str, admission: Mapping[str, Any]) -> int:
        assert self._guest is not None
        number, self._next = self._next, self._next + 1
        self._began[number] = self._guest.last_statement
        self._requests.append(Request.admitted(number, name, admission))
        return number

    def _speak(self, name: str, admission: Mapping[str, Any]) -> Any:
        if self._mute:
            raise RefusedError(mute_fault(self._reads.name))
        if self._speech_lasts:
            return self._promise(f"bot.{name}", admission)
        self._ask(f"bot.{name}", admission)
        return _UNDEFINED

    def _open(self, admission: Mapping[str, Any]) -> Any:
        [target] = admission["checked"]
        if not isinstance(target, dict) or "position" not in target:
            raise RefusedError(f"the scripted world opens blocks alone; {_ELSEWHERE}")
        return self._promise("bot.openContainer", at_place(admission))

    def _listen(self, event: str, wire: Any, once: bool) -> Any:
        if event not in parts().announced:
            is_event = event in parts().events
            if is_event:
                raise RefusedError(f"the scripted world has no event {event}; {_ELSEWHERE}")
            shown = f'the text "{event[:40]}"' if isinstance(event, str) else event
            raise RefusedError(
                f"a program cannot listen to the event {shown}; "
                f"it can to {', '.join(parts().events)}"
            )
        most = parts().limits.listeners
        if len(self._listeners) >= most:
            raise RefusedError(f"the program has {most} listeners, which is the limit")
        self._listeners.append((event, wire["id"], once))
        return None

    def _unlisten(self, event: str, wire: Any) -> Any:
        for each in self._listeners:
            if each[:2] == (event, wire["id"]):
                self._listeners.remove(each)
                break
        return None

    def _settled(self, ticket: int, ok: bool, wire: Any) -> Any:
        if not ok:
            self._finish({"ok": False, "error": wire})
        return None

    def _write(self, _: str, text: str) -> Any:
        limits = parts().limits
        if len(self.log) >= limits.log_lines or self._room <= 0:
            return None
        written = text[: self._room]
        self._room -= len(written)
        is_last = len(self.log) == limits.log_lines - 1 or self._room <= 0
        self.log.append(f"{written}{_LOG_CUT}" if is_last else written)
        return None

    def _timer(self, *_: Any) -> Any:
        raise RefusedError(
            f"the scripted world has no timers: write await waitTicks(bot, number), or {_ELSEWHERE}"
        )

    def _data(self, table: str, *_: Any) -> Any:
        raise RefusedError(f"the scripted world has no mcData.{table}; {_ELSEWHERE}")

    def _lacks(self, kind: str, window: object, name: str) -> RefusedError:
        what = window.what if isinstance(window, OpenWindow) else kind
        has = (window.gives, "close") if isinstance(window, OpenWindow) else _HAS.get(kind, ())
        there = f", only {', '.join(has)}" if has else ""
        return RefusedError(f"the scripted world has no {what}.{name}{there}; {_ELSEWHERE}")

    def _wire(self, name: str, value: Any) -> Any:
        """Return the result of a call for the program."""
        if value is None:
            return _NOTHING.get(name, _UNDEFINED)
        if name == "bot.openContainer":
            window = OpenWindow("the window of a container", lambda: value, "containerItems")
            return self._handle("window", window)
        return _plain(value)

    @property
    def _players(self) -> Any:
        return _plain(
            {name: {"username": name, "entity": self._body(name)} for name in self._reads.agents}
        )

    def _body(self, name: str) -> Any:
        return self._handle("entity", BotBody(name)) if self._reads.is_there(name) else None

    @property
    def _entities(self) -> Any:
        there = filter(self._reads.is_there, self._reads.agents)
        return _plain({str(number): self._body(name) for number, name in enumerate(there, 1)})


def _stacks(items: Mapping[str, int]) -> Iterator[Mapping[str, Any]]:
    """Yield items as they fill slots."""
    for name, count in items.items():
        size = Registry.load().item_stack(name)
        for begin in range(0, count, size):
            yield {"name": name, "count": min(size, count - begin)}


_GETS: Mapping[str, Callable[[JavaScriptProgram], Any]] = {
    "username": lambda program: program._reads.name,
    "entity": lambda program: program._body(program._reads.name),
    "players": lambda program: program._players,
    "entities": lambda program: program._entities,
    "inventory": lambda program: program._handle("window", program._bag),
    "health": lambda program: program._reads.me.health,
    "food": lambda program: program._reads.me.food,
}

_CALLS: Mapping[str, Callable[[JavaScriptProgram, Mapping[str, Any]], Any]] = {
    "blockAt": lambda program, admitted: program._reads.block(tuple(admitted["checked"][0])),
    "chat": lambda program, admitted: program._speak("chat", admitted),
    "whisper": lambda program, admitted: program._speak("whisper", admitted),
    "openContainer": lambda program, admitted: program._open(admitted),
    "openChest": lambda program, admitted: program._open(admitted),
    "closeWindow": lambda program, admitted: _UNDEFINED,
    "waitForTicks": lambda program, admitted: program._promise(
        "waitTicks", admitted, "bot.waitForTicks"
    ),
}

_ACTIONS: Mapping[str, Callable[..., Any]] = {
    "get": JavaScriptProgram._get,
    "set": JavaScriptProgram._set,
    "call": JavaScriptProgram._call,
    "skill": JavaScriptProgram._skill,
    "on": JavaScriptProgram._listen,
    "off": JavaScriptProgram._unlisten,
    "timer": JavaScriptProgram._timer,
    "untimer": lambda *_: None,
    "log": JavaScriptProgram._write,
    "data": JavaScriptProgram._data,
    "keys": JavaScriptProgram._data,
    "state": lambda _, state: state_of(state),
    "settled": JavaScriptProgram._settled,
}


def _plain(value: Any) -> Any:
    """Return plain data for the program; handles stay as they are."""
    if isinstance(value, Mapping) and "$" not in value:
        return {"$": "o", "o": [[key, _plain(each)] for key, each in value.items()]}
    if isinstance(value, list | tuple):
        return [_plain(each) for each in value]
    return value
