"""Bodies of beliefs that cannot be: who is moved, and to where (semantics, section 7)."""

import json
import math

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from tests.profiles import at_night

import beliefnest as bn
from beliefnest.cli.app import run_command_line
from beliefnest.nest.acting.placement import BodySpace, placed, unknown_floors
from beliefnest.world.registry import Registry
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import AgentState, Box
from beliefnest.worlds.by_name import Worlds

pytestmark = pytest.mark.usefixtures("kept_worlds")

REGISTRY = Registry.load()
SHUT = "oak_door[facing=north,half={half},hinge=left,open=false,powered=false]"
DOOR = (4, 1, 4)
ROOM = {
    "name": "two-rooms",
    "box": [[0, 0, 0], [8, 4, 8]],
    "blocks": [
        {"block": "stone", "fill": [[0, 0, 0], [8, 0, 8]]},
        {"block": "bricks", "fill": [[0, 1, 4], [8, 3, 4]]},
        {"block": SHUT.format(half="lower"), "at": list(DOOR)},
        {"block": SHUT.format(half="upper"), "at": [4, 2, 4]},
    ],
    "agents": {"ann": {"position": [1.5, 1, 1.5]}, "bob": {"position": [7.5, 1, 7.5]}},
    "static_blocks": ["stone", "bricks", "oak_door"],
}
SHUT_DOOR = ROOM["blocks"][2:]
INTO_THE_DOORWAY = """
await goToPosition(bot, new Vec3(4, 1, 3), 0)
await bot.lookAt(new Vec3(4.5, 2.6, 8), true)
bot.setControlState('forward', true)
await waitUntil(bot, () => bot.entity.position.z > 4.3)
bot.setControlState('forward', false)
await waitTicks(bot, 10)
"""
ON_THROUGH_IT = """
bot.setControlState('forward', true)
await waitUntil(bot, () => bot.entity.position.z > 5.5)
bot.setControlState('forward', false)
"""
WALK = "await goToPosition(bot, new Vec3({0}, 1, {1}), 1)"


def space(blocks, unknown=()):
    """Return a box of air over known stone, with blocks; some are unknown."""
    box = Box((0, 0, 0), (8, 4, 8))
    grid = np.zeros(box.shape, dtype=np.int32)
    grid[:, 0, :] = REGISTRY.state_id("stone")
    for place, text in blocks.items():
        grid[box.index(place)] = REGISTRY.state_id(text)
    for place in unknown:
        grid[box.index(place)] = -1
    return BodySpace(REGISTRY, box, Terrain.of(grid))


def door(facing="north", z=4):
    text = SHUT.replace("north", facing)
    wall = {(x, y, z): "stone" for x in range(9) for y in (1, 2, 3)}
    halves = {(4, 1, z): text.format(half="lower"), (4, 2, z): text.format(half="upper")}
    return {**wall, **halves}


def only(there, place, *, on_ground=True):
    """Return the start of one agent that is believed at a place; None: that place."""
    moves = placed(there, {"ann": AgentState(place, on_ground=on_ground)}, {"ann": 3})
    assert all(start == place for start, _ in moves.values())
    return moves["ann"][1] if moves else None


def test_who_can_be_where_it_is_believed_to_be_is_not_moved():
    there = space({(3, 1, 3): "chest", (5, 1, 5): "oak_fence", (6, 1, 1): "oak_slab"})
    for place in [
        (1.5, 1, 1.5),
        (3.5, 1.875, 3.5),
        (5.5, 2.5, 5.5),
        (6.5, 1.5, 1.5),
        (2.7, 1, 3.5),
    ]:
        assert only(there, place) is None


@pytest.mark.parametrize("facing,z", [("north", 3.5), ("south", 5.5)])
def test_in_a_shut_doorway_it_begins_on_the_side_that_is_open_to_the_doorway(facing, z):
    # A door that faces north hangs on the south side of its block, and the other way round.
    panel = 4.9 if facing == "north" else 4.1
    assert only(space(door(facing)), (4.5, 1, panel)) == (4.5, 1, z)


