"""A program that is cut at the end of a round goes on in the next, if its policy wants that."""

from pathlib import Path
from typing import Any

import msgspec
import pytest
from tests.shared_worlds import WORLDS

import beliefnest as bn
from beliefnest.episodes.policies import Program, Scripted

pytestmark = pytest.mark.usefixtures("kept_worlds")

ERRAND = """
await say(bot, 'I begin.')
await waitTicks(bot, 15)
await goToPosition(bot, new Vec3(6, 1, 5), 0)
for (let n = 0; n < 3; n++) { bot.chat(`number ${n}`); await waitTicks(bot, 4) }
await depositItemIntoChest(bot, new Vec3(7, 1, 5), {apple: 1})
"""


def errand(round_ticks: int) -> bn.Task:
    content: dict[str, Any] = {
        "name": "errand",
        "scenario": {
            "name": "errand",
            "box": [[0, 0, 0], [8, 3, 6]],
            "blocks": [{"block": "stone", "fill": [[0, 0, 0], [8, 0, 6]]}],
            "static_blocks": ["stone"],
            "containers": [{"at": [7, 1, 5]}],
            "agents": {"ann": {"position": [1.5, 1, 1.5], "inventory": {"apple": 1}}},
        },
        "goal": {"reach": [{"container": [7, 1, 5], "items": {"apple": 1}}]},
        "talk": ["ann"],
        "rounds": 200 // round_ticks,
        "round_ticks": round_ticks,
    }
    return bn.Task.from_mapping(content)


def played(round_ticks: int, world: str = "scripted", store: Path | None = None) -> bn.Episode:
    return bn.Episode(errand(round_ticks), {"ann": Program(ERRAND)}, world=world, store=store)


def said(episode: bn.Episode) -> list[str]:
    return [text for _, _, text in episode.nest["/"].state.chat]


@pytest.mark.parametrize("world", WORLDS)
def test_a_program_goes_on_where_it_was_cut(world: str) -> None:
    with played(10, world) as cut:
        # Rounds are longer where one walks as people do.
        cut.task = errand(10)
        assert cut.play().success
        assert said(cut) == ["I begin.", "number 0", "number 1", "number 2"]
        assert [part.decisions["ann"].goes_on for part in cut.parts][:2] == [False, True]


@pytest.mark.parametrize("round_ticks", [1, 7])
def test_it_takes_as_long_as_if_it_had_not_been_cut(round_ticks: int) -> None:
    with played(200) as whole, played(round_ticks) as cut:
        assert whole.play().success
        assert cut.play().success
        assert cut.ticks == whole.ticks
        assert cut.nest["/"].state.chat == whole.nest["/"].state.chat


@pytest.mark.parametrize("skill", ["say(bot, 'It is here.')", "waitForChat(bot, 20)"])
def test_what_takes_longer_than_a_round_in_one_place_ends_all_the_same(skill: str) -> None:
    content = msgspec.to_builtins(errand(6).form)
    content["scenario"]["perception"] = {"speech_ticks": 20}
    code = f"await {skill}; await goToPosition(bot, new Vec3(6, 1, 5), 0)"
    with bn.Episode(bn.Task.from_mapping(content), {"ann": Program(code)}) as episode:
        assert [part.ended["ann"].how for part in episode.play(5).parts] == [*["cut"] * 4, "ok"]
        # 20 ticks of the skill, then a cell a tick.
        places = [episode.nest.at(t)["/"].state.agents["ann"].position for t in (20, 21, 28)]
        assert places == [(1.5, 1, 1.5), (2.5, 1, 2.5), (6.5, 1, 5.5)]


def test_one_that_goes_on_is_resumed_forked_and_replayed(tmp_path: Path) -> None:
    store = tmp_path / "e.bn"
    with played(7) as at_once:
        ticks = at_once.play().ticks
    with played(7, store=store) as stopped:
        stopped.play(2)
    with bn.Episode.resume(store, {"ann": Program(ERRAND)}) as resumed:
        assert resumed.play().success
        assert resumed.ticks == ticks
        fork = resumed.at(3).fork(ann=Program(ERRAND))
        assert fork.play().ticks == ticks
        idle = resumed.at(2).fork(ann=Scripted([]))
        assert not idle.play().success
    with bn.Episode.replay(store) as again:
        # The branch that was played last: she did nothing from the third round on.
        again.play()
        assert said(again) == ["I begin."]


def test_there_has_to_be_one_to_go_on_with() -> None:
    with bn.Episode(errand(7), {"ann": Scripted([bn.GO_ON, "await say(bot, 'hello')"])}) as e:
        e.play(2)
        assert "no interrupted program" in e.parts[0].decisions["ann"].fault
        assert said(e) == ["hello"]


WAITS = """
await waitTicks(bot, 3)
await bot.waitForTicks(12)
bot.chat('one')
await waitForChat(bot, 13)
bot.chat('two')
"""


@pytest.mark.parametrize("world", WORLDS)
def test_waits_go_on_for_the_remaining_time(world: str) -> None:
    def spoken(round_ticks: int) -> list[tuple[int, str]]:
        with bn.Episode(errand(round_ticks), {"ann": Program(WAITS)}, world=world) as episode:
            episode.play(120 // round_ticks)
            return [(tick, text) for tick, _, text in episode.nest["/"].state.chat]

    whole, cut = spoken(100), spoken(10 if world == "scripted" else 2)
    assert [text for _, text in cut] == ["one", "two"]
    assert [abs(a - b) <= 1 for (a, _), (b, _) in zip(whole, cut, strict=True)] == [True, True]
