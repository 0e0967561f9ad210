"""Programs that read percepts alone: what their agent cannot perceive changes nothing they read."""

import json
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.profiles import at_night

import beliefnest as bn

WALL_X = 4
ROOM: dict[str, Any] = {
    "name": "room",
    "box": [[0, 0, 0], [9, 3, 6]],
    "agents": {"ann": {"position": [1.5, 1, 3.5]}, "bob": {"position": [7.5, 1, 3.5]}},
    "static_blocks": ["stone"],
    "perception": {"hearing": "sight", "containers": "transparent"},
}
FLOOR = {"block": "stone", "fill": [[0, 0, 0], [9, 0, 6]]}
WALL = {"block": "bricks", "fill": [[WALL_X, 1, 0], [WALL_X, 3, 6]]}

# All that a program can read.
READ = """
const bodyOf = body => body && Object.fromEntries(
  ['type', 'name', 'username', 'position', 'yaw', 'pitch', 'height'].map(key => [key, body[key]]))
const told = {
  username: bot.username,
  entity: bodyOf(bot.entity),
  players: Object.fromEntries(Object.entries(bot.players).map(([name, player]) =>
    [name, {...player, entity: bodyOf(player.entity)}])),
  entities: Object.entries(bot.entities).map(([number, body]) => [number, bodyOf(body)]),
  inventory: bot.inventory.items(),
  health: bot.health,
  food: bot.food
}
const blocks = []
for (let x = 0; x <= 9; x++) for (let y = 0; y <= 3; y++) for (let z = 0; z <= 6; z++) {
  const block = bot.blockAt(new Vec3(x, y, z))
  blocks.push(block === null ? null : [block.name, block.position.toArray(), block.getProperties()])
}
console.log(JSON.stringify({told, blocks}))
"""
LOOK = f"{{ {READ} }}\nawait goToPosition(bot, new Vec3(2, 1, 2), 0)\n{{ {READ} }}"


def read(
    hidden: list[dict[str, Any]],
    items: dict[str, int],
    bob: tuple[float, float, float],
    senses: str,
) -> tuple[list[Any], int]:
    """Return the percepts of Ann's program in a room with this behind the wall."""
    scenario = bn.Scenario.from_mapping(
        {
            **ROOM,
            "blocks": [FLOOR, WALL, *hidden],
            "containers": [{"at": [8, 1, 5], "items": items}],
            "agents": {**ROOM["agents"], "bob": {"position": list(bob)}},
        }
    )
    with bn.Nest.open(scenario, world="scripted") as nest:
        result = nest["/"].run("ann", LOOK, senses=senses)
        assert result.ok, result.error
        return [json.loads(line) for line in result.log], result.ticks


PLACES = st.tuples(st.integers(5, 9), st.integers(1, 3), st.integers(0, 4))


@settings(max_examples=at_night(500, 15), deadline=None)
@given(
    blocks=st.dictionaries(PLACES, st.sampled_from(["dirt", "oak_planks", "lever", "glass"])),
    items=st.dictionaries(st.sampled_from(["apple", "diamond"]), st.integers(1, 3)),
    bob=st.tuples(st.floats(5.3, 7.6), st.just(1.0), st.floats(5.3, 6.7)),
)
def test_what_cannot_be_perceived_changes_no_value_that_is_read(
    blocks: dict[tuple[int, int, int], str],
    items: dict[str, int],
    bob: tuple[float, float, float],
) -> None:
    hidden = [{"block": name, "at": list(place)} for place, name in sorted(blocks.items())]
    plain = read([], {}, (7.5, 1.0, 5.5), "percepts")
    assert read(hidden, items, bob, "percepts") == plain


BEHIND = "new Vec3(5, 1, 3)"
USES = [
    f"await getItemFromChest(bot, {BEHIND}, {{apple: 1}})",
    f"await depositItemIntoChest(bot, {BEHIND}, {{dirt: 1}})",
    f"await openDoor(bot, {BEHIND})",
    f"await turnOnLever(bot, {BEHIND})",
    f"await pressButton(bot, {BEHIND})",
    f"await mineBlock(bot, {BEHIND}, 'dirt')",
    f"await placeItem(bot, 'dirt', {BEHIND})",
    f"await writeSign(bot, {BEHIND}, 'mine')",
    f"await bot.openContainer({{position: {BEHIND}}})",
]


@pytest.mark.parametrize("use", USES)
def test_a_hand_does_not_reach_through_walls_into_what_is_not_perceived(use: str) -> None:
    def told(hidden: str) -> tuple[object, ...]:
        ann = {"position": [3.5, 1, 3.5], "inventory": {"dirt": 1}}
        scenario = bn.Scenario.from_mapping(
            {
                **ROOM,
                "blocks": [FLOOR, WALL, {"block": hidden, "at": [5, 1, 3]}],
                "agents": {**ROOM["agents"], "ann": ann},
            }
        )
        with bn.Nest.open(scenario, world="scripted") as nest:
            result = nest["/"].run(
                "ann", f"console.log(await (async () => {{ {use} }})())", 100, "percepts"
            )
            return result.ok, str(result.error), result.ticks, result.log

    kinds = ("air", "dirt", "barrel", "lever[face=floor]", "oak_sign", "glass")
    assert len({told(kind) for kind in kinds}) == 1


