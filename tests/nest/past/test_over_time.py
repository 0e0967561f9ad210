"""A belief through all of its time, on every branch there is of it."""

import pytest
from tests.nest.comparing import everything
from tests.nest.places import BOX, CHEST, CORNER, EAST, GAP, MEETING, WEST

import beliefnest as bn
from beliefnest.errors import PathError
from beliefnest.timeline.journal import TimelineKey

AGENTS = {"observer": WEST, "sally": MEETING, "anne": GAP}
MAIN, OTHER = TimelineKey((), "main"), TimelineKey((), "other")
PLAN, IDEA = TimelineKey(("observer",), "plan"), TimelineKey(("observer", "sally"), "idea")


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """Make a run with branches of the real world, of a belief, and of one below it in the past."""
    store = tmp_path_factory.mktemp("run") / "run.bn"
    world = bn.ScriptedWorld(BOX, CORNER, AGENTS, {"anne": {"diamond": 1}}, {CHEST: {"egg": 1}})
    with bn.Nest(world, static_blocks=["stone"], store=store) as nest:
        world.open("observer", CHEST)
        world.place_agent("sally", EAST)
        world.step(3)
        world.set_block((2, 0, 4), "glass")
        nest["/observer"].switch("plan", at=1)
        nest["/observer"].scripted.withdraw("anne", CHEST, {"egg": 1})
        nest["/observer"].step(2)
        nest["/observer"].edit({(2, 0, 4): "bricks"}, {CHEST: {"bread": 2}})
        nest["/observer/sally"].switch("idea", at=2)
        nest["/observer/sally"].scripted.set_block((3, 0, 3), "stone")
        nest["/observer/sally"].switch("follow")
        nest["/"].switch("other", at=4)
        nest.scripted_world.say("anne", "hello")
    return store


@pytest.mark.parametrize(
    ("path", "timelines"),
    [
        ("/", [MAIN, OTHER]),
        ("/observer", [MAIN, PLAN, OTHER]),
        ("/observer/sally", [MAIN, PLAN, IDEA, OTHER]),
        ("/observer/sally/anne", [MAIN, PLAN, IDEA, OTHER]),
        ("/observer/anne", [MAIN, PLAN, OTHER]),
        ("/sally", [MAIN, OTHER]),
    ],
)
def test_it_is_told_on_every_branch_as_it_is_read_there(run, path, timelines):
    with bn.Nest.read(run) as nest:
        moments = list(nest.over_time(path))
        assert list(dict.fromkeys(moment.timeline for moment in moments)) == timelines
        for moment in moments:
            for below in (PLAN, IDEA):
                nest.select("/" + "/".join(below.path), "follow")
            nest.select("/" + "/".join(moment.timeline.path), moment.timeline.branch)
            there = nest.simulator(path, moment.tick)
            assert everything(there.state) == everything(moment.state)


def test_there_is_a_moment_for_the_first_tick_and_each_with_a_change(run):
    with bn.Nest.read(run) as nest:
        ticks: dict[TimelineKey, list[int]] = {}
        for moment in nest.over_time("/observer/sally"):
            ticks.setdefault(moment.timeline, []).append(moment.tick)
    assert ticks == {MAIN: [0, 1, 2, 6], PLAN: [1, 2, 4], IDEA: [2, 3], OTHER: [4, 5]}


@pytest.mark.parametrize("path", ["/", "/observer", "/observer/sally"])
def test_changes_of_blocks_add_up_to_the_blocks_there_are(run, path):
    with bn.Nest.read(run) as nest:
        held: dict[TimelineKey, dict[tuple[int, int, int], str]] = {}
        for moment in nest.over_time(path):
            blocks = held.setdefault(moment.timeline, {})
            for place, block in moment.blocks.items():
                blocks.pop(place, None)
                if block is not None:
                    blocks[place] = block
            known = {p: moment.state.blocks[p] for p in moment.state.blocks}
            assert blocks == {p: block for p, block in known.items() if block is not None}


def test_a_belief_of_nobody_is_refused(run):
    with bn.Nest.read(run) as nest, pytest.raises(PathError):
        nest.over_time("/bob")
