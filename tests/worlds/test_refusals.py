"""Both worlds refuse the same, with the same kind, message and place."""

from collections.abc import Iterator
from typing import Any

import pytest
from tests.shared_worlds import WORLDS

import beliefnest as bn
from beliefnest.skills import skills

pytestmark = pytest.mark.usefixtures("kept_worlds")

ROOM: dict[str, Any] = {
    "name": "room",
    "box": [[0, 0, 0], [9, 3, 6]],
    "agents": {
        "ann": {"position": [1.5, 1, 3.5], "inventory": {"dirt": 2}},
        "bob": {"position": [7.5, 1, 3.5]},
    },
    "blocks": [{"block": "stone", "fill": [[0, 0, 0], [9, 0, 6]]}],
    "containers": [{"at": [3, 1, 3], "items": {"apple": 1}}],
}

HERE = "new Vec3(3, 1, 3)"
NO_PLACES = ["", "3", "'here'", "null", "new Vec3(1, 2)", "new Vec3(NaN, 1, 1)", "[1, 1, 1]"]
NO_PLACES += ["{x: 1, y: 1}", "new Vec3(0, 1e9, 0)", "new Vec3('1', 1, 1)", "(1, 2, 3)", "true"]
NO_PLACES += ["() => 1", "bot", "bot.entity", "{x: 1, y: 1, z: Infinity}", "new goals.GoalY(1)"]
NO_ITEMS = ["", "'apple'", "{}", "[]", "['apple']", "{appel: 1}", "{Apple: 1}", "{apple: 0}"]
NO_ITEMS += ["{apple: -1}", "{apple: 1.5}", "{apple: NaN}", "{apple: '1'}", "{apple: null}"]
NO_ITEMS += ["{apple: 1, nothing_such: 2}", "{constructor: 1}", "new Map()", "{apple: {}}"]
NO_NAMES = ["", "3", "null", "'diamont'", "'Dirt'", "'x'.repeat(300)", "{}", "['dirt']", "''"]
NO_COUNTS = ["0", "-1", "1.5", "NaN", "Infinity", "'2'", "null", "{}"]
NO_TEXTS = [
    "",
    "3",
    "''",
    "'  '",
    "null",
    "'x'.repeat(257)",
    "'a\\nb'",
    "'a\\u2028b'",
    "'\\u202eb'",
]
NO_TEXTS += ["'\\u0000'", "['hi']", "{}", "'😀'.repeat(129)", "'x'.repeat(200000)"]
NO_CLAIMS = [
    "3",
    "[3]",
    "[{}]",
    "{}",
    "['x']",
    "[located('appel', new Vec3(1, 1, 1))]",
    "[absent()]",
]
NO_CLAIMS += ["[located('apple', 3)]", "[positionOf('a b', new Vec3(1, 1, 1))]"]
NO_CLAIMS += ["[blockAt(new Vec3(1, 1, 1), 'oak_door[open=maybe]')]", "Array(17).fill({})"]
NO_CLAIMS += ["[blockAt(new Vec3(1, 1, 1), 'nothing')]", "[{kind: 'constructor'}]"]
NO_DOORS = ["3", "{open: true}", "{openDoors: 1}", "[]", "'closeDoors'"]
NO_AGENTS = ["", "3", "'carl'", "'ann'", "null", "'Bob'", "{}"]

PLACE_ALONE = [
    *("openContainer", "openDoor", "closeDoor", "turnOnLever", "turnOffLever", "pressButton"),
    "readSign",
]
WITH_ITEMS = ["getItemFromChest", "depositItemIntoChest"]


def _calls(skill: str, before: str, values: list[str], after: str = "") -> list[str]:
    """Return calls with each value in one place among the arguments."""
    return [
        f"await {skill}({', '.join(part for part in ('bot', before, value) if part)}{after})"
        for value in values
    ]