def test_who_was_last_seen_in_the_middle_of_a_doorway_that_is_shut_is_moved_unless_seen_there_now():
    there, place = space(door("north")), (4.5, 1, 4.5)
    assert there.is_free(place)
    assert only(there, place) == (4.5, 1, 3.5)
    assert placed(there, {"ann": AgentState(place)}, {"ann": 3}, ["ann"]) == {}
    opened = {at: text.replace("open=false", "open=true") for at, text in door("north").items()}
    assert only(space(opened), place) is None


def test_in_a_block_it_begins_at_the_nearest_place_where_it_can_stand():
    there = space({(2, 1, 2): "stone", (2, 2, 2): "stone"})
    assert only(there, (2.9, 1, 2.5)) == (3.5, 1, 2.5)


def test_it_does_not_begin_in_fire_nor_farther_than_three_blocks_away():
    burning = {(x, 1, z): "fire" for x in range(9) for z in range(9)}
    there = space({**burning, (2, 1, 2): "stone", (2, 2, 2): "stone", (8, 1, 8): "air"})
    assert only(there, (2.5, 1, 2.5)) == (2.5, 3, 2.5)
    high = {(x, y, z): "stone" for x in range(9) for y in range(1, 5) for z in range(9)}
    assert only(space({**high, (8, 1, 8): "air", (8, 2, 8): "air"}), (2.5, 1, 2.5)) is None


def test_who_stands_on_nothing_is_moved_and_who_jumps_is_not():
    there = space({})
    assert only(there, (4.5, 2.2, 4.5)) == (4.5, 1, 4.5)
    assert only(there, (4.5, 2.2, 4.5), on_ground=False) is None


def test_an_unknown_floor_holds_whom_it_is_believed_to_hold():
    there = space({}, unknown=[(4, 0, 4), (6, 0, 6)])
    assert only(there, (4.5, 1, 4.5)) is None
    agents = {
        "ann": AgentState((4.5, 1, 4.5)),
        "bob": AgentState((2.5, 1, 2.5)),
        "eve": AgentState((6.5, 2.4, 6.5), on_ground=False),
    }
    assert unknown_floors(there, agents) == {(4, 0, 4), (6, 0, 6)}


def test_of_two_in_one_place_the_one_seen_there_first_is_moved():
    there, place = space({}), (4.5, 1, 4.5)
    both = {"ann": AgentState(place), "bob": AgentState(place)}
    assert list(placed(there, both, {"ann": 3, "bob": 9})) == ["ann"]
    assert list(placed(there, both, {"ann": 9, "bob": None})) == ["bob"]
    assert list(placed(there, both, {"ann": None, "bob": None})) == ["bob"]
    # They were seen so.
    assert placed(there, both, {"ann": 9, "bob": 9}) == {}


@settings(max_examples=at_night(2000, 60), deadline=None)
@given(
    blocks=st.dictionaries(
        st.tuples(st.integers(2, 6), st.integers(1, 3), st.integers(2, 6)),
        st.sampled_from(
            ["stone", "oak_slab", "oak_fence", "ladder", "chest", SHUT.format(half="lower")]
        ),
        max_size=40,
    ),
    place=st.tuples(st.floats(2, 7), st.floats(1, 3), st.floats(2, 7)),
)
def test_whoever_is_moved_stands_freely_on_a_floor_nearby(blocks, place):
    there = space(blocks)
    to = only(there, place)
    if to is not None:
        assert math.dist(place, to) <= 3
        assert there.is_free(to)
        assert there.has_floor(to)
        assert only(there, to) is None


@pytest.fixture(scope="module")
def worlds():
    with Worlds(0) as lending:
        yield lending


def room(**believed):
    """Return the two rooms, and ann's first belief."""
    return bn.Scenario.from_mapping({**ROOM, "initial_beliefs": [{"path": "/ann", **believed}]})


