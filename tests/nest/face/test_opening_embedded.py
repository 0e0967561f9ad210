"""In Minecraft too, a resumed run gives the frames of one that was never stopped."""

import pytest

import beliefnest as bn
from beliefnest.timeline.compare import first_difference
from beliefnest.timeline.journal import TimelineKey
from beliefnest.timeline.store import Journal

SEED = 3
ROAM = """
for (let i = 0; i < 2; i++) {
  const target = [0, -7][Math.floor(Math.random() * 2)]
  await goToPosition(bot, new Vec3(target, -51, -6))
  bot.chat('here ' + Math.random())
}"""


def first_half(nest):
    nest.play()
    nest["/observer/sally"].switch("plan")
    nest["/observer/sally"].run("sally", ROAM)


def second_half(nest):
    nest["/observer/sally"].run("sally", ROAM)
    nest["/observer/sally"].step(5)
    nest["/"].run_all({"sally": ROAM, "anne": ROAM})
    nest["/observer/sally"].switch("other")
    nest["/observer/sally"].run("sally", ROAM)
    nest["/observer/sally"].switch("plan")
    nest["/observer/sally"].run("sally", ROAM)


def test_dropped_items_are_the_same_on_both_sides_of_a_switch():
    """A visit to another branch leaves items and their numbers as they were, in the body too."""
    toss = "await bot.toss(mcData.itemsByName.diamond.id, null, 1); await bot.waitForTicks(30)"
    with bn.Nest.open(bn.Scenario.load("sally-anne", 3), seed=SEED) as nest:
        world = nest["/"]
        world.edit(containers={(-2, -51, -4): {"diamond": 3}})
        world.switch("dropping")
        result = world.run(
            "anne", f"await getItemFromChest(bot, new Vec3(-2, -51, -4), {{diamond: 2}}); {toss}"
        )
        assert result.ok, result.error
        lying = dict(world.state.items)
        assert len(lying) == 1
        for branch, items in (("main", {}), ("dropping", lying)):
            world.switch(branch)
            assert world.state.items == items
            assert nest._engine.body(()).snapshot().items == items


def frames(store):
    with Journal.read(store) as journal:
        return {
            info.key: (info.head, list(journal.entries(info.key, 0, info.entries)))
            for info in journal.timelines()
        }


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """All frames of a run that was never stopped."""
    store = tmp_path_factory.mktemp("whole") / "run.bn"
    with bn.Nest.open(bn.Scenario.load("sally-anne", 3), store=store, seed=SEED) as nest:
        first_half(nest)
        second_half(nest)
    return frames(store)


def test_frames_after_a_resume(recorded, tmp_path):
    store = tmp_path / "run.bn"
    with bn.Nest.open(bn.Scenario.load("sally-anne", 3), store=store, seed=SEED) as nest:
        first_half(nest)
    with bn.Nest.resume(store) as nest:
        second_half(nest)
    found = frames(store)
    assert found.keys() == recorded.keys()
    assert len(found[TimelineKey((), "main")][1]) > 100
    for key, (head, entries) in recorded.items():
        assert first_difference(entries, found[key][1]) is None
        assert found[key][0] == head


def test_a_script_goes_on_where_it_was_stopped(recorded, tmp_path):
    store = tmp_path / "run.bn"
    stopped = []

    class StopError(Exception):
        """Ends the script half-way."""

    def on_progress(_what, done, total):
        stopped.append(done)
        if done == total // 2:
            raise StopError

    with bn.Nest.open(bn.Scenario.load("sally-anne", 3), store=store, seed=SEED) as nest:
        with pytest.raises(StopError):
            nest.play(on_progress)
        assert nest.tick > 0
    with bn.Nest.resume(store) as nest:
        nest.play(lambda _what, done, _total: stopped.append(done))
        nest["/observer/sally"].switch("plan")
        nest["/observer/sally"].run("sally", ROAM)
        second_half(nest)
    assert stopped == [0, 1, 1, 2, 3]
    assert frames(store) == recorded
