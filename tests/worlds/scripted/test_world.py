"""The scripted world: exactly the moves it is told, and nothing when they are impossible."""

import math

import pytest
from msgspec.structs import fields, replace

import beliefnest as bn
from beliefnest.world.frames import Snapshot
from beliefnest.world.values import AgentState, DroppedItem, EventKind

CHEST = (3, 0, 3)


def world_of(**changes):
    options = {
        "box": ((0, 0, 0), (7, 3, 7)),
        "blocks": {(5, 0, 5): "stone"},
        "agents": {"sally": (2.5, 0, 2.5), "anne": (4.5, 0, 2.5)},
        "inventories": {"sally": {"diamond": 2}},
        "containers": {CHEST: {"emerald": 1}},
    }
    return bn.ScriptedWorld(**(options | changes))


def facts(world):
    """All there is, as values that compare."""
    snapshot = world.snapshot()
    return (
        snapshot.tick,
        snapshot.blocks.dense().tolist(),
        snapshot.containers,
        snapshot.agents,
        snapshot.items,
    )


def frames_of(world):
    frames = []
    world.listen(frames.append)
    return frames


ACTS = {
    "step": lambda w: w.step(1),
    "place_agent": lambda w: w.place_agent("sally", (1.5, 0, 1.5)),
    "set_block": lambda w: w.set_block((1, 0, 1), "stone"),
    "deposit": lambda w: w.deposit("sally", CHEST, {"diamond": 1}),
    "withdraw": lambda w: w.withdraw("anne", CHEST, {"emerald": 1}),
    "open": lambda w: w.open("anne", CHEST),
    "say": lambda w: w.say("anne", "hello"),
    "whisper": lambda w: w.whisper("anne", "sally", "psst"),
    "think": lambda w: w.think("anne", "hm"),
    "give": lambda w: w.give("sally", "anne", {"diamond": 1}),
}


@pytest.mark.parametrize("act", ACTS.values(), ids=ACTS)
def test_an_act_takes_one_tick_and_sends_one_frame(act):
    world = world_of()
    frames = frames_of(world)
    act(world)
    assert world.now == 1
    assert [frame.tick for frame in frames] == [1]


def test_several_acts_may_be_put_into_one_tick():
    world = world_of()
    frames = frames_of(world)
    with world.tick():
        for name, act in ACTS.items():
            if name != "step":
                act(world)
    (frame,) = frames
    assert world.now == 1
    assert [event.kind for event in frame.events] == [
        EventKind.BLOCK_UPDATE,
        EventKind.DEPOSIT_ITEM_INTO_CHEST,
        EventKind.GET_ITEM_FROM_CHEST,
        EventKind.OPEN_CONTAINER,
        EventKind.CHAT,
        EventKind.CHAT,
        EventKind.THINK,
        EventKind.GIVE_ITEM_TO_OTHER,
        EventKind.RECEIVE_ITEM_FROM_OTHER,
    ]
    assert set(frame.agents) == {"sally", "anne"}
    assert frame.containers == {CHEST: {"diamond": 1}}


def test_items_move_and_none_are_lost():
    world = world_of()
    world.deposit("sally", CHEST, {"diamond": 2})
    assert world.snapshot().containers[CHEST] == {"emerald": 1, "diamond": 2}
    assert world.snapshot().agents["sally"].inventory == {}
    world.withdraw("anne", CHEST, {"diamond": 1, "emerald": 1})
    assert world.snapshot().containers[CHEST] == {"diamond": 1}
    world.give("anne", "sally", {"diamond": 1})
    assert world.snapshot().agents["anne"].inventory == {"emerald": 1}
    assert world.snapshot().agents["sally"].inventory == {"diamond": 1}


def test_angles_stay_unless_they_are_given():
    world = world_of()
    world.place_agent("sally", (1.5, 0, 1.5), yaw=1.0, pitch=-0.5)
    world.place_agent("sally", (2.5, 0, 1.5))
    sally = world.snapshot().agents["sally"]
    assert (sally.position, sally.yaw, sally.pitch) == ((2.5, 0.0, 1.5), 1.0, -0.5)


def test_a_replaced_container_takes_its_content_with_it():
    world = world_of()
    frames = frames_of(world)
    world.set_block(CHEST, "air")
    assert frames[0].containers == {CHEST: None}
    assert world.snapshot().containers == {}
    world.set_block(CHEST, "barrel")
    assert world.snapshot().containers == {CHEST: {}}


def test_a_turned_container_keeps_its_content():
    world = world_of()
    world.set_block(CHEST, "chest[facing=east]")
    assert world.snapshot().containers == {CHEST: {"emerald": 1}}


def test_containers_stand_where_the_blocks_say_or_are_chests():
    world = world_of(blocks={CHEST: "barrel"}, containers={CHEST: {}, (1, 0, 1): {"apple": 3}})
    nest = bn.Nest(world)
    assert nest["/"].state.blocks[CHEST].startswith("barrel")
    assert nest["/"].state.blocks[1, 0, 1].startswith("chest")
    assert world.snapshot().containers == {CHEST: {}, (1, 0, 1): {"apple": 3}}