@pytest.mark.parametrize(
    ("use", "kinds"),
    [
        ("mineBlock(bot, new Vec3(2, 1, 5), 'stone')", ("dirt", "barrel")),
        ("turnOnLever(bot, new Vec3(2, 1, 5))", ("dirt", "barrel")),
        ("pressButton(bot, new Vec3(2, 1, 5))", ("dirt", "barrel")),
        ("placeItem(bot, 'dirt', new Vec3(2, 1, 5))", ("dirt", "barrel")),
        ("mineBlock(bot, new Vec3(2, 1, 4), 'dirt')", ("lever[face=wall]", "wall_torch")),
    ],
    ids=["mine", "switch", "press", "put", "what it holds"],
)
def test_an_error_names_no_block_behind_the_back(use: str, kinds: tuple[str, ...]) -> None:
    def told(hidden: str) -> tuple[object, ...]:
        ann = {"position": [2.5, 1, 2.5], "facing": "north", "inventory": {"dirt": 1}}
        at = {"block": "dirt", "at": [2, 1, 4]} if "4)" in use else FLOOR
        scenario = bn.Scenario.from_mapping(
            {
                **ROOM,
                "blocks": [FLOOR, at, {"block": hidden, "at": [2, 1, 5]}],
                "agents": {**ROOM["agents"], "ann": ann},
                "perception": {"field_of_view": 90},
            }
        )
        with bn.Nest.open(scenario, world="scripted") as nest:
            result = nest["/"].run("ann", f"await {use}", 100, "percepts")
            assert not result.ok
            return str(result.error), result.ticks

    assert len({told(kind) for kind in kinds}) == 1


def test_a_body_that_is_seen_no_more_stays_where_it_was_seen() -> None:
    wall = {"block": "bricks", "fill": [[WALL_X, 1, 0], [WALL_X, 3, 4]]}
    agents = {**ROOM["agents"], "bob": {"position": [3.5, 1, 5.5]}}
    scenario = bn.Scenario.from_mapping({**ROOM, "blocks": [FLOOR, wall], "agents": agents})
    code = """
    const body = bot.players.bob.entity
    console.log(Object.values(bot.entities).map(each => each.username))
    await waitTicks(bot, 15)
    console.log(Object.values(bot.entities).map(each => each.username))
    console.log(body.position)
    """
    programs = {"ann": code, "bob": "await goToPosition(bot, new Vec3(8, 1, 1), 0)"}
    with bn.Nest.open(scenario, world="scripted") as nest:
        result = nest["/"].run_all(programs, 100, "percepts")["ann"]
        assert result.log == ('["ann", "bob"]', '["ann"]', "(3.5, 1, 5.5)"), result.error


def test_a_program_has_no_clock_of_the_machine() -> None:
    with bn.Nest.open(bn.Scenario.from_mapping(ROOM), world="scripted") as nest:
        assert nest["/"].run("ann", "console.log(typeof performance)").log == ("undefined",)


def test_percepts_are_what_is_perceived() -> None:
    (first, _), ticks = read([], {}, (7.5, 1.0, 5.5), "percepts")
    assert first["told"]["players"]["bob"]["entity"] is None
    assert [body["username"] for _, body in first["told"]["entities"]] == ["ann"]
    named = {tuple(each[1]): each[0] for each in first["blocks"] if each is not None}
    assert named[1, 0, 1] == "stone"
    assert named[WALL_X, 1, 3] == "bricks"
    assert (8, 1, 5) not in named
    assert ticks == 1
    (whole, _), _ = read([], {}, (7.5, 1.0, 5.5), "world")
    assert whole["told"]["players"]["bob"]["entity"] is not None
    assert None not in whole["blocks"]


def test_a_body_bumps_into_what_its_agent_does_not_know() -> None:
    hidden = [{"block": "glass", "at": [2, y, z]} for y in (1, 2, 3) for z in range(7)]
    scenario = bn.Scenario.from_mapping({**ROOM, "blocks": [FLOOR, *hidden]})
    with bn.Nest.open(scenario, world="scripted") as nest:
        code = "await goToPosition(bot, new Vec3(7, 1, 0), 0)"
        result = nest["/"].run("ann", code, senses="percepts")
        assert result.error is not None
        assert result.error.reason == "no_way"
        assert nest["/"].state.agents["ann"].position[0] < 2


def test_programs_that_are_explored_read_what_is_perceived() -> None:
    scenario = bn.Scenario.from_mapping({**ROOM, "blocks": [FLOOR]})
    look = "console.log(bot.blockAt(new Vec3(8, 1, 5))?.name ?? null)"
    with bn.Nest.open(scenario, world="scripted") as nest:
        nest["/"].edit(blocks={(3, y, z): "bricks" for y in (1, 2, 3) for z in range(7)})
        nest["/"].edit(blocks={(8, 1, 5): "dirt"})
        for number, senses in enumerate(("world", "percepts")):
            name, several = f"look {number}", 2
            attempts = nest.explore(
                "/", "ann", [look] * 2, lambda *_: 0.0, 20, name, several, senses
            )
            read = "dirt" if senses == "world" else "air"  # as it was when seen last
            assert [attempt.result.log for attempt in attempts] == [(read,)] * 2
        assert {p.senses for p in nest.programs()} == {"world", "percepts"}
        branches = nest["/"].branches()
        with pytest.raises(bn.InputError, match="give 'world' or 'percepts'"):
            nest.explore("/", "ann", [look], lambda *_: 0.0, name="no", senses="all")  # type: ignore[arg-type]
        assert nest["/"].branches() == branches


def test_what_is_imagined_meanwhile_is_not_what_is_perceived() -> None:
    scenario = bn.Scenario.from_mapping({**ROOM, "blocks": [FLOOR]})
    with bn.Nest.open(scenario, world="scripted") as nest:
        nest["/ann"].switch("what if")
        nest["/ann"].edit(blocks={(2, 1, 2): "bricks"})
        seen = "console.log(bot.blockAt(new Vec3(2, 1, 2)).name)"
        assert nest["/"].run("ann", seen, senses="percepts").log == ("air",)
        assert nest["/ann"].run("ann", seen, senses="percepts").log == ("bricks",)
