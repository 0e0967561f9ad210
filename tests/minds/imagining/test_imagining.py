"""Weighted histories of the unseen past."""

import math
import warnings

import pytest

import beliefnest as bn
from beliefnest.errors import (
    BranchError,
    InputError,
    PathError,
    StoreError,
    TickError,
    UnknownNameError,
)
from beliefnest.minds.imagining.imagining import ImaginationWarning
from beliefnest.minds.imagining.particles import spread

CHEST = (9, 1, 2)
TAKE = f"await getItemFromChest(bot, new Vec3{CHEST}, {{ diamond: 1 }})"


def kitchen(store=None, perception=None, further=(), knows=(CHEST,)):
    """Two rooms with a doorway between; Anne knows of the diamond in the chest of the second."""
    blocks = {(x, 0, z): "stone" for x in range(12) for z in range(5)}
    for z in (0, 1, 3, 4):
        blocks |= {(5, 1, z): "stone", (5, 2, z): "stone"}
    world = bn.ScriptedWorld(
        box=((0, 0, 0), (11, 3, 4)),
        blocks=blocks,
        agents={"anne": (1.5, 1, 0.5), "bob": (7.5, 1, 2.5), **dict(further)},
        containers={CHEST: {"diamond": 1}},
    )
    contents = {place: ({"diamond": 1}, True) for place in knows}
    known = bn.InitialBelief(("anne",), containers=contents, agents={"bob": (7.5, 1, 2.5)})
    return bn.Nest(
        world,
        perception=perception,
        static_blocks=["stone", "air", "chest"],
        initial_beliefs=[known],
        store=store,
    )


def look_into_chest(nest, *, is_taken):
    """Let Anne look into the chest, from which Bob has taken the diamond or not."""
    world = nest.scripted_world
    since = nest.tick
    world.step(5)
    if is_taken:
        world.withdraw("bob", CHEST, {"diamond": 1})
    world.step(5)
    world.open("anne", CHEST)
    return since


def test_an_absent_item_tells_who_took_it():
    for is_taken in (True, False):
        with kitchen() as nest:
            since = look_into_chest(nest, is_taken=is_taken)
            imagined = nest["/anne"].imagine(since, actors={"bob": {"fetch": TAKE, "idle": ""}})
            assert imagined.impossible is None
            shares = imagined.by_candidate("bob")
            assert shares == pytest.approx({"fetch": float(is_taken), "idle": float(not is_taken)})
            took = imagined.share({"agent": "bob", "items": {"diamond": 1}})
            assert took == pytest.approx(float(is_taken))
            there = imagined.share({"container": CHEST, "items": {"diamond": 1}})
            assert there == pytest.approx(float(not is_taken))
            assert imagined.effective_size == pytest.approx(100)
            assert imagined.log_evidence == pytest.approx(math.log(0.5))


def test_simulators_of_a_history_lead_to_other_ticks_and_beliefs():
    with kitchen() as nest:
        since = look_into_chest(nest, is_taken=True)
        history = nest["/anne"].imagine(since, actors={"bob": {"fetch": TAKE}}, n=1)[0]
        believed = history.at(since)["/bob"]
        assert believed.path == history["/bob"].at(since).path == "/anne/bob"
        assert believed.state.containers == history["/bob"].at(since).state.containers
        assert believed.state.containers != history["/bob"].state.containers
        for simulator in (history, history["/bob"]):
            with pytest.raises(TickError, match="in the future"):
                simulator.at(history.tick + 1)


def test_without_evidence_shares_are_the_weights():
    with kitchen() as nest:
        nest.scripted_world.step(20)
        imagined = nest["/anne"].imagine(
            0,
            actors={"bob": {"fetch": TAKE, "idle": ""}},
            n=1000,
            weights={"bob": {"fetch": 0.2, "idle": 0.8}},
        )
        assert imagined.by_candidate("bob") == pytest.approx({"fetch": 0.2, "idle": 0.8}, abs=1e-3)


