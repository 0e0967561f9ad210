"""A run that was closed goes on where it was; a recorded one can be read."""

import pytest
from tests.nest.comparing import everything
from tests.nest.places import BOX, CHEST, CORNER, EAST, GAP, MEETING, WEST

import beliefnest as bn
from beliefnest.errors import BranchError, StoreError
from beliefnest.timeline.store import Journal

AGENTS = {"observer": WEST, "sally": MEETING, "anne": GAP}
PATHS = ["/", "/observer", "/observer/sally", "/sally", "/sally/anne", "/anne"]
BRANCHED = ["/", "/observer"]


def open_in(store):
    world = bn.ScriptedWorld(BOX, CORNER, AGENTS, {"anne": {"diamond": 1}}, {CHEST: {"emerald": 1}})
    return bn.Nest(world, bn.Perception(hearing="sight"), ["stone"], store=store)


def first_half(nest):
    world = nest.scripted_world
    world.open("observer", CHEST)
    world.place_agent("sally", EAST)
    nest["/observer"].switch("plan")
    nest["/observer"].scripted.withdraw("anne", CHEST, {"emerald": 1})
    nest["/observer"].edit(containers={CHEST: {"bread": 2}})
    nest["/"].switch("second", at=1)
    nest.scripted_world.say("anne", "hello")
    nest["/sally"].switch("idea")
    nest["/sally"].switch("follow")


def second_half(nest):
    nest.scripted_world.deposit("anne", CHEST, {"diamond": 1})
    nest["/observer"].scripted.withdraw("observer", CHEST, {"bread": 1})
    nest["/observer"].step(3)
    nest["/sally"].switch("idea")
    nest["/sally"].switch("follow")
    nest["/"].switch("main")
    nest.scripted_world.step(2)


def held(nest):
    simulators = [nest[path] for path in PATHS]
    return (
        [(each.mode, each.branch, each.tick, everything(each.state)) for each in simulators],
        [each.branches() for each in simulators],
    )


def test_a_resumed_run_holds_what_it_held(tmp_path):
    with open_in(tmp_path / "run.bn") as nest:
        first_half(nest)
        before = held(nest)
    with bn.Nest.resume(tmp_path / "run.bn") as nest:
        assert held(nest) == before


def test_a_resumed_run_goes_on_as_one_that_was_never_stopped(tmp_path):
    with open_in(None) as nest:
        first_half(nest)
        second_half(nest)
        expected = held(nest)
    with open_in(tmp_path / "run.bn") as nest:
        first_half(nest)
    with bn.Nest.resume(tmp_path / "run.bn") as nest:
        second_half(nest)
        assert held(nest) == expected
    with bn.Nest.resume(tmp_path / "run.bn") as nest:
        assert held(nest) == expected


def test_a_resumed_run_has_one_writer(tmp_path):
    with open_in(tmp_path / "run.bn"), pytest.raises(StoreError, match="one writer"):
        bn.Nest.resume(tmp_path / "run.bn")
    with bn.Nest.resume(tmp_path / "run.bn") as nest:
        assert nest.tick == 0


def test_a_run_is_not_begun_over_another(tmp_path):
    open_in(tmp_path / "run.bn").close()
    with pytest.raises(StoreError, match="exists"):
        open_in(tmp_path / "run.bn")


def test_a_run_stopped_while_it_began_says_so(tmp_path):
    Journal.create_file(tmp_path / "run.bn").close()
    for opened in (bn.Nest.resume, bn.Nest.read):
        with pytest.raises(StoreError, match="while it began"):
            opened(tmp_path / "run.bn")


def test_seed_and_setting_are_kept(tmp_path):
    scenario = bn.Scenario.load("sally-anne", condition=2)
    with bn.Nest.open(scenario, "scripted", tmp_path / "run.bn", seed=5):
        pass
    with bn.Nest.resume(tmp_path / "run.bn") as nest:
        assert nest.seed == 5
        assert nest.setting.script == scenario.setting.script
    with Journal.read(tmp_path / "run.bn") as journal:
        run = journal.records.run()
    assert (run.condition, run.text) == ("2", scenario.text)
    assert "beliefnest" in run.versions


def test_a_recorded_run_is_read_while_it_goes_on(tmp_path):
    with open_in(tmp_path / "run.bn") as nest:
        first_half(nest)
        with bn.Nest.read(tmp_path / "run.bn") as reading:
            for path in PATHS:
                assert everything(reading[path].state) == everything(nest[path].state)
                assert reading[path].tick == nest[path].tick
            assert reading.tick == nest.tick
            assert not any(hasattr(reading[path], act) for path in PATHS for act in ("run", "edit"))


def test_a_branch_is_renamed_where_a_simulator_is_on_it(tmp_path):
    with open_in(tmp_path / "run.bn") as nest:
        first_half(nest)
        nest["/observer"].rename("plan", "better")
        nest["/"].rename("main", "first")
        assert nest["/observer"].branch == "better"
        nest["/observer"].scripted.say("anne", "here")
        before = held(nest)
    with bn.Nest.resume(tmp_path / "run.bn") as nest:
        assert held(nest) == before
        nest["/"].switch("first")
        assert nest.tick == 2


def test_a_name_in_use_or_reserved_is_refused(tmp_path):
    with open_in(tmp_path / "run.bn") as nest:
        first_half(nest)
        before = held(nest)
        for old, new in (("main", "second"), ("main", "follow"), ("main", "a/b"), ("no", "x")):
            with pytest.raises(BranchError):
                nest["/"].rename(old, new)
        assert held(nest) == before


@pytest.mark.parametrize("stored", [True, False])
def test_only_leaves_that_nobody_is_on_are_deleted(tmp_path, stored):
    with open_in(tmp_path / "run.bn" if stored else None) as nest:
        first_half(nest)
        before = held(nest)
        for name in ("main", "second", "none"):
            with pytest.raises(BranchError):
                nest["/"].delete(name)
        with pytest.raises(BranchError, match="is on branch"):
            nest["/"].delete("main", recursive=True)
        assert held(nest) == before
        nest["/sally"].delete("idea")
        assert nest["/sally"].branches() == ()


@pytest.mark.parametrize("stored", [True, False])
def test_all_that_rests_on_a_branch_is_deleted_with_it(tmp_path, stored):
    with open_in(tmp_path / "run.bn" if stored else None) as nest:
        first_half(nest)
        nest["/observer"].switch("follow")
        nest["/"].switch("other", at=2)
        nest["/"].switch("main")
        nest["/"].delete("second", recursive=True)
        assert [info.key.branch for info in nest["/"].branches()] == ["main"]
        assert nest["/sally"].branches() == ()
        nest["/observer"].switch("plan")
        assert nest["/observer"].state.containers[CHEST].items == {"bread": 2}


def test_a_branch_is_described(tmp_path):
    with open_in(tmp_path / "run.bn") as nest:
        nest["/"].describe("main", "what happened")
    with bn.Nest.resume(tmp_path / "run.bn") as nest:
        assert nest["/"].branches()[0].description == "what happened"
