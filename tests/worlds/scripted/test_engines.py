"""Engines of the scripted world's programs: which may be used again, and that nothing leaks."""

import pytest

import beliefnest as bn
from beliefnest.worlds.scripted.engines import Engines, leaves_nothing, only_acts
from beliefnest.worlds.scripted.javascript_program import JavaScriptProgram

SKILLS = ("goToPosition", "getItemFromChest", "say")

PLAIN = [
    "",
    "// nothing",
    "await goToPosition(bot, new Vec3(-2, 51, 0.5), 0);",
    "await say(bot, 'it is {here}')\n// a word\nawait say(bot, \"it's\")",
    'await getItemFromChest(bot, new Vec3(1, 2, 3), {"oak log": 1, diamond: 2});  ',
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
]


@pytest.mark.parametrize("code", PLAIN)
def test_calls_with_plain_values_leave_nothing(code: str) -> None:
    assert leaves_nothing(code, SKILLS)


@pytest.mark.parametrize("code", OTHERS)
def test_all_else_may_leave_something(code: str) -> None:
    assert not leaves_nothing(code, SKILLS)


@pytest.mark.parametrize(
    ("code", "only"),
    [
        (
            "for (let i = 0; i < 3; i++) await goToPosition(bot, new Vec3(Math.random(), 1, 1))",
            True,
        ),
        ("await say( bot , 'so'); const robot = 1", True),
        ("await say(bot, bot.username)", False),
        ("const me = bot; await say(me, me.username)", False),
        ("await say(bot, `${new Date()}`)", False),
        ("await say(bot, arguments[0].username)", False),
        ("await say(bot, b\\u006ft.username)", False),
        ("await say(bot, eval('b' + 'ot').username)", False),
        ("notsay(bot)", False),
        ("{ const say = robot => robot.username; say(bot) }", False),
        ("(say => say(bot))(robot => robot.username)", False),
    ],
)
def test_a_program_that_gives_its_bot_to_skills_alone_reads_nothing(code: str, only: bool) -> None:
    assert only_acts(code, SKILLS) is only
    assert JavaScriptProgram("ann", SKILLS, code, "0", Engines()).reads is not only
    whole = f"async function (robot) {{ {code} }}"
    assert JavaScriptProgram("ann", SKILLS, whole, "0", Engines()).reads


def test_programs_that_leave_nothing_have_one_engine_after_the_other_and_no_other_has_it() -> None:
    engines = Engines()
    engine = engines.take("bob", SKILLS)
    engines.give_back(engine)
    for code in (PLAIN[2], PLAIN[3]):
        program = JavaScriptProgram("ann", SKILLS, code, "0", engines)
        program.start()
        while calls := program.calls():
            for number, _, _ in calls:
                program.settle(number, ok=True, value=None)
        assert program.ended and program.fault is None
        program.end()
        assert engines.take("bob", SKILLS) is engine
        engines.give_back(engine)
    other = JavaScriptProgram("ann", SKILLS, "Array.prototype.leak = 1", "0", engines)
    other.start()
    other.end()
    assert other.ended and other.fault is None
    assert engines.take("bob", SKILLS) is engine
    assert engines.take("bob", SKILLS) is not engine


def test_an_engine_whose_program_waits_still_is_not_used_again() -> None:
    engines = Engines()
    engine = engines.take("bob", SKILLS)
    engines.give_back(engine)
    program = JavaScriptProgram("ann", SKILLS, "await say(bot, 'a');", "0", engines)
    program.start()
    program.end()
    assert engines.take("bob", SKILLS) is not engine


def test_no_program_finds_what_another_left() -> None:
    world = bn.ScriptedWorld(((0, 0, 0), (4, 3, 4)), agents={"ann": (1.5, 1, 1.5)})
    leave = """
        await say(bot, 'a');
        globalThis.leak = 1; Array.prototype.leak = 1; Promise.prototype.then.leak = 1;
        Vec3.prototype.leak = 1; JSON.stringify = () => 'leak'; bot.leak = 1;
    """
    look = """
        const found = [globalThis, [], Promise.prototype.then, Vec3.prototype, bot];
        return console.log(found.map(each => 'leak' in each), JSON.stringify([1]));
    """
    with bn.Nest(world) as nest:
        for code in ("await say(bot, 'a');", leave, "await say(bot, 'b');", look):
            result = nest["/"].run("ann", code)
            assert result.ok, result.error
        assert result.log == ("[false,false,false,false,false] [1]",)
        assert [text for _, _, text in nest["/"].state.chat] == ["a", "a", "b"]


def test_time_is_the_world_s_and_random_numbers_are_the_seed_s() -> None:
    code = """
        console.log(Date.now(), new Date().toString(), new Date().getHours())
        await waitTicks(bot, 20)
        console.log(new Date().toISOString(), Math.random())
    """

    def logged(seed: int) -> tuple[str, ...]:
        scenario = bn.Scenario.from_mapping(
            {
                "name": "room",
                "box": [[0, 0, 0], [2, 2, 2]],
                "agents": {"ann": {"position": [1.5, 0, 1.5]}},
            }
        )
        with bn.Nest.open(scenario, "scripted", seed=seed) as nest:
            return nest["/"].run("ann", code).log

    first, second = logged(3)
    assert first == "1704067200000 Mon, 01 Jan 2024 00:00:00 GMT 0"
    assert second.startswith("2024-01-01T00:00:01.0")
    assert logged(3) == (first, second)
    assert logged(4)[1] != second
