"""Any sequence of calls on a nest with a store, resumed at any time, against one in memory."""

import tempfile
from pathlib import Path

from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, rule
from tests.nest.acting_nest import BOX, CHEST, PATHS, nest_in
from tests.nest.comparing import everything

import beliefnest as bn
from beliefnest.errors import BeliefNestError

PATH = st.sampled_from(PATHS)
NAME = st.sampled_from(["main", "one", "two", "follow"])
PLACE = st.tuples(*(st.integers(low, high) for low, high in zip(*BOX, strict=True)))


class NestMachine(RuleBasedStateMachine):
    """Calls on two nests that have to agree, refusals included."""

    def __init__(self):
        super().__init__()
        self.folder = tempfile.TemporaryDirectory()
        self.store = Path(self.folder.name) / "run.bn"
        self.stored = nest_in(self.store)
        self.plain = nest_in(None)

    def teardown(self):
        self.stored.close()
        self.plain.close()
        self.folder.cleanup()

    def both(self, call):
        """Make a call on both nests; it does the same in both, or is refused by both."""
        told = []
        for nest in (self.stored, self.plain):
            try:
                call(nest)
                told.append(None)
            except BeliefNestError as refusal:
                told.append((type(refusal), str(refusal)))
        assert told[0] == told[1]

    @rule(path=PATH, name=NAME)
    def switch(self, path, name):
        self.both(lambda nest: nest[path].switch(name))

    @rule(path=PATH, name=NAME, back=st.integers(-1, 6))
    def fork_from_the_past(self, path, name, back):
        self.both(lambda nest: nest[path].switch(name, at=nest[path].tick - back))

    @rule(path=PATH, agent=st.sampled_from(["ann", "bob"]), place=PLACE)
    def walk(self, path, agent, place):
        x, y, z = place
        feet = (x + 0.5, float(y), z + 0.5)
        self.both(lambda nest: nest[path].scripted.place_agent(agent, feet))

    @rule(path=PATH, place=PLACE, block=st.sampled_from(["stone", "glass", "chest", "air"]))
    def build(self, path, place, block):
        self.both(lambda nest: nest[path].scripted.set_block(place, block))

    @rule(path=PATH, agent=st.sampled_from(["ann", "bob"]))
    def take(self, path, agent):
        self.both(lambda nest: nest[path].scripted.withdraw(agent, CHEST, {"bread": 1}))

    @rule(path=PATH, ticks=st.integers(0, 3))
    def wait(self, path, ticks):
        self.both(lambda nest: nest[path].step(ticks))

    @rule(path=PATH, place=PLACE, block=st.sampled_from(["stone", None]), count=st.integers(0, 3))
    def edit(self, path, place, block, count):
        contents = {CHEST: {"bread": count}} if count else {}
        self.both(lambda nest: nest[path].edit({place: block}, contents))

    @rule(path=PATH, name=NAME, recursive=st.booleans())
    def delete(self, path, name, recursive):
        self.both(lambda nest: nest[path].delete(name, recursive))

    @rule(path=PATH, old=NAME, new=NAME)
    def rename(self, path, old, new):
        self.both(lambda nest: nest[path].rename(old, new))

    @rule(path=PATH, name=NAME, text=st.text(max_size=5))
    def describe(self, path, name, text):
        self.both(lambda nest: nest[path].describe(name, text))

    @rule()
    def resume(self):
        self.stored.close()
        self.stored = bn.Nest.resume(self.store)

    @invariant()
    def the_same_branches(self):
        for path in PATHS:
            one, other = self.stored[path], self.plain[path]
            assert (one.branch, one.tick) == (other.branch, other.tick)
            assert one.branches() == other.branches()

    @rule()
    def compare_all(self):
        for path in PATHS:
            assert everything(self.stored[path].state) == everything(self.plain[path].state)


TestNestMachine = NestMachine.TestCase
TestNestMachine.settings = settings(stateful_step_count=20)
