"""Things that a history repeats: deeds of agents without candidates, changes by nobody, edits."""

import pytest

import beliefnest as bn

DOOR, LEVER, CHEST, BOX = (5, 1, 1), (1, 1, 3), (4, 1, 3), (3, 1, 2)
GROUND = {(x, 0, z): "stone" for x in range(8) for z in range(4)}
SHUT = "oak_door[facing=east,half={},open={}]"


def hall():
    """Red stands in a hall with a door, a lever, a chest and a box; Blue does things there."""
    things = {
        BOX: "oak_planks",
        DOOR: SHUT.format("lower", "false"),
        (5, 2, 1): SHUT.format("upper", "false"),
        LEVER: "lever[face=floor]",
        (1, 1, 1): "oak_sign",
    }
    return bn.ScriptedWorld(
        box=((0, 0, 0), (7, 3, 3)),
        blocks={**GROUND, **things},
        agents={"red": (0.5, 1, 0.5), "blue": (2.5, 1, 1.5)},
        containers={CHEST: {"apple": 1}},
        inventories={"blue": {"red_wool": 1}},
    )


def move_box(world, actor):
    with world.tick():
        world.set_block(BOX, "air", actor)
        world.set_block((4, 1, 2), "oak_planks", actor)
        world.place_agent("blue", (3.5, 1, 1.5))


def fill_new_chest(world):
    with world.tick():
        world.set_block((6, 1, 3), "chest")
        world.deposit("blue", (6, 1, 3), {"red_wool": 1})


ACTS = {
    "box by blue": lambda world: move_box(world, "blue"),
    "box by nobody": lambda world: move_box(world, None),
    "door by nobody": lambda world: world.set_block(DOOR, SHUT.format("lower", "true")),
    "door": lambda world: world.use_door("blue", DOOR, open=True),
    "lever": lambda world: world.use_lever("blue", LEVER, powered=True),
    "lever by nobody": lambda world: world.set_block(LEVER, "lever[face=floor,powered=true]"),
    "mined": lambda world: world.mine("blue", BOX),
    "put": lambda world: world.put("blue", "red_wool", (2, 1, 2)),
    "withdrawn": lambda world: world.withdraw("blue", CHEST, {"apple": 1}),
    "given": lambda world: world.give("blue", "red", {"red_wool": 1}),
    "a chest at once filled": fill_new_chest,
    "sign": lambda world: world.write_sign("blue", (1, 1, 1), "soup"),
}


@pytest.mark.parametrize("name", ACTS)
def test_what_others_did_is_repeated(name):
    world = hall()
    with bn.Nest(world) as nest:
        world.step(2)
        ACTS[name](world)
        world.step(2)
        imagined = nest["/"].imagine(0, actors={"red": {"idle": ""}}, n=1)
        assert imagined.impossible is None
        then, now = imagined[0].state, nest["/"].state
        assert then.blocks == now.blocks
        assert {at: dict(held.items) for at, held in then.containers.items()} == {
            at: dict(held.items) for at, held in now.containers.items()
        }
        assert then.agents["blue"].inventory == now.agents["blue"].inventory


def test_what_an_agent_in_question_did_is_not_repeated():
    for act in ("mined", "door", "lever", "box by blue"):
        world = hall()
        with bn.Nest(world) as nest:
            ACTS[act](world)
            idle = nest["/"].imagine(
                0,
                actors={"blue": {"idle": ""}},
                evidence=[{"agent": "red", "at": (0, 1, 0)}],
                n=1,
            )
            assert idle[0].state.blocks == idle[0].at(0).state.blocks


def test_a_change_that_an_unseen_agent_may_have_made_needs_it():
    """Carl mines behind a screen what Anne sees vanish; nobody is seen to do it."""
    blocks = {(x, 0, z): "stone" for x in range(7) for z in range(5)}
    blocks |= {(4, y, z): "bricks" for y in (1, 2, 3) for z in (0, 1, 2)} | {(3, 1, 3): "dirt"}
    world = bn.ScriptedWorld(
        box=((0, 0, 0), (6, 3, 4)),
        blocks=blocks,
        agents={"anne": (1.5, 1, 1.5), "carl": (5.5, 1, 0.5)},
    )
    known = bn.InitialBelief(("anne",), agents={"carl": (5.5, 1, 0.5)})
    statics = ["stone", "bricks", "air"]
    with bn.Nest(world, static_blocks=statics, initial_beliefs=[known]) as nest:
        world.place_agent("anne", (1.5, 1, 1.5), yaw=-1.9)
        world.step(2)
        assert not nest["/anne"].state.agents["carl"].current
        world.mine("carl", (3, 1, 3))
        world.step(2)
        assert nest["/anne"].state.blocks[3, 1, 3] == "air"
        with pytest.warns(UserWarning, match="blocks in the last history differ"):
            assert (
                nest["/anne"].imagine(1, actors={"carl": {"idle": ""}}, n=1).impossible is not None
            )