def test_evidence_with_mistakes_as_bayes_says():
    with kitchen() as nest:
        nest.scripted_world.step(20)
        imagined = nest["/anne"].imagine(
            0,
            actors={"bob": {"fetch": TAKE, "idle": ""}},
            n=1000,
            weights={"bob": {"fetch": 0.3, "idle": 0.7}},
            evidence=[
                {"container": CHEST, "items": {"diamond": 1}, "mistaken": 0.1},
                {"agent": "bob", "items": {"diamond": 1}, "mistaken": 0.25},
            ],
        )
        # Fetched: seen in the chest by mistake (0.1), with Bob rightly (0.75); idle: 0.9, 0.25.
        fetched, idle = 0.3 * 0.1 * 0.75, 0.7 * 0.9 * 0.25
        shares = imagined.by_candidate("bob")
        assert shares["fetch"] == pytest.approx(fetched / (fetched + idle), abs=2e-3)
        assert imagined.log_evidence == pytest.approx(math.log(fetched + idle), abs=1e-2)


def test_evidence_that_nothing_explains_is_impossible():
    with kitchen() as nest:
        nest.scripted_world.step(3)
        with pytest.warns(ImaginationWarning, match="none of 10 histories"):
            imagined = nest["/anne"].imagine(
                0,
                actors={"bob": {"idle": ""}},
                n=10,
                evidence=[{"agent": "bob", "items": {"diamond": 1}}],
            )
        assert imagined.impossible.tick == 3
        assert imagined.effective_size == 0
        assert len(imagined) == 10


def test_says_when_the_last_history_was_lost():
    with kitchen() as nest:
        since = look_into_chest(nest, is_taken=True)
        with pytest.warns(ImaginationWarning, match="lost at|none of"):
            imagined = nest["/anne"].imagine(since, actors={"bob": {"idle": ""}}, n=10)
        assert imagined.impossible.tick == nest.tick
        assert imagined.log_evidence == -math.inf
        assert imagined.impossible.text == (
            "contents of containers in the last 10 histories differ from what was perceived"
        )
        assert imagined[0].state.containers[CHEST].items == {"diamond": 1}
        assert f"tick {nest.tick}" in repr(imagined)
        with pytest.warns(ImaginationWarning, match="places of agents in the last history differ"):
            one = nest["/anne"].imagine(
                since,
                actors={"bob": {"come": "await goToPosition(bot, new Vec3(4, 1, 2), 0)"}},
                n=1,
            )
        assert repr(one).startswith("<1 history of /anne")


def test_few_histories_are_warned_of():
    with kitchen() as nest:
        since = look_into_chest(nest, is_taken=True)
        with pytest.warns(ImaginationWarning, match=r"effective size is 1\.0 of 20"):
            nest["/anne"].imagine(
                since,
                actors={"bob": {"fetch": TAKE, "idle": ""}},
                n=20,
                weights={"bob": {"fetch": 0.05, "idle": 0.95}},
            )


def test_histories_are_looked_at_asked_and_forked():
    with kitchen() as nest:
        since = look_into_chest(nest, is_taken=True)
        before = len(nest["/anne"].branches())
        imagined = nest["/anne"].imagine(since, actors={"bob": {"fetch": TAKE, "idle": ""}}, n=8)
        history = imagined[0]
        assert history.candidates == {"bob": "fetch"}
        assert history.weight == pytest.approx(1 / len(imagined))
        assert history.state.agents["bob"].inventory == {"diamond": 1}
        assert history["/bob"].state.containers[CHEST].items == {}
        assert history.at(since).state.containers[CHEST].items == {"diamond": 1}
        assert "svg" in history.figure()._repr_html_()
        believed = {"path": "/bob", "container": CHEST, "items": {"diamond": 1}}
        assert imagined.share(believed) == 0
        fork = history.fork("what if")
        back = f"await depositItemIntoChest(bot, new Vec3{CHEST}, {{ diamond: 1 }})"
        assert fork.run("bob", back).ok
        assert fork.state.containers[CHEST].items == {"diamond": 1}
        assert history.state.containers[CHEST].items == {}
        assert len(nest["/anne"].branches()) == before