ARGUMENTS = [
    *(
        call
        for name in [*PLACE_ALONE, "lookAt", "goToPosition"]
        for call in _calls(name, "", NO_PLACES)
    ),
    *(call for name in WITH_ITEMS for call in _calls(name, HERE, NO_ITEMS)),
    *(call for name in WITH_ITEMS for call in _calls(name, "", NO_PLACES[1:], ", {apple: 1}")),
    *_calls("goToPosition", HERE, ["-1", "NaN", "'2'", "null", "Infinity"]),
    *_calls("goToPosition", f"{HERE}, 2", NO_DOORS),
    *_calls("mineBlock", HERE, NO_NAMES),
    *_calls("mineBlock", "", NO_PLACES, ", 'dirt'"),
    *_calls("placeItem", "", NO_NAMES[1:], f", {HERE}"),
    *_calls("placeItem", "'dirt'", NO_PLACES),
    *_calls("writeSign", "", NO_PLACES[1:], ", 'hi'"),
    *_calls("writeSign", HERE, ["", "3", "'x'.repeat(46)", "['a', 3]", "'a\\n'.repeat(5)"]),
    *_calls("writeSign", f"{HERE}, 'hi'", NO_CLAIMS),
    *_calls("giveItemToOther", "", NO_AGENTS, ""),
    *_calls("giveItemToOther", "'bob'", NO_NAMES),
    *_calls("giveItemToOther", "'bob', 'dirt'", NO_COUNTS),
    *(call for name in ("say", "think") for call in _calls(name, "", NO_TEXTS)),
    *_calls("say", "", ["'/tell bob x'", "' /x'"]),
    *_calls("say", "'hi'", NO_CLAIMS),
    *_calls("whisper", "", NO_AGENTS, ", 'hi'"),
    *_calls("whisper", "'bob'", NO_TEXTS),
    *_calls("waitTicks", "", ["", *NO_COUNTS]),
    *_calls("waitForChat", "", NO_COUNTS),
]
BOT = [
    *(f"bot.chat({text})" for text in NO_TEXTS),
    *(f"bot.whisper('bob', {text})" for text in NO_TEXTS),
    *(f"bot.whisper({name}, 'hi')" for name in ("", "3", "'a b'", "''", "'x'.repeat(17)")),
    *(f"bot.blockAt({place})" for place in NO_PLACES),
    *(f"await bot.openContainer({block})" for block in ("", "3", HERE, "null", "{}")),
    *(
        f"await bot.waitForTicks({ticks})"
        for ticks in ("", "-1", "NaN", "'1'", "1e9", "0.5", "2.5")
    ),
    "bot.whisper('bob', 'x'.repeat(231))",
    *(f"bot.on({event}, () => {{}})" for event in ("'nothing'", "''", "3", "'__proto__'")),
    "bot.on('chat')",
    "bot.on('chat', 3)",
    "bot.goto(3)",
    "bot.take('apple')",
    "await bot.nothing",
    "bot.username = 'bob'",
    "bot.chat.call({}, 'hi')",
    "bot.entity.nothing.more",
    "bot.inventory.nothing()",
    "for (let n = 0; n < 101; n++) bot.on('chat', () => {})",
    "for (let n = 0; n < 101; n++) doNothing(bot)",
    "for (let n = 0; n < 5000; n++) bot.chat('n' + n)",
    "await Promise.all(Array.from({length: 21}, (_, n) => think(bot, 'n' + n)))",
]
SLIPS = [
    "await getItemFromChest(new Vec3(3, 1, 3), {apple: 1})",
    "await say('hi')",
    "await say({...bot}, 'hi')",
    "await goToPositon(bot, new Vec3(1, 1, 1))",
    "await moveTo(bot, 1)",
    "pathfinder.goto(1)",
    "new GoalNear(1, 1, 1, 1)",
    "require('fs')",
    "Promise.reject(new Error('boo'))",
    "Promise.reject(3)",
    "(async () => { throw new TypeError('boo') })(); await waitTicks(bot, 3)",
    "goToPosition(bot, 3); await waitTicks(bot, 3)",
    "const chest = bot.openContainer(bot.blockAt(new Vec3(3, 1, 3)))\nchest.containerItems()",
    "await new Promise(() => {})",
    "throw 3",
    "throw null",
    "throw {message: 'x'}",
    "\n\n  null.x",
    "undefined()",
    "const a = 1; a = 2",
    "const = 3",
    "let x = ;",
    "{",
    "await await",
    "import('fs')",
    "import fs from 'fs'",
    "async function (bot) { }",
    "function one(bot) {}\nasync function two(bot) { throw new Error('two') }",
    "await bot.chat('x'.repeat(300))",
    "//" + "x" * 50_000,
    "\n" * 3000 + "bot.chat('hi')",
    "return 3",
    "await say(bot, Symbol('x'))",
    "await say(bot, 3n)",
    "await say(bot, Promise.resolve('hi'))",
    "let a = []; for (let n = 0; n < 99; n++) a = [a]; await say(bot, a)",
    "await say(bot, 'x'.repeat(1e6))",
]
LIMITS = [
    "for (;;) {}",
    "[].reverse.call({length: 2 ** 53 - 1})",
    "(function f() { f() })()",
    "const all = []; for (;;) all.push(new Array(1000).fill(1))",
    "'x'.repeat(2 ** 29)",
    "JSON.parse('['.repeat(1e6))",
]

EXCEPTIONS = {
    "await mineBlock(bot, new Vec3('1', 1, 1), 'dirt')": "the advice names bot.findBlock, "
    "which the scripted world lacks",
}
"""Programs whose messages the worlds cannot share, with the reason."""


@pytest.fixture(scope="module")
def nests() -> Iterator[dict[str, bn.Nest]]:
    scenario = bn.Scenario.from_mapping(ROOM)
    opened = {world: bn.Nest.open(scenario, world=world) for world in WORLDS}
    yield opened
    for nest in opened.values():
        nest.close()


def _told(nest: bn.Nest, code: str) -> tuple[object, ...]:
    result = nest["/"].run("ann", code, timeout_ticks=60)
    fault = result.error
    if fault is None:
        return (True, len(result.said))
    return (fault.kind, fault.message, fault.line, fault.column, fault.skill)


def _differences(nests: dict[str, bn.Nest], codes: list[str]) -> dict[str, tuple[object, object]]:
    found = {}
    for code in codes:
        scripted, embedded = (_told(nests[world], code) for world in ("scripted", "embedded"))
        if scripted != embedded and code not in EXCEPTIONS:
            found[code] = (scripted, embedded)
    return found


@pytest.mark.parametrize(
    "codes", [ARGUMENTS, BOT, SLIPS, LIMITS], ids=["arguments", "bot", "slips", "limits"]
)
def test_both_worlds_refuse_the_same(nests: dict[str, bn.Nest], codes: list[str]) -> None:
    assert _differences(nests, codes) == {}


def test_every_skill_of_the_scripted_world_is_tried() -> None:
    tried = {code.partition("(")[0].removeprefix("await ") for code in ARGUMENTS}
    there = {each.name for each in skills() if each.scripted}
    assert there - tried == {"doNothing"}