def test_claims_of_repeated_speech_are_taken_up():
    world = hall()
    with bn.Nest(world, perception=bn.Perception(testimony="accept")) as nest:
        world.say("blue", "an apple", [bn.Claim.located("apple", CHEST)])
        imagined = nest["/"].imagine(0, actors={"red": {"idle": ""}}, n=1)
        assert imagined[0]["/red"].state.containers[CHEST].items == {"apple": 1}


# Edits

SHORT = [(x, 0) for x in range(7)]


def two_ways():
    """Return a world with a short way along z = 0, shut by planks, and a long one round a wall."""
    blocks = {(x, 0, z): "stone" for x in range(7) for z in range(4)}
    blocks |= {(x, y, 1): "bricks" for x in range(1, 6) for y in (1, 2)}
    blocks |= {(3, y, 0): "oak_planks" for y in (1, 2)}
    return bn.ScriptedWorld(
        box=((0, 0, 0), (6, 3, 3)), blocks=blocks, agents={"red": (0.5, 1, 0.5)}
    )


OPEN = {(3, 1, 0): "air", (3, 2, 0): "air"}
DECIDED = {"goals": {"star": {"at": (6, 1, 0)}}, "utilities": {"star": 100}, "stay_cost": 1}
ANYTHING = [{"agent": "red", "at": (6, 1, 0), "mistaken": 0.5}]


def walked(history, ticks):
    feet = (history.at(tick).state.agents["red"].position for tick in ticks)
    return [(int(x), int(z)) for x, _, z in feet]


@pytest.mark.parametrize("since", [5, 6])
def test_plans_are_made_on_the_edited_map(since):
    world = two_ways()
    model = bn.MindModel("red", rationality=20, **DECIDED)
    with bn.Nest(world) as nest:
        world.step(30)
        nest["/"].switch("open", at=5)
        nest["/"].edit(blocks=OPEN)
        nest["/"].step(20)
        imagined = nest["/"].imagine(
            since, until=25, actors={"red": {"walk": model}}, evidence=ANYTHING, n=1
        )
        assert walked(imagined[0], range(since, since + 7)) == SHORT
        ahead = nest["/"].infer(model, since=since, until=since).predict(6)[-1]
        assert max(ahead, key=ahead.get) == (6, 1, 0)


def test_an_edit_at_the_first_tick_settles_the_doubt():
    world = two_ways()
    doubt = {name: {"blocks": {(3, 1, 0): name}} for name in ("air", "oak_planks")}
    model = bn.MindModel("red", doubt=doubt, **DECIDED)
    with bn.Nest(world) as nest:
        world.step(9)
        assert nest["/"].infer(model, since=5).mean("actual.oak_planks") == 1
        nest["/"].switch("open", at=5)
        nest["/"].edit(blocks=OPEN)
        nest["/"].step(4)
        assert nest["/"].infer(model, since=5).mean("actual.air") == 1


def test_later_edits_are_repeated():
    world = two_ways()
    model = bn.MindModel("red", rationality=20, **DECIDED)
    with bn.Nest(world) as nest:
        world.step(30)
        nest["/"].switch("open", at=5)
        nest["/"].edit(blocks={**OPEN, (5, 1, 3): "chest"}, containers={(5, 1, 3): {"apple": 2}})
        nest["/"].step(20)
        idle = nest["/"].imagine(2, actors={"red": {"idle": ""}}, n=1)
        assert idle.impossible is None
        assert idle[0].state.blocks[3, 1, 0] == "air"
        assert idle[0].at(4).state.blocks[3, 1, 0] == "oak_planks"
        assert idle[0].state.containers[5, 1, 3].items == {"apple": 2}
        walks = nest["/"].imagine(4, actors={"red": {"walk": model}}, evidence=ANYTHING, n=1)
        path = walked(walks[0], range(4, 20))
        assert path[1] == (0, 1)
        assert walks[0].state.agents["red"].position == (6.5, 1.0, 0.5)


def test_feet_are_those_of_the_states_at_every_tick():
    world = two_ways()
    model = bn.MindModel("red", rationality=1, **DECIDED)
    with bn.Nest(world) as nest:
        world.step(20)
        for history in nest["/"].imagine(3, actors={"red": {"w": model}}, evidence=ANYTHING, n=4):
            read = {t: history.at(t).state.agents["red"].position for t in range(3, 21)}
            assert history.feet("red") == read
        with pytest.raises(bn.PathError, match="no agent 'blue'; there are red"):
            history.feet("blue")