def test_a_history_is_kept_by_name_alone(tmp_path):
    store = tmp_path / "run.db"
    with kitchen(store) as nest:
        since = look_into_chest(nest, is_taken=True)
        anne = nest["/anne"]
        imagined = anne.imagine(since, actors={"bob": {"fetch": TAKE, "idle": ""}}, n=8)
        imagined.keep(0, "fetched")
        assert [info.key.branch for info in anne.branches()] == ["fetched"]
        with pytest.raises(BranchError, match="already has a branch"):
            imagined.keep(1, "fetched")
        anne.switch("fetched")
        assert anne.state.agents["bob"].inventory == {"diamond": 1}
    with bn.Nest.read(store) as recorded:
        again = recorded["/anne"]
        recorded.select("/anne", "follow")
        imagined = again.imagine(since, actors={"bob": {"fetch": TAKE, "idle": ""}}, n=8)
        assert imagined.by_candidate("bob")["fetch"] == pytest.approx(1)
        with pytest.raises(StoreError, match="only read"):
            imagined.keep(0, "other")
        with pytest.raises(InputError, match="only read"):
            imagined[0].fork()


def test_same_seed_same_histories():
    place = "new Vec3(7 + Math.floor(5 * Math.random()), 1, 1)"
    program = f"for (let i = 0; i < 3; i++) await goToPosition(bot, {place}, 0)"

    def drawn(seed):
        with kitchen() as nest:
            nest.scripted_world.step(20)
            imagined = nest["/anne"].imagine(0, actors={"bob": {"walk": program}}, n=30, seed=seed)
            return [history.state.agents["bob"].position for history in imagined]

    first = drawn(1)
    assert first == drawn(1)
    assert first != drawn(2)
    assert len(set(first)) > 2


def test_what_the_observer_cannot_perceive_changes_nothing():
    def result(is_taken):
        with kitchen() as nest:
            world = nest.scripted_world
            world.step(5)
            if is_taken:
                world.withdraw("bob", CHEST, {"diamond": 1})
                world.place_agent("bob", (10.5, 1, 0.5))
            else:
                world.step(2)
            world.place_agent("anne", (2.5, 1, 0.5))
            model = walking()
            imagined = nest["/anne"].imagine(
                0, actors={"bob": {"fetch": TAKE, "model": model, "idle": ""}}, n=60
            )
            return (
                imagined.weights,
                imagined.by_candidate("bob"),
                [history.state.agents["bob"].position for history in imagined],
            )

    assert result(True) == result(False)


def walking(**further):
    """Return a model of Bob in the second room, who wants one of its corners."""
    return bn.MindModel(
        "bob",
        goals={"near": {"at": (7, 1, 0)}, "far": {"at": (11, 1, 0)}},
        utilities={"near": [0, 8], "far": [0, 8]},
        rationality=1.0,
        **further,
    )


