"""Programs in the scripted world: the skills it has, in ticks, and what it refuses."""

from collections.abc import Mapping
from typing import Any

import pytest

import beliefnest as bn
from beliefnest.llm.offline import OfflineModel
from beliefnest.scenarios.running import run_scenario
from beliefnest.world.values import EventKind

CHEST = (6, 1, 2)
ROOM: dict[str, Any] = {
    "name": "room",
    "box": [[0, 0, 0], [8, 3, 8]],
    "blocks": [
        {"block": "stone", "fill": [[0, 0, 0], [8, 0, 8]]},
        {"block": "bricks", "fill": [[0, 1, 6], [8, 3, 6]]},
    ],
    "containers": [{"at": list(CHEST), "items": {"apple": 2}}],
    "agents": {"ann": {"position": [1.5, 1, 2.5]}, "bob": {"position": [4.5, 1, 4.5]}},
    "static_blocks": ["stone", "bricks"],
}


@pytest.fixture
def nest() -> Any:
    with bn.Nest.open(bn.Scenario.from_mapping(ROOM), world="scripted") as opened:
        yield opened


def run(nest: bn.Nest, **programs: str) -> Mapping[str, bn.ProgramResult]:
    return nest["/"].run_all(programs, 100)


def test_walking_takes_a_tick_for_each_cell_and_taking_two_more(nest: bn.Nest) -> None:
    code = "await goToPosition(bot, new Vec3(3, 1, 2), 0); return bot.entity.position"
    result = run(nest, ann=code)["ann"]
    assert (result.ok, result.ticks) == (True, 2)
    assert nest["/"].state.agents["ann"].position == (3.5, 1.0, 2.5)
    result = run(nest, ann="await getItemFromChest(bot, new Vec3(6, 1, 2), {apple: 1})")["ann"]
    assert [event.kind for event in result.actions] == [
        EventKind.OPEN_CONTAINER,
        EventKind.GET_ITEM_FROM_CHEST,
    ]
    assert nest["/"].state.containers[CHEST].items == {"apple": 1}
    assert [(aim.call, aim.place, aim.uses) for aim in result.aims] == [
        ("getItemFromChest", (6.0, 1.0, 2.0), True)
    ]


def test_programs_go_on_together(nest: bn.Nest) -> None:
    results = run(
        nest,
        ann="await say(bot, 'one'); await say(bot, 'three')",
        bob="bot.chat('two')",
    )
    assert [text for _, _, text in nest["/"].state.chat] == ["one", "two", "three"]
    assert (results["ann"].ticks, results["bob"].ticks) == (2, 1)


@pytest.mark.parametrize(
    ("code", "kind", "line", "message"),
    [
        ("\nawait goToPosition(bot, new Vec3(4, 1, 8), 0)", "skill", 2, "no way to it on foot"),
        ("await bot.findBlocks({})", "refused", 1, "no bot.findBlocks"),
        ("await mineBlock(bot, new Vec3(0, 1, 0), 'dirt')", "error", 1, "mineBlock"),
        ("await getItemFromChest(bot, new Vec3(1, 1, 1), {apple: 1})", "skill", 1, "no container"),
        ("const = 3", "syntax", 1, ""),
        ("\n\nthrow new TypeError('oh')", "error", 3, "TypeError: oh"),
        ("await new Promise(() => {})", "stuck", None, "nothing will settle"),
        ("await bot.waitForTicks(1000)", "timeout", None, "100 ticks"),
    ],
)
def test_what_fails_says_where_and_why(
    nest: bn.Nest, code: str, kind: str, line: int | None, message: str
) -> None:
    result = run(nest, ann=code)["ann"]
    assert result.error is not None
    assert (result.ok, result.error.kind, result.error.line) == (False, kind, line)
    assert message in result.error.message
    assert (result.error.reason == "no_way") == ("no way" in message)


def test_an_endless_loop_ends(nest: bn.Nest) -> None:
    error = run(nest, ann="for (;;) {}")["ann"].error
    assert error is not None
    assert error.kind == "fuel"


@pytest.mark.parametrize("name", ["sally-anne", "help-sally", "ice-cream-van"])
def test_the_published_experiments_come_out_as_in_minecraft(name: str) -> None:
    for scenario in bn.Scenario.load_all(name):
        with bn.Nest.open(scenario, world="scripted") as nest:
            outcome = run_scenario(nest, scenario, OfflineModel(), 0, 0.0, lambda *_: None)
        assert outcome.failures == ()


def test_a_door_that_is_so_already_is_left_alone():
    shut = "oak_trapdoor[half=bottom,open=false]"
    room = {**ROOM, "blocks": [*ROOM["blocks"], {"block": shut, "at": [4, 1, 3]}]}
    door = "Door(bot, new Vec3(4, 1, 3))\n"
    program = "".join(f"await {verb}{door}" for verb in ("open", "open", "close", "close"))
    with bn.Nest.open(bn.Scenario.from_mapping(room), world="scripted") as nest:
        agent = nest.agents[0]
        result = nest["/"].run(agent, program)
        assert result.ok, result
        used = [each.detail["open"] for each in result.events if each.kind is EventKind.USE_DOOR]
        assert used == [True, False]
