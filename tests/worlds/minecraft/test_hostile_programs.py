"""Programs that once ended the caller, Node, or another agent's program."""

import json
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.profiles import NIGHTLY

import beliefnest as bn
from beliefnest.cli.app import run_command_line

HALF = "'😀'.slice(0, 1)"
TEXTS = {
    "console": f"console.log({HALF})",
    "chat": f"bot.chat({HALF})",
    "think": f"await think(bot, {HALF})",
    "emote": f"await emote('sally', {HALF})",
    "whisper": f"await whisper(bot, 'anne', {HALF})",
    "throw": f"throw {HALF}",
    "error": f"throw new Error({HALF})",
    "name of an error": f"const e = new Error(''); e.name = {HALF}; throw e",
    "argument": f"await getItemFromChest(bot, {HALF}, {{}})",
}
WORK = {
    "lines": "0\n" * 20_000,
    "lines without end": "0\n" * 99_999,
    "a name of the program": "__ran" + "_" * 39_000,
    "names": "let a" + "".join(f",a{n}" for n in range(5000)),
    "a stack": "const e = new Error('x'); "
    "e.stack = ('at x (program.js:1:9)\\n').repeat(1e5); throw e",
    "an error of a long text": "throw new Error('x'.repeat(1e7))",
    "goals": "bot.pathfinder.setGoal(new goals.GoalCompositeAny(Array.from({length: 95}, () => "
    "new goals.GoalCompositeAny(Array(100).fill(new goals.GoalLookAtBlock(new Vec3(5, 1, 5), "
    "bot.world, {reach: 256}))))))",
    "goals in a message": "await goToPosition(bot, "
    "{a: new goals.GoalLookAtBlock(new Vec3(5, 1, 5), bot.world)})",
    "bodies in a message": "await goToPosition(bot, {a: bot.players.anne.entity})",
    "a forged skill": "Object.prototype.toJSON = function () { return this.message === 'x' "
    "? {message: 'x', skill: 'y'.repeat(9e5)} : this }; throw new Error('x')",
    "timers": "Array.prototype.toJSON = () => ['timer', 7, 1e6, true]; "
    "for (let i = 0; i < 5000; i++) try { bot.health } catch {}\nthrow 1",
}


@pytest.fixture(scope="module")
def nest() -> Iterator[bn.Nest]:
    with bn.Nest.open(bn.Scenario.load("sally-anne", 3), seed=0) as opened:
        yield opened


def _unharmed(nest: bn.Nest, code: str) -> bn.ProgramResult:
    """Return the result of a program beside which another runs, and after which another does."""
    before = nest["/"].tick
    results = nest["/"].run_all({"sally": code, "anne": "await waitTicks(bot, 3)"}, 60)
    assert results["anne"].error is None
    assert nest["/"].tick - before <= 61
    assert nest["/"].run("sally", "await waitTicks(bot, 1)").ok
    error = results["sally"].error
    assert error is None or len(error.message) + len(error.skill or "") < 4200
    return results["sally"]


@pytest.mark.parametrize("code", TEXTS.values(), ids=TEXTS)
def test_half_a_character_harms_nobody(nest: bn.Nest, code: str) -> None:
    result = _unharmed(nest, code)
    told = json.dumps(
        [result.log, result.error and result.error.message, repr(result.events)],
        ensure_ascii=False,
    )
    assert told.encode()


@pytest.mark.parametrize("code", WORK.values(), ids=WORK)
def test_work_without_end_harms_nobody(nest: bn.Nest, code: str) -> None:
    _unharmed(nest, code)


def test_half_a_character_in_a_programs_text_is_wrong_input(nest: bn.Nest) -> None:
    before = nest["/"].tick
    with pytest.raises(bn.InputError, match="the program of sally has half a character"):
        nest["/"].run("sally", "console.log('\ud83d')")
    assert nest["/"].tick == before


@pytest.mark.parametrize("way", TEXTS if NIGHTLY else ["console", "think"])
def test_a_run_survives_half_a_character(
    way: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("room.yaml").write_text(
        "name: room\nbox: [[0, 0, 0], [6, 3, 6]]\n"
        "blocks:\n  - {block: stone, fill: [[0, 0, 0], [6, 0, 6]]}\n"
        "agents:\n  sally: {position: [1.5, 1, 1.5]}\n  anne: {position: [3.5, 1, 1.5]}\n"
        f"script:\n  - agent: sally\n    program: |\n      {TEXTS[way]}\n",
        encoding="utf-8",
    )
    status = run_command_line(["run", "room.yaml", "--out", "r", "--json"])
    assert status == 0
    assert json.loads(capsys.readouterr().out)["runs"][0]["ok"]