@pytest.mark.parametrize(
    ("arguments", "error", "text"),
    [
        ({"since": 30}, TickError, "after until"),
        ({"until": 99}, TickError, "future"),
        ({"actors": {"carl": {"a": ""}}}, PathError, "no agent 'carl'"),
        ({"actors": {}}, InputError, "give candidates by name"),
        ({"actors": {"bob": {}}}, InputError, "candidates of bob"),
        ({"actors": {"bob": {"a": 3}}}, InputError, "give a program"),
        ({"actors": {"bob": {"a": "await ("}}}, InputError, "candidate 'a' of bob"),
        ({"weights": {"bob": {"fetch": 0.5}}}, InputError, "sum to 0.5"),
        ({"weights": {"bob": {"steal": 1}}}, InputError, "name steal"),
        ({"weights": {"anne": {"fetch": 1}}}, PathError, "no candidates"),
        ({"n": 0}, InputError, "n is 0"),
        ({"seed": "x"}, InputError, "seed is"),
        ({"tolerance": (1,)}, InputError, "tolerance is"),
        ({"evidence": []}, InputError, "evidence is"),
        ({"evidence": [{"agent": "bob", "mistaken": 2}]}, InputError, "mistaken is 2"),
        ({"evidence": [{"container": CHEST}]}, InputError, "makes no sense"),
    ],
)
def test_bad_input_gets_one_clear_error(arguments, error, text):
    with kitchen() as nest:
        nest.scripted_world.step(20)
        given = {"since": 0, "actors": {"bob": {"fetch": TAKE, "idle": ""}}, "n": 4, **arguments}
        with pytest.raises(error, match=text):
            nest["/anne"].imagine(**given)


def test_bad_questions_get_one_clear_error():
    with kitchen() as nest:
        nest.scripted_world.step(2)
        imagined = nest["/anne"].imagine(0, actors={"bob": {"idle": ""}}, n=4)
        with pytest.raises(PathError, match="no candidates"):
            imagined.by_candidate("anne")
        with pytest.raises(InputError, match="makes no sense"):
            imagined.share({"container": CHEST})
        with pytest.raises(UnknownNameError, match="diamnd"):
            imagined.share({"container": CHEST, "items": {"diamnd": 1}})
        with pytest.raises(InputError, match="no history 4"):
            imagined[4]


def test_an_actor_whose_place_is_unknown_is_refused():
    with kitchen() as nest:
        nest.scripted_world.step(2)
        with pytest.raises(InputError, match="where anne was at tick 0 is not known in /bob"):
            nest["/bob"].imagine(0, actors={"anne": {"idle": ""}}, n=4)


def test_the_real_world_is_imagined_too():
    with kitchen() as nest:
        since = look_into_chest(nest, is_taken=True)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ImaginationWarning)
            exact = nest["/"].imagine(since, actors={"bob": {"fetch": TAKE, "idle": ""}}, n=20)
        # Bob took it at tick 6; the program opens the chest before.
        assert exact.impossible is not None
        lax = nest["/"].imagine(
            since, actors={"bob": {"fetch": TAKE, "idle": ""}}, n=20, tolerance=(3, 6)
        )
        assert lax.by_candidate("bob")["fetch"] == pytest.approx(1)


def test_a_policy_decides_in_each_history():
    asked = []

    def policy(simulator):
        asked.append(simulator.path)
        has = simulator.state.agents["bob"].inventory.get("diamond", 0)
        return "" if has or len(asked) > 6 else TAKE

    with kitchen() as nest:
        since = look_into_chest(nest, is_taken=True)
        imagined = nest["/anne"].imagine(since, actors={"bob": {"policy": policy}}, n=3)
        assert imagined.share({"agent": "bob", "items": {"diamond": 1}}) == pytest.approx(1)
        # Asked at the beginning and when the program was over, in each history.
        assert asked == ["/anne/bob"] * 6


def test_spreads_by_weight():
    import random

    weights = [0.5, 0.25, 0.25, 0.0]
    for seed in range(20):
        numbers = spread(weights, 8, random.Random(seed))
        assert [numbers.count(number) for number in range(4)] == [4, 2, 2, 0]


LOTTERY = """
await waitTicks(bot, 2)
if (Math.random() < 0.8) await goToPosition(bot, new Vec3(3, 1, 2), 0)
await waitTicks(bot, 12)
if (Math.random() < 0.3) await getItemFromChest(bot, new Vec3(9, 1, 2), { diamond: 1 })
"""