def test_the_fork_says_who_was_moved_and_the_belief_stays(worlds, tmp_path):
    scenario = room(agents={"bob": [4.5, 1, 4.9]})
    with bn.Nest.open(scenario, worlds=worlds, store=tmp_path / "run.bn") as nest:
        belief = nest["/ann"]
        assert belief.placed == {}
        belief.switch("try")
        moves = {"bob": ((4.5, 1.0, 4.9), (4.5, 1.0, 3.5))}
        assert belief.placed == moves
        assert belief.state.agents["bob"].position == moves["bob"][1]
        assert nest.at(belief.tick)["/ann/bob"].state.tick == 0
        result = belief.run("bob", WALK.format(7, 1))
        assert result.ok, result
        assert result.placed == moves
        belief.switch("further")
        assert belief.placed == moves
        belief.switch("follow")
        assert belief.placed == {}
        assert belief.state.agents["bob"].position == moves["bob"][0]
    with bn.Nest.resume(tmp_path / "run.bn", worlds=worlds) as nest:
        nest["/ann"].switch("try")
        assert nest["/ann"].placed == moves
        assert nest["/ann"].run("bob", WALK.format(1, 1)).ok


def test_programs_tried_ahead_in_other_bodies_begin_at_the_same_places(worlds):
    programs = [WALK.format(*goal) for goal in [(1, 1), (7, 1), (1, 2)]]
    found = []
    for processes in (1, 2):
        with bn.Nest.open(room(agents={"bob": [4.5, 1, 4.9]}), worlds=worlds) as nest:
            attempts = nest.explore("/ann", "bob", programs, lambda *_: 0.0, processes=processes)
            found.append([(a.result.ok, a.result.ticks, a.result.placed) for a in attempts])
    assert found[0] == found[1]
    assert all(ok and placed for ok, _, placed in found[0])


def test_a_body_stands_on_a_floor_that_is_unknown_also_after_it_was_resumed(worlds, tmp_path):
    floor = [{"block": None, "fill": [[3, 0, 5], [5, 0, 7]]}]
    scenario = room(agents={"bob": [4.5, 1, 6.5]}, blocks=floor)
    store = tmp_path / "run.bn"
    with bn.Nest.open(scenario, worlds=worlds, store=store) as nest:
        belief = nest["/ann"]
        if belief.state.blocks[(4, 0, 6)] is not None:
            pytest.fail("ann sees the floor; the test tries nothing")
        belief.switch("try")
        belief.step(20)
        assert belief.state.agents["bob"].position == (4.5, 1.0, 6.5)
        assert belief.state.blocks[(4, 0, 6)] is None
        assert belief.placed == {}
    with bn.Nest.resume(store, worlds=worlds) as nest:
        nest["/ann"].step(20)
        assert nest["/ann"].state.agents["bob"].position == (4.5, 1.0, 6.5)


def test_who_went_on_and_shut_the_door_can_walk_where_it_was_last_seen_in_the_doorway(worlds):
    ajar = [
        {"block": b["block"].replace("open=false", "open=true"), "at": b["at"]} for b in SHUT_DOOR
    ]
    screen = {"block": "bricks", "fill": [[2, 1, 0], [2, 3, 2]]}
    agents = {"ann": {"position": [4.5, 1, 1.5]}, "bob": {"position": [5.5, 1, 2.5]}}
    blocks = [*ROOM["blocks"][:2], *ajar, screen]
    content = {**ROOM, "blocks": blocks, "agents": agents, "static_blocks": ["stone", "bricks"]}
    with bn.Nest.open(bn.Scenario.from_mapping(content), worlds=worlds) as nest:
        story = [
            ("bob", INTO_THE_DOORWAY),
            ("ann", "await goToPosition(bot, new Vec3(0, 1, 0), 0)"),
            ("bob", ON_THROUGH_IT + "await closeDoor(bot, new Vec3(4, 1, 4))"),
            ("ann", "await goToPosition(bot, new Vec3(4, 1, 2), 0)"),
        ]
        for agent, program in story:
            result = nest["/"].run(agent, program)
            assert result.ok, (program, result)
        belief = nest["/ann"]
        assert "open=false" in belief.state.blocks[DOOR]
        believed = belief.state.agents["bob"]
        assert not believed.current
        assert tuple(math.floor(value) for value in believed.position) == DOOR
        belief.switch("try")
        assert list(belief.placed) == ["bob"]
        for goal in [(1, 7), (7, 1)]:
            result = belief.run("bob", WALK.format(*goal))
            assert result.ok, (belief.placed, result)