def test_fills_are_the_same_as_their_blocks_one_by_one():
    fills = [("stone", (0, 0, 0), (7, 0, 7)), ("oak_planks", (2, 0, 2), (5, 1, 4))]
    blocks = {(x, 0, z): "stone" for x in range(8) for z in range(8)}
    blocks |= {(x, y, z): "oak_planks" for x in range(2, 6) for y in (0, 1) for z in range(2, 5)}
    single = {(5, 1, 4): "glass"}
    filled = world_of(fills=fills, blocks=single, agents={}, inventories={}, containers={})
    assert facts(filled) == facts(
        world_of(blocks=blocks | single, agents={}, inventories={}, containers={})
    )


def test_a_fill_of_a_vast_box_does_not_visit_its_blocks():
    box, floor = ((0, 0, 0), (999, 99, 999)), [("stone", (0, 0, 0), (999, 39, 999))]
    world = bn.ScriptedWorld(box, fills=floor, agents={"ann": (500.5, 40, 500.5)})
    assert len(world.terrain.chunks) < 30
    assert world.block_text((999, 39, 0)) == "stone"
    assert world.block_text((999, 40, 0)) == "air"


@pytest.mark.parametrize(
    ("fill", "message"),
    [
        (("chest", (0, 0, 0), (1, 0, 0)), "'chest' cannot fill a cuboid; give each one"),
        (("stone", (2, 0, 0), (1, 0, 0)), "is empty; give its lower corner first"),
        (("stone", (0, 0, 0), (8, 0, 0)), "outside"),
        (("oak_dor", (0, 0, 0), (1, 0, 0)), "oak_dor"),
    ],
)
def test_impossible_fills_are_refused(fill, message):
    with pytest.raises(bn.WorldError, match=message):
        world_of(fills=[fill])


@pytest.mark.parametrize(
    ("box", "message"),
    [
        (((0, 0, 0), (9.5, 3, 9)), "9.5.* is no block position; give three whole numbers"),
        (((0, 0), (9, 9)), "give three whole numbers"),
        (((9, 0, 0), (0, 3, 9)), "give its lower corner first"),
    ],
)
def test_impossible_boxes_are_refused(box, message):
    with pytest.raises(bn.WorldError, match=message):
        bn.ScriptedWorld(box)


def test_a_world_needs_no_agents():
    world = bn.ScriptedWorld(((0, 0, 0), (3, 3, 3)))
    with bn.Nest(world) as nest:
        world.step(2)
        assert nest["/"].state.agents == {}
        nest.view()


def test_a_snapshot_is_not_changed_by_what_follows():
    world = world_of()
    before = facts(world)
    snapshot = world.snapshot()
    for act in ACTS.values():
        act(world)
    again = bn.ScriptedWorld.from_snapshot(snapshot)
    assert facts(again) == before


def test_frames_alone_lead_from_a_snapshot_to_the_next_one():
    world = world_of()
    frames = frames_of(world)
    start = world.snapshot()
    for act in ACTS.values():
        act(world)
    blocks, containers, agents = start.blocks.draft(), dict(start.containers), dict(start.agents)
    for frame in frames:
        for position, state in frame.blocks.items():
            blocks[start.box.index(position)] = state
        containers.update(frame.containers)
        agents.update(frame.agents)
    end = world.snapshot()
    assert blocks.terrain() == end.blocks
    assert containers == end.containers
    assert agents == end.agents


IMPOSSIBLE = {
    "deposit what is not held": lambda w: w.deposit("anne", CHEST, {"diamond": 1}),
    "deposit more than is held": lambda w: w.deposit("sally", CHEST, {"diamond": 3}),
    "deposit in part": lambda w: w.deposit("sally", CHEST, {"diamond": 1, "apple": 1}),
    "deposit where no container is": lambda w: w.deposit("sally", (5, 0, 5), {"diamond": 1}),
    "withdraw what is not there": lambda w: w.withdraw("anne", CHEST, {"diamond": 1}),
    "withdraw more than is there": lambda w: w.withdraw("anne", CHEST, {"emerald": 2}),
    "withdraw in part": lambda w: w.withdraw("anne", CHEST, {"emerald": 1, "apple": 1}),
    "withdraw a negative count": lambda w: w.withdraw("anne", CHEST, {"emerald": -1}),
    "withdraw half an item": lambda w: w.withdraw("anne", CHEST, {"emerald": 0.5}),
    "withdraw an unknown item": lambda w: w.withdraw("anne", CHEST, {"emeruld": 1}),
    "open no container": lambda w: w.open("anne", (5, 0, 5)),
    "open outside the box": lambda w: w.open("anne", (8, 0, 0)),
    "give what is not held": lambda w: w.give("anne", "sally", {"diamond": 1}),
    "give to nobody": lambda w: w.give("sally", "bob", {"diamond": 1}),
    "give to oneself": lambda w: w.give("sally", "sally", {"diamond": 1}),
    "place nobody": lambda w: w.place_agent("bob", (1.5, 0, 1.5)),
    "place outside the box": lambda w: w.place_agent("sally", (8.5, 0, 1.5)),
    "place below the box": lambda w: w.place_agent("sally", (1.5, -0.1, 1.5)),
    "place nowhere": lambda w: w.place_agent("sally", (math.nan, 0, 1.5)),
    "place flat": lambda w: w.place_agent("sally", (1.5, 1.5)),
    "look nowhere": lambda w: w.place_agent("sally", (1.5, 0, 1.5), yaw=math.inf),
    "set an unknown block": lambda w: w.set_block((1, 0, 1), "stoone"),
    "set an unknown property": lambda w: w.set_block((1, 0, 1), "stone[soft=true]"),
    "set outside the box": lambda w: w.set_block((1, 4, 1), "stone"),
    "set between blocks": lambda w: w.set_block((1.5, 0, 1), "stone"),
    "set by nobody": lambda w: w.set_block((1, 0, 1), "stone", actor="bob"),
    "say as nobody": lambda w: w.say("bob", "hello"),
    "think as nobody": lambda w: w.think("bob", "hm"),
    "step backwards": lambda w: w.step(-1),
}