def test_resampling_keeps_expectations():
    with kitchen() as nest:
        nest.scripted_world.step(20)
        imagined = nest["/anne"].imagine(0, actors={"bob": {"lottery": LOTTERY}}, n=300)
        # Anne would have seen him come; a fifth of the histories is left, and copied.
        assert len(imagined) == 300
        assert 40 < imagined.effective_size < 80
        assert imagined.log_evidence == pytest.approx(math.log(0.2), abs=0.4)
        # After that the copies drew with seeds of their own.
        took = imagined.share({"agent": "bob", "items": {"diamond": 1}})
        assert took == pytest.approx(0.3, abs=0.1)
        again = nest["/anne"].imagine(0, actors={"bob": {"lottery": LOTTERY}}, n=300)
        assert again.share({"agent": "bob", "items": {"diamond": 1}}) == took


def test_tolerance_in_cells_and_ticks():
    come = "await goToPosition(bot, new Vec3(3, 1, 2), 0)"
    later = "await waitTicks(bot, 2); " + come
    with kitchen() as nest:
        world = nest.scripted_world
        for x in (6, 5, 4, 3):
            world.place_agent("bob", (x + 0.5, 1, 2.5))
        world.step(6)
        anne, actors = nest["/anne"], {"bob": {"come": come, "later": later, "idle": ""}}
        exact = anne.imagine(0, actors=actors, n=30)
        assert exact.by_candidate("bob")["come"] == pytest.approx(1)
        lax = anne.imagine(0, actors=actors, n=30, tolerance=(0, 2))
        assert lax.by_candidate("bob") == pytest.approx({"come": 0.5, "later": 0.5, "idle": 0})
        near = {"bob": {"come": come, "beside": come.replace("3, 1, 2", "3, 1, 3"), "idle": ""}}
        cells = anne.imagine(0, actors=near, n=30, tolerance=(1, 0))
        assert cells.by_candidate("bob") == pytest.approx({"come": 0.5, "beside": 0.5, "idle": 0})


def test_a_belief_within_a_belief_is_imagined():
    with kitchen() as nest:
        world = nest.scripted_world
        world.place_agent("bob", (3.5, 1, 2.5))
        since = nest.tick
        world.place_agent("bob", (4.5, 1, 2.5))
        world.place_agent("bob", (5.5, 1, 2.5))
        come = {"go": "await goToPosition(bot, new Vec3(5, 1, 2), 0)", "stay": ""}
        for path in ("/anne", "/bob/anne", "/anne/bob"):
            imagined = nest[path].imagine(since, actors={"bob": come}, n=20)
            assert imagined.by_candidate("bob") == pytest.approx({"go": 1.0, "stay": 0.0})


def test_an_open_door_is_evidence():
    door = (5, 1, 2)
    blocks = {(x, 0, z): "stone" for x in range(12) for z in range(5)}
    for z in (0, 1, 3, 4):
        blocks |= {(5, 1, z): "stone", (5, 2, z): "stone"}
    blocks |= {
        door: "oak_door[half=lower,facing=east,open=false]",
        (5, 2, 2): "oak_door[half=upper,facing=east,open=false]",
    }
    world = bn.ScriptedWorld(
        box=((0, 0, 0), (11, 3, 4)),
        blocks=blocks,
        agents={"anne": (1.5, 1, 2.5), "bob": (7.5, 1, 2.5)},
    )
    prior = bn.InitialBelief(("anne",), agents={"bob": (7.5, 1, 2.5)})
    names = ["stone", "air", "oak_door"]
    with bn.Nest(world, static_blocks=names, initial_beliefs=[prior]) as nest:
        world.step(1)
        world.use_door("bob", door, open=True)
        world.step(3)
        opened = {"opened": f"await openDoor(bot, new Vec3{door})", "idle": ""}
        state = "oak_door[open=true]"
        by_percept = nest["/anne"].imagine(0, actors={"bob": opened}, n=20, tolerance=(0, 1))
        assert by_percept.by_candidate("bob") == pytest.approx({"opened": 1.0, "idle": 0.0})
        assert by_percept.share({"block": door, "state": state}) == pytest.approx(1)
        by_condition = nest["/anne"].imagine(
            0, actors={"bob": opened}, n=20, evidence=[{"block": door, "state": state}]
        )
        assert by_condition.by_candidate("bob") == pytest.approx({"opened": 1.0, "idle": 0.0})


