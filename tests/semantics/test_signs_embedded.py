"""Signs in Minecraft: written on by bots, believed, forked, edited, kept and replayed."""

from pathlib import Path

import pytest

import beliefnest as bn
from beliefnest.cli.app import run_command_line

SIGN = (4, 1, 3)
ROOM = {
    "name": "note",
    "box": [[0, 0, 0], [12, 4, 8]],
    "blocks": [
        {"block": "stone", "fill": [[0, 0, 0], [12, 0, 8]]},
        {"block": "bricks", "walls": [[7, 1, 0], [7, 3, 7]]},
    ],
    "signs": [{"at": list(SIGN), "text": "apples"}],
    "agents": {"sally": {"position": [2.5, 1, 5.5]}, "anne": {"position": [4.5, 1, 6.5]}},
    "static_blocks": ["stone", "bricks"],
    "script": [
        {"agent": "sally", "program": "await goToPosition(bot, new Vec3(10, 1, 3), 0)"},
        {"agent": "anne", "program": "await writeSign(bot, new Vec3(4, 1, 3), 'no\\napples')"},
    ],
    "expectations": [
        {"path": "/sally", "sign": list(SIGN), "text": "apples"},
        {"path": "/anne", "sign": list(SIGN), "text": "no\napples"},
    ],
}
READ = "console.log(await readSign(bot, new Vec3(4, 1, 3)))"


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Play a run in which a sign is written on, and a memory of it is forked."""
    store = tmp_path_factory.mktemp("run") / "run.bn"
    with bn.Nest.open(bn.Scenario.from_mapping(ROOM), store=store) as nest:
        nest.play()
        assert nest["/anne/sally"].state.signs == {SIGN: "apples"}
        belief = nest["/sally"]
        belief.switch("try")
        assert belief.run("sally", READ).log == ("apples",)
        nest["/"].run("anne", "await mineBlock(bot, new Vec3(4, 1, 3), 'oak_sign')")
        assert nest["/anne"].state.signs == {}
        nest["/"].run("anne", "await placeItem(bot, 'oak_sign', new Vec3(4, 1, 3))")
        assert nest["/"].state.signs == {SIGN: ""}
        belief.edit(signs={SIGN: "edited"})
        assert belief.run("sally", READ).log == ("edited",)
        assert nest["/"].run("anne", READ).log == ("",)
    return store


def test_what_is_written_goes_on_after_a_resume(run: Path) -> None:
    with bn.Nest.resume(run) as nest:
        assert nest["/sally"].run("sally", READ).log == ("edited",)
        assert nest["/"].state.signs == {SIGN: ""}
        nest["/sally"].switch("follow")
        assert nest["/sally"].state.signs == {SIGN: "apples"}


def test_replaying_writes_the_same(run: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command_line(["replay", str(run)]) == 0
    assert "no difference" in capsys.readouterr().out


def test_both_worlds_believe_the_same() -> None:
    scenario = bn.Scenario.from_mapping(ROOM)
    with bn.Nest.open(scenario, world="scripted") as nest:
        nest.play()
        assert nest["/sally"].state.signs == {SIGN: "apples"}
        assert nest["/anne/sally"].state.signs == {SIGN: "apples"}
        assert nest["/anne"].state.signs == {SIGN: "no\napples"}
