"""Any sequence of calls leaves a run file as it leaves a plain model."""

import tempfile
from pathlib import Path

from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import Bundle, RuleBasedStateMachine, invariant, rule
from tests.profiles import at_night

from beliefnest.errors import BranchError, TickError
from beliefnest.timeline.journal import Edit, EntryFilter, ForkPoint, TimelineInfo, TimelineKey
from beliefnest.timeline.store import Journal
from beliefnest.world.frames import Frame
from beliefnest.world.values import AgentState

NAMES = st.sampled_from(["a", "b", "plan 1", "ü"])
PATHS = st.sampled_from([(), ("sally",), ("sally", "anne")])


class Model:
    """Timelines as a dictionary of plain values, in order of creation."""

    def __init__(self):
        self.rows = []

    def add(self, key, base, start):
        row = {"key": key, "base": base, "start": start, "head": start}
        self.rows.append({**row, "entries": [], "description": ""})

    def find(self, key):
        return next((row for row in self.rows if row["key"] == key), None)

    def infos(self):
        return [
            TimelineInfo(
                row["key"],
                row["base"] and ForkPoint(row["base"][0]["key"], *row["base"][1:]),
                row["start"],
                row["head"],
                len(row["entries"]),
                row["description"],
            )
            for row in self.rows
        ]


class StoreMachine(RuleBasedStateMachine):
    """Calls on a run file and on the model, which have to agree."""

    keys = Bundle("keys")

    def __init__(self):
        super().__init__()
        self.folder = tempfile.TemporaryDirectory()
        self.path = Path(self.folder.name) / "run.bn"
        self.journal = Journal.create_file(self.path)
        self.model = Model()

    def teardown(self):
        self.journal.close()
        self.folder.cleanup()

    def attempt(self, possible, call, *arguments):
        """Make a call that has to be refused unless it is possible; whether it was made."""
        try:
            call(*arguments)
        except BranchError:
            assert not possible
        else:
            assert possible
        return possible

    @rule(target=keys, path=PATHS, name=NAMES, start=st.integers(0, 9))
    def create(self, path, name, start):
        key = TimelineKey(path, name)
        if self.attempt(self.model.find(key) is None, self.journal.create, key, None, start):
            self.model.add(key, None, start)
        return key

    @rule(target=keys, path=PATHS, name=NAMES, below=keys, share=st.floats(0, 1.2))
    def fork(self, path, name, below, share):
        key, base = TimelineKey(path, name), self.model.find(below)
        place = int(share * len(base["entries"])) if base else 0
        tick = base["head"] if base else 0
        possible = self.model.find(key) is None and base is not None
        possible = possible and place <= len(base["entries"])
        point = ForkPoint(below, place, tick)
        if self.attempt(possible, self.journal.create, key, point, tick):
            self.model.add(key, (base, place, tick), tick)
        return key

    @rule(
        key=keys,
        steps=st.lists(st.integers(0, 3), max_size=200) | st.lists(st.just(1), min_size=120),
        quiet=st.integers(-1, 3),
        edited=st.booleans(),
    )
    def append(self, key, steps, quiet, edited):
        row = self.model.find(key)
        tick, entries = row["head"] if row else 0, []
        for number, step in enumerate(steps):
            tick += step
            entries.append(
                Edit(tick, key.path, {(number, 0, 0): step})
                if edited and number % 7 == 0
                else Frame(tick, {"sally": AgentState((tick / 7, 0.0, number / 3))})
            )
        head = tick + quiet
        if row is not None and head < tick:
            try:
                self.journal.append(key, entries, head)
            except TickError:
                return
            raise AssertionError("time ran backwards")
        if self.attempt(row is not None, self.journal.append, key, entries, head):
            row["entries"].extend(entries)
            row["head"] = head

    @rule(target=keys, key=keys, name=NAMES)
    def rename(self, key, name):
        row, new = self.model.find(key), TimelineKey(key.path, name)
        possible = row is not None and self.model.find(new) is None
        if self.attempt(possible, self.journal.rename, key, name):
            row["key"] = new
        return new

    @rule(key=keys)
    def delete(self, key):
        row = self.model.find(key)
        carries = any(other["base"] and other["base"][0] is row for other in self.model.rows)
        if self.attempt(row is not None and not carries, self.journal.delete, key):
            self.model.rows.remove(row)

    @rule(key=keys, text=st.text(max_size=10).filter(str.isprintable))
    def describe(self, key, text):
        row = self.model.find(key)
        if self.attempt(row is not None, self.journal.describe, key, text):
            row["description"] = text

    @rule()
    def reopen(self):
        self.journal.close()
        self.journal = Journal.open(self.path)

    @rule(key=keys, start=st.integers(0, 400), length=st.integers(0, 300))
    def read_range(self, key, start, length):
        row = self.model.find(key)
        if row is not None:
            found = list(self.journal.entries(key, start, start + length))
            assert found == row["entries"][start : start + length]

    @rule(key=keys, tick=st.integers(-1, 400))
    def count(self, key, tick):
        row = self.model.find(key)
        if row is not None:
            until = sum(entry.tick <= tick for entry in row["entries"])
            assert self.journal.entries_until(key, tick) == until

    @rule(key=keys, start=st.integers(0, 400), length=st.integers(0, 300))
    def look_for(self, key, start, length):
        row = self.model.find(key)
        if row is not None:
            stop = start + length
            edits = [(n, e) for n, e in enumerate(row["entries"]) if isinstance(e, Edit)]
            found = list(self.journal.filtered(key, start, stop, EntryFilter.CHANGES))
            assert found == [(n, e) for n, e in edits if start <= n < stop]
            frames = [e for e in row["entries"][:stop] if isinstance(e, Frame)]
            last = frames[-1].agents if frames else {}
            assert self.journal.agents_after(key, min(stop, len(row["entries"]))) == last

    @invariant()
    def timelines_agree(self):
        assert list(self.journal.timelines()) == self.model.infos()
        for row in self.model.rows:
            assert list(self.journal.entries(row["key"], 0, 10**9)) == row["entries"]

    @invariant()
    def a_reader_sees_the_same(self):
        with Journal.read(self.path) as reader:
            assert list(reader.timelines()) == self.model.infos()


TestStore = StoreMachine.TestCase
TestStore.settings = settings(max_examples=at_night(2000, 30), stateful_step_count=25)
