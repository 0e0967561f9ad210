"""JavaScript engines of the scripted world, and which programs may have one that was used.

An engine takes a millisecond to make, and what one program leaves in it, the next could find. So
each program gets a new one, but for those that only call skills one after the other with plain
values: they read nothing there and change nothing, and one engine serves any number of them.
"""

import hashlib
import json
import re
import struct
from collections.abc import Callable, Collection
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

__all__ = ["MEMORY_BYTES", "Engines", "JavaScriptEngine", "leaves_nothing"]

MEMORY_BYTES = 64 << 20
"""What a program may take."""
_STACK_BYTES = 512 << 10
_SECONDS = 2

# Whatever ends a line for JavaScript ends a comment, and is in no text.
_ENDS = r"\n\r\u2028\u2029"
_GAP = rf"(?:\s|//[^{_ENDS}]*+(?:[{_ENDS}]|\Z))*+"
_WORD = r"[A-Za-z]\w*+"
_NUMBER = r"-?\d++(?:\.\d++)?+"
_TEXT = rf"""(?:"[^"\\{_ENDS}]*+"|'[^'\\{_ENDS}]*+')"""
_PLACE = rf"new\s+Vec3\s*\(\s*{_NUMBER}\s*,\s*{_NUMBER}\s*,\s*{_NUMBER}\s*\)"
_ITEM = rf"(?:{_WORD}|{_TEXT})\s*:\s*{_NUMBER}"
_ITEMS = rf"\{{\s*{_ITEM}\s*(?:,\s*{_ITEM}\s*)*+\}}"
_VALUE = rf"(?:{_NUMBER}|{_TEXT}|{_PLACE}|{_ITEMS})"
_CALL = re.compile(rf"{_GAP}await\s+({_WORD})\s*\(\s*bot\s*(?:,\s*{_VALUE}\s*)*+\)\s*;?", re.ASCII)
_END = re.compile(_GAP, re.ASCII)


def leaves_nothing(code: str, skills: Collection[str]) -> bool:
    """Whether a program is nothing but calls of skills with plain values, one after the other."""
    at = 0
    while call := _CALL.match(code, at):
        if call[1] not in skills:
            return False
        at = call.end()
    return _END.fullmatch(code, at) is not None


class JavaScriptEngine:
    """An engine of JavaScript, and what a program finds in scope.

    Args:
        username: The agent that runs the program.
        skills: Names of the skills in scope.
        seed: Decides about random numbers.

    Attributes:
        call: Given the name of a part of the prelude and its arguments, calls it.
        skills: Names of the skills in scope.
        names: What is in scope, with commas between.
        failed: What is raised where JavaScript fails.
    """

    def __init__(self, username: str, skills: Collection[str], seed: str) -> None:
        import quickjs  # takes 10 ms, and most nests run no such program

        self.failed: type[Exception] = quickjs.JSException
        self._context = quickjs.Context()
        self._context.set_memory_limit(MEMORY_BYTES)
        self._context.set_max_stack_size(_STACK_BYTES)
        self._context.set_time_limit(_SECONDS)
        words = struct.unpack("<4i", hashlib.sha256(seed.encode()).digest()[:16])
        given = json.dumps([list(words), sorted(skills), username])
        self.call: Callable[..., Any] = self._context.eval(_text())(given)
        self.skills = frozenset(skills)
        self.names: str = ", ".join(json.loads(self.call("names")))

    def read(self, text: str) -> Any:
        """Return the value of a program's text; raises `failed`."""
        return self._context.eval(text)

    def advance(self) -> bool:
        """Do one thing that waits to be done; whether there was any. Raises `failed`."""
        return bool(self._context.execute_pending_job())


class Engines:
    """Engines that programs had which leave nothing behind, kept for the next of them."""

    def __init__(self) -> None:
        self._free: list[JavaScriptEngine] = []

    def take(self, username: str, skills: Collection[str]) -> JavaScriptEngine:
        """An engine for an agent's program that leaves nothing behind, and draws no numbers."""
        try:
            engine = self._free.pop()
        except IndexError:
            engine = None
        if engine is None or engine.skills != frozenset(skills):
            return JavaScriptEngine(username, skills, "")
        engine.call("again", username)
        return engine

    def give_back(self, engine: JavaScriptEngine) -> None:
        """Take back the engine of such a program, which has ended."""
        self._free.append(engine)


@cache
def _text() -> str:
    """What calls a part of the prelude: a function of what `JavaScriptEngine` gives it, as JSON.

    The engine's own clock goes: it tells how long this machine takes. No function is in brackets:
    those that open with one are read twice, to see whether an arrow comes after them.
    """
    prelude = (files("beliefnest.bodies") / "scripted_prelude.js").read_text(encoding="utf-8")
    return f"""{{
const time = {{ ms: 0 }}
const vec3 = {_shared("vec3", "(module.exports(env), env.Vec3)")}
const hints = {_shared("hints", "module.exports")}
const sfc32 = {_shared("sfc32", "module.exports")}
const date = {_shared("date", "module.exports")}
const prelude = {prelude}
date()({{ now: () => time.ms }})
delete globalThis.performance
given => {{
  const [words, ...others] = JSON.parse(given)
  const random = sfc32()(words)
  Math.random = () => random.fraction()
  const parts = prelude(vec3(), hints(), time, ...others)
  return (part, one, two, three) => parts[part](one, two, three)
}} }}"""


def _shared(name: str, given: str) -> str:
    """Return a function that gives what a module of the bots' sandbox does, too."""
    built = Path(str(files("beliefnest"))) / "_bundle" / f"{name}.js"
    text = built.read_text(encoding="utf-8")
    return f"() => {{ const module = {{}}, env = {{}};\n{text}\nreturn {given} }}"