def test_a_run_tells_who_was_moved_and_is_replayed(tmp_path, capsys):
    chest = [1, 1, 3]
    probe = {"path": "/ann", "acts_in": "/ann", "agent": "bob", "task": "Get a diamond."}
    believed = {
        "agents": {"bob": [4.5, 1, 4.9]},
        "containers": [{"at": chest, "items": {"diamond": 1}}],
    }
    content = {
        **ROOM,
        "containers": [{"at": chest, "items": {"diamond": 1}}],
        "initial_beliefs": [{"path": "/ann", **believed}],
        "probes": [{**probe, "expect": {"opens": chest}}],
    }
    scenario, folder = tmp_path / "two-rooms.json", tmp_path / "run"
    scenario.write_text(json.dumps(content))
    assert run_command_line(["run", str(scenario), "--out", str(folder)]) == 0
    moved = "bob begins at (4.5, 1.0, 3.5)"
    assert moved in " ".join(capsys.readouterr().out.split())
    (run,) = json.loads((folder / "run.json").read_text())["runs"]
    assert run["probes"][0]["placed"] == {"bob": [[4.5, 1.0, 4.9], [4.5, 1.0, 3.5]]}
    shown = ["show", str(folder), "--path", "/ann", "--branch", "probe 1"]
    assert run_command_line(shown) == 0
    assert moved in " ".join(capsys.readouterr().out.split())
    assert run_command_line([*shown, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["placed"] == run["probes"][0]["placed"]
    assert run_command_line(["replay", str(folder)]) == 0


@settings(
    max_examples=at_night(300, 5),
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(
    facing=st.sampled_from(["north", "south"]),
    ann=st.tuples(st.floats(3.8, 5.2), st.floats(3.2, 5.8)),
    bob=st.tuples(st.floats(3.8, 5.2), st.floats(3.2, 5.8)),
    goal=st.tuples(st.sampled_from([1, 7]), st.sampled_from([1, 7])),
)
def test_whoever_was_last_seen_about_a_door_can_walk_in_the_body(worlds, facing, ann, bob, goal):
    shut = SHUT.replace("north", facing)
    doors = [
        {"block": shut.format(half="lower"), "at": list(DOOR)},
        {"block": shut.format(half="upper"), "at": [4, 2, 4]},
    ]
    people = {"bob": [bob[0], 1, bob[1]]}
    nested = {"path": "/bob", "agents": {"ann": [ann[0], 1, ann[1]]}}
    believed = [{"path": "/ann", "agents": people, "blocks": doors}, {**nested, "blocks": doors}]
    scenario = bn.Scenario.from_mapping({**ROOM, "initial_beliefs": believed})
    with bn.Nest.open(scenario, worlds=worlds) as nest:
        for path, agent in [("/ann", "bob"), ("/bob", "ann")]:
            nest[path].switch("try")
            result = nest[path].run(agent, WALK.format(*goal), 400)
            assert result.ok, (path, nest[path].placed, result)


PLACE = (6, 1, 7)
"""Behind the wall that ann does not see through."""
SEEN = {"wall": (1, 1, 4), "seen air": (2, 1, 2), "floor": (3, 0, 2)}
TELL = "await say(bot, 'Look there.', [located('diamond', new Vec3({}, {}, {}))])"
TAKE = "await getItemFromChest(bot, new Vec3({}, {}, {}), {{diamond: 1}})"


def telling(**more):
    rules = {"testimony": "accept", "hearing": "global"}
    return bn.Scenario.from_mapping({**ROOM, "perception": rules, **more})


def facts(state):
    contents = {place: dict(held.items) for place, held in state.containers.items()}
    return contents, state.blocks.grid.copy()


@pytest.mark.parametrize("world", ["embedded", "scripted"])
@pytest.mark.parametrize("senses", ["world", "percepts"])
def test_a_chest_is_put_where_something_is_believed_to_be(worlds, world, senses, tmp_path):
    place = PLACE
    lent = {"worlds": worlds} if world == "embedded" else {"world": world}
    with bn.Nest.open(telling(), store=tmp_path / "run.bn", **lent) as nest:
        assert nest["/"].run("bob", TELL.format(*place)).ok
        belief = nest["/ann"]
        contents, blocks = facts(belief.state)
        assert contents[place] == {"diamond": 1}
        block = belief.state.blocks[place]
        assert belief.placed == {}
        belief.switch("try")
        assert belief.placed[place] == (block, "chest")
        belief.switch("other")
        belief.switch("try")
        assert facts(belief.state)[0] == contents
        assert np.array_equal(facts(belief.state)[1], blocks)
        result = belief.run("ann", TAKE.format(*place), senses=senses)
        assert result.ok, result
        assert result.placed == belief.placed
        assert belief.state.agents["ann"].inventory == {"diamond": 1}
        assert belief.state.containers[place].items == {}
        assert belief.state.blocks[place] == block
        assert belief.placed[place] == (block, "chest")
        belief.switch("follow")
        assert belief.placed == {}
        assert facts(belief.state)[0] == contents
        belief.switch("try")
    with bn.Nest.read(tmp_path / "run.bn") as run:
        assert run["/ann"].placed[place] == (block, "chest")


@pytest.mark.parametrize("place", SEEN.values(), ids=list(SEEN))
def test_no_chest_is_put_where_none_is_seen_whatever_is_said(place):
    with bn.Nest.open(telling(), world="scripted") as nest:
        assert nest["/"].run("bob", TELL.format(*place)).ok
        belief = nest["/ann"]
        assert place not in belief.state.containers
        belief.switch("try")
        assert belief.placed == {}


CHEST = {"at": list(PLACE), "block": "chest"}


def test_a_probe_acts_in_a_belief_about_a_chest_that_was_not_seen(tmp_path, capsys):
    scenario = tmp_path / "probe.yaml"
    content = {
        **ROOM,
        "containers": [CHEST],
        "initial_beliefs": [
            {"path": "/ann", "containers": [{"at": list(PLACE), "items": {"diamond": 1}}]}
        ],
        "probes": [
            {
                "path": "/ann",
                "acts_in": "/ann",
                "agent": "ann",
                "task": "Get a diamond from a chest.",
                "expect": {"opens": list(PLACE)},
            }
        ],
    }
    scenario.write_text(json.dumps(content))
    assert run_command_line(["run", str(scenario), "--json"]) == 0
    probe = json.loads(capsys.readouterr().out)["runs"][0]["probes"][0]
    assert probe["opened"] == [list(PLACE)]
    assert probe["placed"] == {"6,1,7": [None, "chest"]}


SWORDS = {"diamond_sword": 20}
IMPOSSIBLE = {
    "a sign that holds a diamond": {
        "blocks": [{"at": [6, 1, 7], "block": "oak_sign"}],
        "containers": [{"at": [6, 1, 7], "items": {"diamond": 1}}],
    },
    "more than fits into a furnace": {
        "blocks": [{"at": [6, 1, 7], "block": "furnace"}],
        "containers": [{"at": [6, 1, 7], "items": SWORDS}],
    },
    "half a chest": {
        "blocks": [{"at": [6, 1, 7], "block": "chest[type=left]"}],
        "containers": [{"at": [6, 1, 7], "items": {"diamond": 1}}],
    },
    "half a door": {"blocks": [{"at": [6, 1, 7], "block": "oak_door[half=upper]"}]},
    "somebody in the chest": {
        "agents": {"bob": [6.5, 1, 7.5]},
        "containers": [{"at": [6, 1, 7], "items": {"diamond": 1}}],
    },
    "somebody in the outer wall": {"agents": {"bob": [6.5, 1, 0.01]}},
}


@pytest.mark.parametrize("world", ["embedded", "scripted"])
@pytest.mark.parametrize("believed", IMPOSSIBLE.values(), ids=list(IMPOSSIBLE))
def test_other_impossible_beliefs_have_bodies_too(worlds, world, believed):
    lent = {"worlds": worlds} if world == "embedded" else {"world": world}
    believes = [{"path": "/ann", **believed}]
    scenario = {**ROOM, "containers": [CHEST], "initial_beliefs": believes}
    with bn.Nest.open(bn.Scenario.from_mapping(scenario), **lent) as nest:
        belief = nest["/ann"]
        before = facts(belief.state)
        belief.switch("try")
        belief.switch("other")
        belief.switch("try")
        assert belief.run("ann", "bot.setControlState('forward', true); await waitTicks(bot, 5)")
        for found, expected in zip(facts(belief.state), before, strict=True):
            assert np.array_equal(found, expected)


COLOURS = ("white", "orange", "magenta", "lime", "pink", "gray", "cyan", "purple", "blue", "brown")
THIRTY = [f"{colour}_{thing}" for colour in COLOURS for thing in ("wool", "dye", "carpet")]


def test_what_does_not_fit_into_a_chest_is_left_out_of_the_body_alone(worlds):
    said = [f"await say(bot, 'More.', [located('{item}', new Vec3{PLACE})])" for item in THIRTY]
    with bn.Nest.open(telling(), worlds=worlds) as nest:
        assert nest["/"].run("bob", "\n".join(said)).ok
        belief = nest["/ann"]
        belief.switch("try")
        assert belief.state.containers[PLACE].items == dict.fromkeys(THIRTY, 1)
        first = min(THIRTY)
        result = belief.run("ann", TAKE.format(*PLACE).replace("diamond", first))
        assert result.ok, result
        assert len(belief.state.containers[PLACE].items) == 26


BLOCKS = (
    *("air", "stone", "chest[type=left]", "barrel", "furnace[lit=true]", "oak_door[half=upper]"),
    *("red_bed[part=head]", "oak_sign", "water", "sand", "trapped_chest", "fire", "piston_head"),
    *("hopper", "ender_chest", "scaffolding", "powder_snow", "lever[face=floor]"),
)
POSITIONS = st.tuples(st.integers(0, 8), st.integers(0, 4), st.integers(0, 8))
CLAIMS = st.one_of(
    st.builds(bn.Claim.located, st.sampled_from(["diamond", "coal", "bow", "iron_ore"]), POSITIONS),
    st.builds(bn.Claim.absent, st.just("diamond"), POSITIONS),
    st.builds(bn.Claim.block, POSITIONS, st.sampled_from(BLOCKS)),
    st.builds(
        bn.Claim.position,
        st.sampled_from(["ann", "bob"]),
        st.tuples(
            st.floats(0, 8.99).map(lambda x: round(x, 2)),
            st.sampled_from([0, 0.5, 1, 4]),
            st.floats(0, 8.99).map(lambda x: round(x, 2)),
        ),
    ),
)


def spoken(claim):
    """Return the claim as programs make it."""
    place = None if claim.place is None else f"new Vec3({', '.join(map(str, claim.place))})"
    call = {
        "located": f"located('{claim.item}', {place})",
        "absent": f"absent('{claim.item}', {place})",
        "position": f"positionOf('{claim.agent}', {place})",
        "block": f"blockAt({place}, '{claim.state}')",
    }[claim.kind.value]
    return f"await say(bot, 'Hear.', [{call}])"


@given(claims=st.lists(CLAIMS, min_size=1, max_size=12), path=st.sampled_from(["/ann", "/bob/ann"]))
@settings(
    max_examples=at_night(300, 12),
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
def test_every_claim_leaves_a_belief_that_has_a_body(worlds, claims, path):
    with bn.Nest.open(telling(), worlds=worlds) as nest:
        for speaker in ("bob", "ann"):
            assert nest["/"].run(speaker, "\n".join(map(spoken, claims))).ok
        belief = nest[path]
        before = facts(belief.state)
        belief.switch("try")
        belief.switch("other")
        belief.switch("try")
        assert facts(belief.state)[0] == before[0]
        assert np.array_equal(facts(belief.state)[1], before[1])
        there = [name for name, each in belief.state.agents.items() if each.position is not None]
        if there:
            belief.run_all(dict.fromkeys(there, "bot.setControlState('forward', true)"))
        belief.switch("other")
        belief.switch("try")
