"""Explanations in words, and their agreement with states."""

from hypothesis import given
from tests.semantics.stories import CONTAINERS, NAMES, Stage, Stories, Story

import beliefnest as bn
from beliefnest.nest.explain.parts import View


@given(Stories(max_acts=10).story)
def test_an_explanation_says_what_the_state_says(story: Story) -> None:
    """On random stories: the same values, and a change is missed only where there was one."""
    nest = Stage(story).play().nest
    for path in ((NAMES[0],), NAMES[:2], NAMES[1::-1]):
        simulator = nest["/" + "/".join(path)]
        for place in CONTAINERS:
            told = simulator.explain(container=place)
            held = simulator.state.containers.get(place)
            assert str(told)
            if not told.levels:
                continue
            level = told.levels[-1]
            if held is None:
                assert (level.value, level.basis) == (None, None)
                continue
            assert level.value == bn.Contents(dict(held.items), held.complete)
            assert (level.basis, level.current) == (held.basis, held.current)
            assert level.since is not None
            assert level.since >= level.basis.observed_at
            if level.missed is not None:
                assert level.since <= level.missed.tick <= told.tick
                assert level.missed.before != level.missed.after
        for name in NAMES:
            told = simulator.explain(agent=name)
            there = simulator.state.agents[name]
            value = told.levels[-1].value if told.levels else told.fact.value
            assert value == there.position
            if told.levels and told.levels[-1].missed is not None:
                looks = told.levels[-1].missed.sightings
                assert all(look.view is not View.SEEN for look in looks)
            assert str(told)


def test_what_was_handed_on_is_told_with_what_was_seen():
    scenario = bn.Scenario.load("knowledge-access", condition=1)
    with bn.Nest.open(scenario) as nest:
        nest.play()
        told = str(nest["/observer/fiona"].explain(container=(7, 1, 2)))
    assert (
        "perceived at tick 100 what had been seen to happen (observer "
        "looked in, then observer put 1 diamond in) at tick 3."
    ) in told
    assert "deposit_item" not in told


def test_a_deed_and_what_it_does_to_the_block_are_told_as_one() -> None:
    door = (5, 0, 2)
    world = bn.ScriptedWorld(
        ((0, 0, 0), (9, 3, 9)),
        blocks={door: "oak_trapdoor[open=false]"},
        agents={"anne": (4.5, 0, 4.5)},
    )
    nest = bn.Nest(world)
    world.use_door("anne", door, open=True)
    assert str(nest["/"].explain(block=door)).endswith("since tick 1: anne opened it.")
    world.set_block(door, "oak_trapdoor[open=false]")
    told = str(nest["/"].explain(block=door))
    assert "since tick 2: something made it oak_trapdoor[" in told