@pytest.mark.parametrize("act", IMPOSSIBLE.values(), ids=IMPOSSIBLE)
def test_an_impossible_act_is_an_error_and_changes_nothing(act):
    world = world_of()
    frames = frames_of(world)
    before = facts(world)
    with pytest.raises(bn.WorldError):
        act(world)
    assert facts(world) == before
    assert frames == []
    world.say("sally", "still there")
    assert world.now == 1


@pytest.mark.parametrize("act", IMPOSSIBLE.values(), ids=IMPOSSIBLE)
def test_an_impossible_act_undoes_the_whole_tick_it_is_in(act):
    world = world_of()
    frames = frames_of(world)
    before = facts(world)
    with pytest.raises(bn.WorldError), world.tick():
        for name in ("set_block", "place_agent", "open", "say"):
            ACTS[name](world)
        act(world)
    assert facts(world) == before
    assert frames == []


def test_an_impossible_act_that_is_caught_inside_a_tick_leaves_the_rest():
    world = world_of()
    with world.tick():
        world.say("sally", "one")
        with pytest.raises(bn.WorldError):
            world.withdraw("anne", CHEST, {"diamond": 1})
        world.deposit("sally", CHEST, {"diamond": 1})
    assert world.snapshot().containers[CHEST] == {"emerald": 1, "diamond": 1}


def test_a_tick_within_a_tick_or_a_step_within_a_tick_is_an_error():
    world = world_of()
    with world.tick():
        with pytest.raises(bn.WorldError), world.tick():
            pass
        with pytest.raises(bn.WorldError):
            world.step(1)
    assert world.now == 1


@pytest.mark.parametrize(
    "wrong",
    [
        {"box": ((0, 0, 0), (-1, 3, 7))},
        {"blocks": {(8, 0, 0): "stone"}},
        {"blocks": {(1, 0, 1): "stoone"}},
        {"agents": {"sally": (9.5, 0, 2.5)}},
        {"agents": {"": (1.5, 0, 2.5)}},
        {"agents": {"a name": (1.5, 0, 2.5)}},
        {"agents": {"seventeen_letters": (1.5, 0, 2.5)}},
        {"inventories": {"bob": {"diamond": 1}}},
        {"inventories": {"sally": {"dimond": 1}}},
        {"inventories": {"sally": {"diamond": 0}}},
        {"containers": {(9, 0, 0): {}}},
        {"containers": {(5, 0, 5): {"diamond": 1}}},
        {"equipment": {"bob": {"main_hand": "iron_axe"}}},
    ],
    ids=str,
)
def test_an_impossible_world_is_an_error(wrong):
    with pytest.raises(bn.WorldError):
        world_of(**wrong)


def test_what_a_failed_act_did_not_do_is_believed_by_nobody():
    world = world_of()
    nest = bn.Nest(world)
    with pytest.raises(bn.WorldError):
        world.withdraw("anne", CHEST, {"diamond": 1})
    assert nest.tick == 0
    assert nest["/sally/anne"].state.events == ()


def test_dropped_items_of_a_snapshot_lie_in_the_world():
    snapshot = world_of().snapshot()
    item = DroppedItem("apple", 2, (1.5, 0.0, 1.5))
    there = Snapshot(
        snapshot.tick,
        snapshot.box,
        snapshot.blocks,
        snapshot.containers,
        snapshot.agents,
        {7: item},
    )
    nest = bn.Nest(bn.ScriptedWorld.from_snapshot(there))
    assert nest["/"].state.items == {7: item}
    assert nest["/sally/anne"].state.items == {7: item}


def test_who_moves_keeps_all_else() -> None:
    agent = AgentState(
        (1.0, 2.0, 3.0), 0.5, 0.25, False, {"head": "iron_helmet"}, {"iron_helmet": 1}, 7.0, 8.0
    )
    assert all(getattr(agent, each.name) != each.default for each in fields(agent))
    moved = agent.moved((4.0, 5.0, 6.0), 1.0, 0.75)
    assert moved == replace(agent, position=(4.0, 5.0, 6.0), yaw=1.0, pitch=0.75)
