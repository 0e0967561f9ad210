"""Any sequence of calls on nests, stored and in memory, against a plain model of histories."""

import tempfile
from pathlib import Path

from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, rule
from tests.nest.comparing import everything
from tests.nest.face.acting_nest import BOX, CHEST, OFTEN, PATHS, nest_in
from tests.nest.face.linear import LinearModel

import beliefnest as bn
from beliefnest.errors import BeliefNestError, BranchError, TickError, WorldError

PATH = st.sampled_from(PATHS)
NAME = st.sampled_from(["main", "one", "two", 'wie\'s "ä" %; --', "follow"])
NO_NAME = st.sampled_from(["", "a/b", "[x]", "line\nend", "\0"])
AGENT = st.sampled_from(["ann", "bob"])
PLACE = st.tuples(*(st.integers(low, high) for low, high in zip(*BOX, strict=True)))


class NestMachine(RuleBasedStateMachine):
    """Calls on a stored nest, one in memory, and the model, which have to agree."""

    def __init__(self):
        super().__init__()
        self.folder = tempfile.TemporaryDirectory()
        self.store = Path(self.folder.name) / "run.bn"
        with OFTEN:
            self.nests = [nest_in(self.store)]
        self.nests.append(nest_in(None))
        self.model = LinearModel(lambda: nest_in(None))

    def teardown(self):
        try:
            self.compare_all()
        finally:
            for nest in self.nests:
                nest.close()
            self.folder.cleanup()

    def attempt(self, refusal, call):
        """Make a call on all nests: each does it if `refusal` is None, else raises that."""
        told = []
        for nest in self.nests:
            try:
                call(nest)
                told.append(None)
            except BeliefNestError as error:
                told.append(error)
        assert [None if error is None else type(error) for error in told] == [refusal] * len(told)
        assert len({str(error) for error in told}) == 1

    def act(self, path, act):
        """Do something in a simulator's world; the model says whether that can be done."""
        branch = self.model.selected.get(path)
        if branch is None:
            self.attempt(BranchError, act)
            return
        refusal = None
        with self.model.nest(branch) as linear:
            before = linear[path].tick
            try:
                act(linear)
            except WorldError:
                refusal = WorldError
            assert linear[path].tick == before + (refusal is None)
        self.attempt(refusal, act)
        if refusal is None:
            branch.head += 1
            branch.acts.append((branch.head, act))

    # --- branches

    @rule(path=PATH, name=NAME)
    def switch(self, path, name):
        refusal = None if self.model.may_switch(path, name, None) else BranchError
        self.attempt(refusal, lambda nest: nest[path].switch(name))
        if refusal is None:
            self.model.switch(path, name, None)

    @rule(path=PATH, name=NAME, back=st.integers(-1, 8))
    def switch_at(self, path, name, back):
        at = self.model.controller(path).head - back
        refusal = None
        if not self.model.may_switch(path, name, at):
            taken = name == "follow" or self.model.find(path, name) is not None
            refusal = BranchError if taken else TickError
        self.attempt(refusal, lambda nest: nest[path].switch(name, at=at))
        if refusal is None:
            self.model.switch(path, name, at)

    @rule(path=PATH, name=NO_NAME, renamed=st.booleans())
    def misname(self, path, name, renamed):
        if renamed:
            self.attempt(BranchError, lambda nest: nest[path].rename("main", name))
        else:
            self.attempt(BranchError, lambda nest: nest[path].switch(name))

    @rule(path=PATH, name=NAME, recursive=st.booleans())
    def delete(self, path, name, recursive):
        branch = self.model.find(path, name)
        possible = branch is not None and self.model.may_delete(branch, recursive)
        refusal = None if possible else BranchError
        self.attempt(refusal, lambda nest: nest[path].delete(name, recursive))
        if possible:
            self.model.delete(branch)

    @rule(path=PATH, old=NAME, new=NAME)
    def rename(self, path, old, new):
        branch = self.model.find(path, old)
        possible = branch is not None and new != "follow" and self.model.find(path, new) is None
        refusal = None if possible else BranchError
        self.attempt(refusal, lambda nest: nest[path].rename(old, new))
        if possible:
            branch.name = new

    @rule(path=PATH, name=NAME, text=st.text(max_size=5))
    def describe(self, path, name, text):
        branch = self.model.find(path, name)
        refusal = BranchError if branch is None else None
        self.attempt(refusal, lambda nest: nest[path].describe(name, text))
        if branch is not None:
            branch.description = text

    # --- acts

    @rule(path=PATH, agent=AGENT, place=PLACE)
    def walk(self, path, agent, place):
        x, y, z = place
        feet = (x + 0.5, float(y), z + 0.5)
        self.act(path, lambda nest: nest[path].scripted.place_agent(agent, feet))

    @rule(path=PATH, place=PLACE, block=st.sampled_from(["stone", "glass", "chest", "air"]))
    def build(self, path, place, block):
        self.act(path, lambda nest: nest[path].scripted.set_block(place, block))

    @rule(path=PATH, agent=AGENT, taken=st.booleans())
    def move_items(self, path, agent, taken):
        def move(nest):
            world = nest[path].scripted
            (world.withdraw if taken else world.deposit)(agent, CHEST, {"bread": 1})

        self.act(path, move)

    @rule(path=PATH, giver=AGENT, receiver=AGENT)
    def give(self, path, giver, receiver):
        self.act(path, lambda nest: nest[path].scripted.give(giver, receiver, {"bread": 1}))

    @rule(path=PATH, agent=AGENT, text=st.sampled_from(["hello", "é"]))
    def say(self, path, agent, text):
        self.act(path, lambda nest: nest[path].scripted.say(agent, text))

    @rule(path=PATH, ticks=st.integers(1, 3))
    def wait(self, path, ticks):
        for _ in range(ticks):
            self.act(path, lambda nest: nest[path].step(1))

    @rule(path=PATH, place=PLACE, block=st.sampled_from(["stone", None]), count=st.integers(0, 3))
    def edit(self, path, place, block, count):
        contents = {CHEST: {"bread": count}} if count else {}

        def edit(nest):
            nest[path].edit({place: block}, contents)

        self.attempt(None, edit)
        branch = self.model.controller(path)
        branch.acts.append((branch.head, edit))

    # --- reading

    @rule()
    def resume(self):
        self.nests[0].close()
        with OFTEN:
            self.nests[0] = bn.Nest.resume(self.store)

    @invariant()
    def the_same_branches(self):
        for nest in self.nests:
            for path in PATHS:
                simulator, branch = nest[path], self.model.selected.get(path)
                assert simulator.branch == ("follow" if branch is None else branch.name)
                assert simulator.tick == self.model.controller(path).head
                assert [told(info) for info in simulator.branches()] == self.model.of(path)

    @rule()
    def compare_all(self):
        for path in PATHS:
            with self.model.nest(self.model.controller(path)) as linear:
                expected = everything(linear[path].state)
            for nest in self.nests:
                assert everything(nest[path].state) == expected

    @rule(path=PATH, back=st.integers(0, 8))
    def compare_the_past(self, path, back):
        tick = self.model.controller("/").head - back
        branch = self.model.controller(path)
        if not 0 <= tick <= branch.head:
            return
        place, acts, _ = self.model.place_of(branch, tick)
        with self.model.nest(place, acts) as linear:
            expected = everything(linear[path].state)
        for nest in self.nests:
            assert everything(nest.at(tick)[path].state) == expected


def told(info):
    base = info.base
    point = None if base is None else (base.timeline.path, base.timeline.branch, base.tick)
    if point is not None:
        point = ("/" + "/".join(point[0]), *point[1:])
    return info.key.branch, point, info.start, info.head, info.description


TestNestMachine = NestMachine.TestCase
TestNestMachine.settings = settings(stateful_step_count=20)
