"""Places of exhibits, names of agents there; only changes are sent."""

import re
from itertools import pairwise

from hypothesis import given
from hypothesis import strategies as st
from msgspec.structs import replace

from beliefnest.world.terrain import Terrain
from beliefnest.world.values import AgentState, Box
from beliefnest.worlds.minecraft.exhibits import Shown, display_names, origin_of

NAMES = st.from_regex(r"\A[A-Za-z0-9_]{1,16}\Z")
VIEW_BLOCKS = 32 * 16


@given(
    st.sets(NAMES, max_size=8),
    st.lists(st.integers(1, 999), min_size=1, max_size=3, unique=True),
)
def test_names_in_exhibits_are_players_names_and_never_collide(agents, numbers):
    shown = [display_names(agents, number, agents) for number in numbers]
    for names in shown:
        assert names.keys() == agents
        assert all(re.fullmatch(r"\w{1,16}", name) for name in names.values())
        lowered = {name.lower() for name in names.values()}
        assert len(lowered) == len(names)
        assert lowered.isdisjoint(agent.lower() for agent in agents)


def test_a_person_recognises_the_names():
    agents = ["sally", "participant_0001", "participant_0002", "Sally", "sally_2"]
    assert display_names(agents, 2, agents) == {
        "Sally": "Sally_2_1",
        "sally": "sally_2_2",
        "sally_2": "sally_2_2_1",
        "participant_0001": "particint_0001_2",
        "participant_0002": "particint_0002_2",
    }


@given(
    st.tuples(st.integers(-300, 300), st.integers(-300, 300)).map(sorted),
    st.sampled_from([0, 29_000_000 - 29_000_000 % 16, -28_999_984]),
)
def test_exhibits_stand_out_of_sight_of_each_other_and_inside_the_world(ends, at):
    box = Box((ends[0], 0, 0), (ends[1], 3, 3))
    places = [origin_of(number, box, (at, 0))[0] for number in range(6)]
    assert all(place % 16 == 0 for place in places)
    for one, other in pairwise(places):
        assert abs(other - one) - (ends[1] - ends[0]) > 2 * VIEW_BLOCKS
    assert all(abs(place) + 300 < 29_999_984 for place in places)


def test_only_what_differs_is_told():
    agent = AgentState((0.5, 1, 0.5))
    chest = (0, 1, 0)
    before = Shown(Terrain.full((2, 2, 2), 0), {chest: ({}, False)}, {}, {"sally_1": agent})
    blocks = before.blocks.draft()
    blocks[1, 0, 1] = 7
    after = Shown(blocks.terrain(), {chest: ({"diamond": 1}, False)}, {}, {"sally_1": agent})
    assert before.changes(before, (0, 0, 0)) is None
    told = after.changes(before, (-5, 0, 3))
    assert told == {
        "blocks": [[-4, 0, 4, 7]],
        "containers": [[0, 1, 0, {"diamond": 1}, False]],
        "signs": [],
        "agents": {},
    }
    moved = replace(after, agents={"anne_1": replace(agent, yaw=1.0)}, containers={})
    told = moved.changes(after, (-5, 0, 3))
    assert told["containers"] == [[0, 1, 0, None, False]]
    assert told["agents"]["sally_1"] is None
    assert told["agents"]["anne_1"]["yaw"] == 1.0