def test_says_how_far_it_is():
    told = []
    with kitchen() as nest:
        nest.scripted_world.step(3)
        nest["/anne"].imagine(
            0, actors={"bob": {"idle": ""}}, n=2, on_progress=lambda *each: told.append(each)
        )
    assert told == [("imagining histories", done, 3) for done in (1, 2, 3)]


def test_models_of_two_agents_share_their_doubt():
    doubt = {"full": {"containers": {CHEST: {"diamond": 1}}}, "empty": {"containers": {CHEST: {}}}}

    def model(agent, **further):
        return bn.MindModel(
            agent,
            goals={"take": {"item": "diamond"}, "corner": {"at": (7, 1, 0)}},
            utilities={"take": 9, "corner": 1},
            doubt=doubt,
            actual="unknown",
            **further,
        )

    with kitchen(further={"carl": (8.5, 1, 0.5)}) as nest:
        nest.scripted_world.step(15)
        actors = {"bob": {"model": model("bob")}, "carl": {"model": model("carl")}}
        anywhere = [{"agent": "bob", "at": (7, 1, 2), "within": 99.0}]
        imagined = nest["/"].imagine(0, actors=actors, n=20, evidence=anywhere)
        for history in imagined:
            assert len({told["actual"] for told in history.hypotheses.values()}) == 1
        actors["carl"] = {"model": model("carl", credences=[[0.9, 0.1]])}
        nest["/"].imagine(0, actors=actors, n=2, evidence=anywhere)
        other = {"full": doubt["full"], "half": {"containers": {CHEST: {"emerald": 1}}}}
        actors["carl"] = {"model": bn.MindModel("carl", {"c": {"at": (7, 1, 0)}}, {"c": 1}, other)}
        with pytest.raises(InputError, match="doubt the same elements"):
            nest["/"].imagine(0, actors=actors, n=2)


def test_live_late_and_recorded_histories_are_the_same(tmp_path):
    store = tmp_path / "run.db"

    def drawn(simulator, until=None):
        actors = {"bob": {"model": walking(), "fetch": TAKE}}
        imagined = simulator.imagine(0, until, actors=actors, n=30, seed=3)
        places = [history.state.agents["bob"].position for history in imagined]
        return imagined.weights, imagined.log_evidence, places

    with kitchen(store) as nest:
        nest.scripted_world.step(9)
        nest.scripted_world.place_agent("anne", (1.5, 1, 1.5))
        live = drawn(nest["/anne"])
        head = nest.tick
        nest.scripted_world.place_agent("anne", (2.5, 1, 1.5))
        assert drawn(nest["/anne"], head) == live
        assert drawn(nest.at(head)["/anne"]) == live
    with bn.Nest.read(store) as recorded:
        assert drawn(recorded["/anne"], head) == live
        assert drawn(recorded.at(head)["/anne"]) == live
    with bn.Nest.resume(store) as resumed:
        assert drawn(resumed["/anne"], head) == live


def test_an_empty_container_and_empty_hands_are_conditions():
    with kitchen() as nest:
        nest.scripted_world.step(20)
        drawn = {"since": 0, "actors": {"bob": {"fetch": TAKE, "idle": ""}}, "n": 10}
        imagined = nest["/anne"].imagine(**drawn)
        assert imagined.share({"container": CHEST, "items": {}}) == pytest.approx(0.5)
        assert imagined.share({"agent": "bob", "items": {}}) == pytest.approx(0.5)
        assert imagined.share({"path": "/bob", "container": CHEST, "items": {}}) == pytest.approx(
            0.5
        )
        told = nest["/anne"].imagine(**drawn, evidence=[{"container": CHEST, "items": {}}])
        assert told.by_candidate("bob") == pytest.approx({"fetch": 1, "idle": 0})


