"""Programs of literal calls have the outcome that the interpreter gives them."""

import pytest

import beliefnest as bn
from beliefnest.worlds.scripted.literal_program import literal_calls

SKILLS = ("goToPosition", "getItemFromChest", "say", "whisper", "think", "waitTicks", "waitForChat")
LITERAL = [
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


@pytest.mark.parametrize("code", LITERAL)
def test_programs_of_literal_calls_end_as_the_interpreter_ends_them(code: str) -> None:
    assert literal_calls(code, SKILLS) is not None
    outcomes = []
    # An empty statement at the end makes it a program for the interpreter.
    for text in (code, f"{code}\n;;"):
        world = bn.ScriptedWorld(
            ((0, 0, 0), (9, 3, 9)),
            agents={"ann": (1.5, 1, 1.5), "bob": (5.5, 1, 1.5)},
            containers={(4, 1, 4): {"apple": 1}},
        )
        with bn.Nest(world) as nest:
            result = nest["/"].run_all({"ann": text, "bob": "bot.chat('hi')"}, 40)["ann"]
            outcomes.append(
                (result.error, result.ticks, result.happened, result.unfinished, result.aims)
            )
    assert outcomes[0] == outcomes[1]


@pytest.mark.parametrize("code", OTHERS)
def test_all_else_is_for_the_interpreter(code: str) -> None:
    assert literal_calls(code, SKILLS) is None


def test_an_empty_statement_is_for_the_interpreter() -> None:
    assert literal_calls("await say(bot, 'a')\n;;", SKILLS) is None
