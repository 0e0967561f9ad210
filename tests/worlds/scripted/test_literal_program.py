"""Programs of literal calls have the outcome that the interpreter gives them."""

from typing import Any

import pytest

import beliefnest as bn
from beliefnest.timeline.run_records import Senses
from beliefnest.worlds.scripted.literal_program import literal_calls

SKILLS = (
    "goToPosition",
    "openContainer",
    "getItemFromChest",
    "say",
    "whisper",
    "think",
    "waitTicks",
    "waitForChat",
)


CHEST, MORE, WALLED, BARE = (4, 1, 4), (7, 1, 2), (0, 1, 9), (6, 1, 6)
"""A chest, a second one, one that cannot be reached, and a place without."""
OPENING = f"await bot.openContainer(bot.blockAt(new Vec3{CHEST}))"
LITERAL = [
    f"await openContainer(bot, new Vec3{CHEST})",
    f"await openContainer(bot, new Vec3{MORE})\nawait openContainer(bot, new Vec3{BARE})",
    f"await openContainer(bot, new Vec3{WALLED})\nawait openContainer(bot, new Vec3{CHEST})",
    "await openContainer(bot, new Vec3(4.5, 1.25, 4.5))",
    "await openContainer(bot, new Vec3(400, 1, 4))",
    "",
    "// nothing",
    "await goToPosition(bot, new Vec3(-2, 51, 0.5), 0);",
    "await say(bot, 'it is {here}')\n// a word\nawait say(bot, \"it's\")",
    'await getItemFromChest(bot, new Vec3(1, 1, 2), {"oak_log": 1, diamond: 2});  ',
    "await goToPosition(bot, new Vec3(3, 1, 3))\n\n  await think(bot, 3)",
    "await say(bot, '')",
    "await say(bot)",
    "await waitTicks(bot, 2); await waitTicks(bot, 1.5)",
    "await goToPosition(bot, new Vec3(400000000, 1, 1))",
    "await goToPosition(bot, new Vec3(3, 1, 3), -1)",
    "await getItemFromChest(bot, new Vec3(1, 1, 2), {apple: 0})",
    "await getItemFromChest(bot, new Vec3(4, 1, 4), {apple: 1})\r\nawait say(bot, 'gone')",
    "await waitTicks(bot, 500)",
    "await waitForChat(bot, 3)",
    "await say(bot, 'it is there', [located('apple', new Vec3(4, 1, 4))])",
    "await whisper(bot, 'bob', 'gone', [absent('apple', new Vec3(4, 1, 4)), "
    "positionOf('ann', new Vec3(1.5, 1, 1.5)), blockAt(new Vec3(4, 1, 4), 'chest[facing=west]')])",
    "await say(bot, 'no such thing', [located('appel', new Vec3(4, 1, 4))])",
    "await say(bot, 'mixed up', [located(new Vec3(4, 1, 4), 'apple')])",
    "await say(bot, 'mixed up', [blockAt('stone', new Vec3(4, 1, 4))])",
    "await say(bot, 'far', [located('apple', new Vec3(400, 1, 4))])",
    "await goToPosition(bot, [located('apple', 3)])",
    "await say (bot, '\u00e9\u2028') // \U0001f680\r\n// more\nawait say(bot, '', )",
]
OTHERS = [
    f"const container = {OPENING}\ncontainer.close()",
    OPENING,
    "await bot.openContainer(bot, new Vec3(4, 1, 4))",
    "{ await say(bot, 'a') }",
    "{ }",
    "await\rwaitTicks(bot, 500)",
    "globalThis.leak = 1;",
    "await say(bot, [].constructor.constructor('leak = 1')());",
    "await say(bot, `${Array.prototype.leak = 1}`);",
    "await say(bot, 'a' + (globalThis.leak = 1));",
    "// a line's end\u2028globalThis.leak = 1;",
    "await say(bot, 'a\\'); globalThis.leak = 1; //');",
    "await say(bot, {get a() { leak = 1 }});",
    "await say(bot, bot.players);",
    "await other(bot);",
    "await goToPosition(bot, new Vec3(1, 2, 3)).then(() => { leak = 1 });",
    "say(bot, 'not awaited');",
    "async function f(bot) { await say(bot, 'a'); }",
    "const x = 1;",
    "await waitTicks(bot, 010)",
    "await waitTicks(bot, 1e3)",
    "await waitTicks(bot, 0x10)",
    "await goToPosition(bot, new Vec3(-0, 1, 1))",
    "await getItemFromChest(bot, new Vec3(1, 1, 1), {__proto__: 1})",
    "await getItemFromChest(bot, new Vec3(1, 1, 1), {'2': 1, '1': 1})",
    "await say(bot, 'a')\n" * 201,
    "await say(bot, 'a') await say(bot, 'b')",
    "await\u200bsay(bot, 'a')",
    "await say(bot, '\ud800')",
    "await say(bot, 'a\rb')",
    "await say?.(bot, 'a')",
    "await waitTicks(bot, - -1)",
    "await waitTicks(bot, +1)",
    "await goToPosition(bot, new Vec3(1, 2))",
    "await goToPosition(bot, new Box(1, 2, 3))",
    "await getItemFromChest(bot, new Vec3(1, 1, 1), {})",
    "await say(bot, 'a', [located('apple')])",
    "await say(bot, 'a', [located('apple', new Vec3(1, 1, 1), leak = 1)])",
    "await say(bot, 'a', [located?.('apple', new Vec3(1, 1, 1))])",
    "await say(bot, 'a', [found('apple', new Vec3(1, 1, 1))])",
    "await say(bot, 'a', [, located('apple', new Vec3(1, 1, 1))])",
    "await say(bot, 'a', [located('apple', new Vec3(1, 1, 1)),, ])",
    "await say(bot, 'a', [,])",
    "await say(bot, 'a', [...located('apple', new Vec3(1, 1, 1))])",
    "await say(bot, 'a', [located('apple', [])])",
    "await say(bot, 'a', [])",
    "await say(bot, 'a', [located('apple', new Vec3(1, 1, 1)),])",
    "await say(bot, 'a', [located('apple', new Vec3(1, 1, 1)), // here\n])",
    "await say(bot, 'a', ['apple'])",
    "await say(bot, 'a', located('apple', new Vec3(1, 1, 1)))",
    "<!-- a\nawait say(bot, 'a')",
]


