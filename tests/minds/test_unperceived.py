"""Nothing that an observer could not perceive changes what is inferred, foretold or drawn."""

import random

import pytest

import beliefnest as bn


def rooms(unseen_at):
    """Let Anne lose sight of Bob for 29 ticks, while Carl acts behind a full wall at some ticks.

    Bob goes behind a screen along z = 0 to 3, and comes out again at its other end.
    """
    blocks = {(x, 0, z): "stone" for x in range(12) for z in range(5)}
    blocks |= {(8, y, z): "bricks" for y in range(4) for z in range(5)}
    blocks |= {(x, y, 2): "bricks" for x in range(1, 6) for y in (1, 2, 3)}
    world = bn.ScriptedWorld(
        box=((0, 0, 0), (11, 3, 4)),
        blocks=blocks,
        agents={"anne": (5.5, 1, 4.5), "bob": (0.5, 1, 3.5), "carl": (10.5, 1, 2.5)},
    )
    nest = bn.Nest(world, static_blocks=["stone", "bricks", "air"])
    chance = random.Random(len(unseen_at))
    feet = {0: (0.5, 1, 2.5), 1: (0.5, 1, 1.5), 2: (1.5, 1, 0.5), 29: (6.5, 1, 1.5)}
    for tick in range(36):
        with world.tick():
            if tick in feet:
                world.place_agent("bob", feet[tick])
            if tick in unseen_at:
                x, z = chance.choice([(9, 1), (10, 3), (11, 2)])
                world.place_agent("carl", (x + 0.5, 1, z + 0.5))
                world.set_block((11, 1, 4), chance.choice(["dirt", "sand", "chest"]))
    return nest


@pytest.mark.parametrize("step_ticks", [1, 3])
def test_courses_do_not_depend_on_what_nobody_perceived(step_ticks):
    model = bn.MindModel(
        "bob",
        goals={"near": {"at": (6, 1, 2)}, "far": {"at": (7, 1, 4)}},
        utilities={"near": [10, 50], "far": [10, 50]},
        rationality=0.5,
        stay_cost=1,
        step_ticks=step_ticks,
    )
    shown = []
    for unseen_at in ((), (4,), (1, 3, 6, 7, 10, 15, 31), tuple(range(36))):
        with rooms(unseen_at) as nest:
            inferred = nest["/anne"].infer(model, smooth=True)
            assert inferred.impossible is None
            paths = inferred.sample_paths(20, seed=3)
            assert len({repr(path.cells) for path in paths}) > 5
            imagined = nest["/anne"].imagine(
                5,
                until=12,
                actors={"bob": {"walks": model}},
                evidence=[{"agent": "bob", "at": (6, 1, 1), "mistaken": 0.3}],
                n=6,
            )
            walks = [[h.at(tick).state.agents["bob"] for tick in range(5, 13)] for h in imagined]
            shown.append(
                repr(
                    (
                        paths,
                        inferred.predict(4),
                        inferred.predict(2, tick=9),
                        inferred.at(9).sample_paths(5, seed=1),
                        inferred.explain(),
                        [inferred.marginal("cell", tick) for tick in range(inferred.since, 36)],
                        inferred.posterior().tobytes(),
                        walks,
                    )
                )
            )
    assert len(set(shown)) == 1


def test_a_drawn_course_has_a_cell_at_every_tick():
    model = bn.MindModel(
        "bob", goals={"near": {"at": (6, 1, 2)}}, utilities={"near": 50}, step_ticks=3
    )
    with rooms((4, 5)) as nest:
        for path in nest["/anne"].infer(model).sample_paths(5):
            assert list(path.cells) == list(range(min(path.cells), max(path.cells) + 1))
            assert path.cells[0] == (0, 1, 3)
            assert path.cells[30] == (6, 1, 1)
