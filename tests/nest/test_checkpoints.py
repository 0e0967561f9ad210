"""A nest with checkpoints at random places holds what one without any holds."""

import tempfile
from pathlib import Path
from unittest.mock import patch

from hypothesis import given
from hypothesis import strategies as st
from tests.nest.comparing import everything, values
from tests.nest.reference import paths_to
from tests.nest.stories import CONTAINERS, NAMES, Stage, Stories

import beliefnest as bn
from beliefnest.nest.checkpoints import Pace

PATHS = ["/" + "/".join(path) for path in paths_to(NAMES, 2)]
PACES = st.builds(Pace, every=st.integers(1, 4), lag=st.integers(0, 2), stretch=st.integers(1, 4))
PATH = st.sampled_from(PATHS)
PLACES = [*CONTAINERS, (3, 0, 3), (0, 1, 4)]
WHENS = st.one_of(
    st.none(),
    st.none(),
    st.just("resume"),
    st.tuples(st.just("ask"), PATH),
    st.tuples(st.just("look back"), PATH, st.integers(0, 20)),
)
"""What is done with one of the two nests between two acts."""


class Twins:
    """A story in two nests: one in memory, one in a file, with checkpoints and resumed."""

    def __init__(self, story, folder, pace):
        self.plain = Stage(story)
        self.pace = patch("beliefnest.nest.history.Pace", lambda: pace)
        self.file = Path(folder) / "run.bn"
        with self.pace:
            self.stored = Stage(story, self.file)

    def do(self, when, act):
        if when == "resume":
            self.resume()
        elif when is not None:
            self.ask(*when)
        assert self.plain.do(act) == self.stored.do(act)

    def resume(self):
        self.stored.nest.close()
        with self.pace:
            self.stored.nest = bn.Nest.resume(self.file)
        self.stored.world = self.stored.nest.scripted_world

    def ask(self, how, path, tick=None):
        simulator = self.stored.nest[path]
        if how == "look back":
            tick = min(self.plain.start + tick, simulator.tick)
            simulator = self.stored.nest.at(tick)[path]
        assert simulator.state.agents

    def compare(self):
        for path in PATHS:
            one, other = self.plain.nest[path], self.stored.nest[path]
            assert shown(other.state) == shown(one.state), path
            for element in elements():
                assert str(other.explain(**element)) == str(one.explain(**element))

    def compare_past(self, paths):
        for path in paths:
            last = min(self.plain.nest[path].tick, self.plain.nest["/"].tick)
            for tick in range(self.plain.start, last + 1):
                one = self.plain.nest.at(tick)[path]
                other = self.stored.nest.at(tick)[path]
                assert shown(other.state) == shown(one.state), (path, tick)

    def close(self):
        self.plain.nest.close()
        self.stored.nest.close()


def shown(state):
    """What a state shows, but for what blocks rest on, which is no matter of checkpoints."""
    blocks = state.blocks
    return {
        **values(state),
        "containers": dict(state.containers),
        "agents": dict(state.agents),
        "items": dict(state.items),
        "current": [blocks.current(place) for place in PLACES],
    }


def elements():
    return [{"container": CONTAINERS[0]}, {"agent": NAMES[0]}, {"block": (3, 0, 3)}]


@given(st.data())
def test_checkpoints_change_no_answer(data):
    story = data.draw(Stories(forks=data.draw(st.booleans()), max_acts=12).story)
    with tempfile.TemporaryDirectory() as folder:
        twins = Twins(story, folder, data.draw(PACES))
        try:
            for act in story.acts:
                twins.do(data.draw(WHENS), act)
            twins.compare()
            twins.compare_past(data.draw(st.lists(PATH, min_size=1, max_size=2)))
            twins.resume()
            twins.compare_past(["/", "/ann"])
            twins.compare()
            path = data.draw(PATH)
            one, other = twins.plain.nest[path], twins.stored.nest[path]
            assert everything(other.state) == everything(one.state)
        finally:
            twins.close()