def played(code: str, bob: str, senses: Senses, timeout_ticks: int) -> list[Any]:
    """Return all that a program of Ann leaves behind, while Bob plays his."""
    sides = {(x, y, z): "stone" for x in (0, 1) for y in (1, 2) for z in (8, 9)}
    del sides[WALLED]
    floor = {(x, 0, z): "stone" for x in range(10) for z in range(10)}
    world = bn.ScriptedWorld(
        ((0, 0, 0), (9, 3, 9)),
        {**floor, **sides, (7, 1, 5): "air", (9, 1, 9): "barrel"},
        agents={"ann": (1.5, 1, 1.5), "bob": (5.5, 1, 1.5)},
        containers={CHEST: {"apple": 1}, MORE: {"oak_log": 2}, WALLED: {}},
    )
    with bn.Nest(world) as nest:
        programs = {"ann": code, "bob": bob}
        result = nest["/"].run_all(programs, timeout_ticks, senses, past={})["ann"]
        views = [nest[path].state for path in ("/", "/ann", "/bob", "/ann/bob")]
        return [result, nest["/"].tick, *views]


@pytest.mark.parametrize("senses", ["world", "percepts"])
@pytest.mark.parametrize("code", LITERAL)
def test_programs_of_literal_calls_end_as_the_interpreter_ends_them(
    code: str, senses: Senses
) -> None:
    assert literal_calls(code, SKILLS) is not None
    # An empty statement at the end makes it a program for the interpreter.
    first, second = (played(text, "bot.chat('hi')", senses, 40) for text in (code, f"{code}\n;;"))
    assert first == second


def test_a_time_that_ends_while_containers_are_opened_makes_no_difference() -> None:
    code = f"await openContainer(bot, new Vec3{CHEST})\nawait openContainer(bot, new Vec3{MORE})"
    unfinished = set()
    for ticks in range(1, 5):
        first, second = (played(text, "", "percepts", ticks) for text in (code, f"{code}\n;;"))
        assert first == second
        unfinished |= {(each.what, each.line) for each in first[0].unfinished}
    assert unfinished == {("openContainer", 1), ("openContainer", 2)}


@pytest.mark.parametrize("code", OTHERS)
def test_all_else_is_for_the_interpreter(code: str) -> None:
    assert literal_calls(code, SKILLS) is None


def test_an_empty_statement_is_for_the_interpreter() -> None:
    assert literal_calls("await say(bot, 'a')\n;;", SKILLS) is None
