"""Programs in the scripted world: the skills it has, in ticks, and what it refuses."""

import math
from collections.abc import Mapping
from typing import Any

import pytest

import beliefnest as bn
from beliefnest.llm.offline import OfflineModel
from beliefnest.scenarios.running import run_scenario
from beliefnest.world.values import EYE_HEIGHT, EventKind

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


def test_what_is_said_last_is_said_whether_it_is_waited_for_or_not(nest: bn.Nest) -> None:
    walk = "await goToPosition(bot, new Vec3(3, 1, 2), 0)"
    waited = run(nest, ann=f"{walk}; await say(bot, 'here')")["ann"]
    back = run(nest, ann="await goToPosition(bot, new Vec3(1, 1, 2), 0)")["ann"]
    not_waited = run(nest, ann=f"{walk}; bot.chat('here')")["ann"]
    assert back.ok
    assert not_waited.ticks == waited.ticks
    assert not_waited.unfinished == ()
    assert [text for _, _, text in nest["/"].state.chat] == ["here", "here"]


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
        ("await craftItem(bot, 'stick')", "refused", 1, "the scripted world has no craftItem"),
        ("await eat(bot, 'apple')", "refused", 1, "the scripted world has no eat"),
        ("await getItemFromChest(bot, new Vec3(1, 1, 1), {apple: 1})", "skill", 1, "no chest"),
        ("const = 3", "syntax", 1, ""),
        ("\n\nthrow new TypeError('oh')", "error", 3, "TypeError: oh"),
        ("await new Promise(() => {})", "stuck", 1, "nothing will settle"),
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


SIGN = [7, 1, 4]


def doored(state: str, kind: str = "oak_door") -> dict[str, Any]:
    """Return the room with a wall right across it, and a door in the wall."""
    leaf = f"facing=north,{state}"
    blocks = [
        *ROOM["blocks"],
        {"block": f"{kind}[half=lower,{leaf}]", "at": [4, 1, 6]},
        {"block": f"{kind}[half=upper,{leaf}]", "at": [4, 2, 6]},
    ]
    return {**ROOM, "blocks": blocks}


def passing(room: Mapping[str, Any], doors: str) -> tuple[list[bool], str | None, float]:
    """Return the state of the door, and of the agent that went through the wall and back."""
    go = f"await goToPosition(bot, new Vec3(4, 1, 8), 0{doors})\n"
    back = go.replace("8)", "3)")
    with bn.Nest.open(bn.Scenario.from_mapping(room), world="scripted") as nest:
        result = nest["/"].run("ann", go + back, 200)
        used = [each.detail["open"] for each in result.events if each.kind is EventKind.USE_DOOR]
        fault = None if result.error is None else result.error.reason
        return used, fault, nest["/"].state.agents["ann"].position[2]


@pytest.mark.parametrize(
    ("door", "kind", "doors", "used", "fault"),
    [
        ("open=false", "oak_door", "", [True], None),
        ("open=false", "oak_door", ", {closeDoors: true}", [True, False, True, False], None),
        ("open=true", "oak_door", ", {closeDoors: true}", [False, True, False], None),
        ("open=false", "oak_door", ", {openDoors: false}", [], "no_way"),
        ("open=true", "oak_door", ", {openDoors: false}", [], None),
        ("open=false", "iron_door", "", [], "no_way"),
        ("open=true", "iron_door", ", {closeDoors: true}", [], None),
    ],
)
def test_ways_lead_through_doors_as_in_minecraft(
    door: str, kind: str, doors: str, used: list[bool], fault: str | None
) -> None:
    found, reason, z = passing(doored(door, kind), doors)
    assert (found, reason) == (used, fault)
    assert z == (3.5 if fault is None else 2.5)


def test_a_gate_is_gone_through_and_no_corner_of_it_cut() -> None:
    gate = {"block": "oak_fence_gate[facing=north,open=false]", "at": [4, 1, 6]}
    air = {"block": "air", "at": [4, 2, 6]}
    assert passing({**ROOM, "blocks": [*ROOM["blocks"], gate, air]}, "")[:2] == ([True], None)
    crosswise = {"block": "oak_fence_gate[facing=east,open=true]", "at": [4, 1, 6]}
    room = {**ROOM, "blocks": [*ROOM["blocks"], crosswise, air]}
    assert passing(room, "")[1] == "no_way"


def test_settings_of_doors_that_there_are_not_are_named(nest: bn.Nest) -> None:
    error = run(nest, ann="await goToPosition(bot, new Vec3(3, 1, 2), 0, {openDoor: true})")["ann"]
    assert "openDoors and closeDoors, each true or false" in str(error.error)


def test_agents_turn_to_the_point_they_look_at(nest: bn.Nest) -> None:
    x, y, z = nest["/"].state.agents["ann"].position
    result = run(nest, ann=f"await lookAt(bot, new Vec3({x + 2}, {y + EYE_HEIGHT + 2}, {z}))")[
        "ann"
    ]
    ann = nest["/"].state.agents["ann"]
    assert (result.ok, result.ticks, ann.position) == (True, 1, (x, y, z))
    assert (ann.yaw, ann.pitch) == (pytest.approx(-math.pi / 2), pytest.approx(math.pi / 4))
    error = run(nest, ann="await lookAt(bot, 'bob')")["ann"].error
    assert "position must be a Vec3" in str(error)


@pytest.mark.parametrize("condition", [1, 2])
def test_who_looks_at_a_container_sees_nothing_in_it(condition: int) -> None:
    with bn.Nest.open(bn.Scenario.load("knowledge-access", condition), world="scripted") as nest:
        nest.play()
        inside = {name: nest[f"/{name}"].state.containers[7, 1, 2] for name in ("fiona", "john")}
        known = {name: dict(container.items) for name, container in inside.items()}
    looked, stood = ("fiona", "john") if condition == 1 else ("john", "fiona")
    assert known == {looked: {"diamond": 1}, stood: {}}


def test_signs_are_written_on_and_read() -> None:
    signs = [{"at": SIGN, "block": "oak_sign", "text": "food"}]
    room = {**ROOM, "signs": signs}
    with bn.Nest.open(bn.Scenario.from_mapping(room), world="scripted") as nest:
        results = nest["/"].run_all(
            {
                "ann": "console.log(await readSign(bot, new Vec3(7, 1, 4)))\n"
                "await writeSign(bot, new Vec3(7, 1, 4), 'no\\nfood')\n"
                "console.log(bot.blockAt(new Vec3(7, 1, 4)).getSignText()[0])",
                "bob": "await readSign(bot, new Vec3(1, 1, 1))",
            },
            100,
        )
        assert results["ann"].log == ("food", "no\nfood")
        assert "no sign at (1, 1, 1)" in str(results["bob"].error)
        assert nest["/bob"].state.signs == {(7, 1, 4): "no\nfood"}
        result = nest["/"].run("bob", f"await writeSign(bot, new Vec3(7, 1, 4), '{'x' * 46}')")
        assert "line 1 has 46" in str(result.error)
