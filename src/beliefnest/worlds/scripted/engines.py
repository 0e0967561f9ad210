"""JavaScript engines of the scripted world, and the rule which programs may share one.

Creating an engine takes a millisecond, and a program could read data that an earlier program left
in it. Therefore each program gets a new engine. The exception are programs that only call skills
one after the other with plain values: they read and change nothing in the engine, so that they can
share one.
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

from beliefnest.skills.manifests import skills as all_skills

__all__ = ["MEMORY_BYTES", "Engines", "JavaScriptEngine", "leaves_nothing", "only_acts"]

MEMORY_BYTES = 64 << 20
"""Memory limit of a program."""
_STACK_BYTES = 512 << 10
_SECONDS = 2

# JavaScript's line ends: each ends a comment, and a string literal contains none.
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
# Ways to the bot and to the clock; identifiers may be written with escapes.
_READS = re.compile(r"\b(?:bot|arguments|eval|Date)\b|\\u")


def leaves_nothing(code: str, skills: Collection[str]) -> bool:
    """Return True if a program consists only of successive skill calls with plain values."""
    at = 0
    while call := _CALL.match(code, at):
        if call[1] not in skills:
            return False
        at = call.end()
    return _END.fullmatch(code, at) is not None


def only_acts(code: str, skills: Collection[str]) -> bool:
    """Return True if a program uses its bot as an argument of skills only, and reads no clock.

    Such a program learns about the world only from the results of skills.
    """
    passed = re.sub(rf"\b(?:{'|'.join(skills)})\s*\(\s*bot\s*(?=[,)])", "", code)
    # A skill's name that is left may be defined anew, as a function that reads its bot.
    return _READS.search(passed) is None and not {*skills} & {*re.findall(r"\w+", passed)}


class JavaScriptEngine:
    """JavaScript engine with the scope of a program.

    Args:
        username: The agent that runs the program.
        skills: Names of the skills in scope.
        seed: Seed of its random numbers.

    Attributes:
        call: Function that calls a part of the prelude, given its name and arguments.
        skills: Names of the skills in scope.
        names: Names in scope, separated by commas.
        failed: Exception that is raised if JavaScript fails.
    """

    def __init__(self, username: str, skills: Collection[str], seed: str) -> None:
        import quickjs  # Import here: it takes 10 ms, and most nests run no such program.

        self.failed: type[Exception] = quickjs.JSException
        self._context = quickjs.Context()
        self._context.set_memory_limit(MEMORY_BYTES)
        self._context.set_max_stack_size(_STACK_BYTES)
        self._context.set_time_limit(_SECONDS)
        missing = [each.name for each in all_skills() if not each.scripted]
        given = json.dumps([_words(seed), sorted(skills), missing, username])
        self.call: Callable[..., Any] = self._context.eval(_text())(given)
        self.skills = frozenset(skills)
        self.names: str = ", ".join(json.loads(self.call("names")))

    def read(self, text: str) -> Any:
        """Evaluate a program's text and return its value; raises `failed`."""
        return self._context.eval(text)

    @property
    def draws(self) -> int:
        """Number of random numbers drawn in it."""
        return int(self.call("draws"))

    def reseed(self, seed: str) -> None:
        """Let a seed decide about the random numbers from now on."""
        self.call("reseed", json.dumps(_words(seed)))

    def advance(self) -> bool:
        """Run one pending job. Return False if there was none. Raises `failed`."""
        return bool(self._context.execute_pending_job())


class Engines:
    """Pool of engines whose programs left nothing behind."""

    def __init__(self) -> None:
        self._free: list[JavaScriptEngine] = []

    def take(self, username: str, skills: Collection[str]) -> JavaScriptEngine:
        """Return an engine for a program that leaves nothing behind and draws no random numbers."""
        try:
            engine = self._free.pop()
        except IndexError:
            engine = None
        if engine is None or engine.skills != frozenset(skills):
            return JavaScriptEngine(username, skills, "")
        engine.call("again", username)
        return engine

    def give_back(self, engine: JavaScriptEngine) -> None:
        """Return an engine to the pool after the end of its program."""
        self._free.append(engine)


def _words(seed: str) -> list[int]:
    """Return the first state of the random generator for a seed."""
    return list(struct.unpack("<4i", hashlib.sha256(seed.encode()).digest()[:16]))


@cache
def _text() -> str:
    """Return JavaScript of a function that calls a part of the prelude with arguments as JSON.

    The engine's own clock stays, because it measures real computing time. No function is in
    brackets: the engine reads text after an opening bracket twice, to find out whether an arrow
    follows.
    """
    prelude = (files("beliefnest.worlds.scripted") / "prelude.js").read_text(encoding="utf-8")
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
  let random = sfc32()(words)
  let draws = 0
  Math.random = () => {{ draws += 1; return random.fraction() }}
  const parts = prelude(vec3(), hints(), time, ...others)
  parts.draws = () => draws
  parts.reseed = text => {{ random = sfc32()(JSON.parse(text)) }}
  return (part, one, two, three) => parts[part](one, two, three)
}} }}"""


def _shared(name: str, given: str) -> str:
    """Return JavaScript of a function that a module of the bots' sandbox exports."""
    built = Path(str(files("beliefnest"))) / "_bundle" / f"{name}.js"
    text = built.read_text(encoding="utf-8")
    return f"() => {{ const module = {{}}, env = {{}};\n{text}\nreturn {given} }}"