def test_a_failing_candidate_is_named_once():
    with kitchen() as nest:
        nest.scripted_world.step(3)
        slip = "await waitTicks(bot, 1); nobody()"
        with pytest.warns(
            ImaginationWarning, match=r"candidate 'slip' of bob failed: .*nobody.*[^.]\. From there"
        ):
            imagined = nest["/anne"].imagine(0, actors={"bob": {"slip": slip, "idle": ""}}, n=4)
        assert imagined.failed.keys() == {"bob"}
        assert "nobody" in imagined.failed["bob"]["slip"]
        assert "bob 'slip' failed" in repr(imagined)
        frame = imagined.frame()
        assert list(frame.columns) == ["history", "weight", "agent", "candidate", "failed"]
        assert sorted(frame[frame.failed.notna()].candidate) == ["slip", "slip"]
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            nest["/anne"].imagine(0, actors={"bob": {"fetch": TAKE, "idle": ""}}, n=4)


HIDDEN, BOX = (6, 1, 0), (4, 1, 3)


def _pass_on(world):
    with world.tick():
        world.withdraw("bob", BOX, {"apple": 1})
        world.deposit("carl", BOX, {"bread": 1})


def _look_twice(world):
    world.open("anne", BOX)
    world.withdraw("bob", BOX, {"apple": 1})
    world.open("anne", BOX)


@pytest.mark.parametrize(
    "act",
    [
        lambda world: world.withdraw("bob", BOX, {"apple": 1}),
        lambda world: world.withdraw("bob", HIDDEN, {"apple": 1}),
        lambda world: world.deposit("carl", HIDDEN, {"bread": 1}),
        lambda world: world.use_lever("bob", (6, 1, 4), powered=True),
        lambda world: world.deposit("anne", BOX, {"egg": 1}),
        _pass_on,
        _look_twice,
    ],
    ids=["take", "take unseen", "put unseen", "switch unseen", "put", "pass on", "look twice"],
)
def test_what_others_and_the_owner_do_with_the_unknown_agrees(act):
    beams = {(5, y, z): "bricks" for y in (1, 2) for z in (0, 1, 3, 4)}
    world = bn.ScriptedWorld(
        box=((0, 0, 0), (8, 3, 4)),
        blocks={(x, 0, z): "stone" for x in range(9) for z in range(5)}
        | beams
        | {(6, 1, 4): "lever[face=floor]"},
        agents={
            "anne": (0.5, 1, 2.5),
            "bob": (6.5, 1, 2.5),
            "carl": (3.5, 1, 2.5),
            "dora": (1.5, 1, 0.5),
        },
        containers={BOX: {"apple": 1}, HIDDEN: {"apple": 1}},
        inventories={"carl": {"bread": 1}, "anne": {"egg": 1}},
    )
    with bn.Nest(world, static_blocks=["stone"]) as nest:
        world.step(2)
        act(world)
        world.step(2)
        imagined = nest["/anne"].imagine(since=0, actors={"dora": {"idle": ""}}, n=1)
        assert imagined.impossible is None


def test_contents_that_were_learnt_are_evidence_from_then_on():
    with kitchen(knows=()) as nest:
        nest.scripted_world.open("anne", CHEST)
        look_into_chest(nest, is_taken=True)
        later = f"await waitTicks(bot, 2); {TAKE}"
        imagined = nest["/anne"].imagine(
            since=0, actors={"bob": {"took it": later, "idle": ""}}, n=10
        )
        assert imagined.by_candidate("bob") == {"took it": 1, "idle": 0}
