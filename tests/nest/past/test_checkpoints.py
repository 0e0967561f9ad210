"""A nest with checkpoints at random places holds what one without any holds."""

import sqlite3
import tempfile
from contextlib import closing, contextmanager
from pathlib import Path
from types import SimpleNamespace
from unittest.mock import patch

from hypothesis import given
from hypothesis import strategies as st
from tests.nest.comparing import everything, values
from tests.semantics.stories import CONTAINERS, NAMES, Stage, Stories

import beliefnest as bn
from beliefnest.nest.past.checkpoints import Pace
from beliefnest.timeline.store import Journal

PATHS = ["/", "/ann", "/bob", "/ann/bob", "/bob/cat/ann"]
BOX = ((0, 0, 0), (7, 3, 7))
TICKS = 110
PACE_USED = Pace(every=20, lag=5, stretch=16)
PACE = patch("beliefnest.nest.past.history.Pace", lambda: PACE_USED)
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
"""Operations on one of the two nests between two acts."""


class Twins:
    """A story in two nests: one in memory, one in a file, with checkpoints and resumed."""

    def __init__(self, story, folder, pace):
        self.plain = Stage(story)
        self.pace = patch("beliefnest.nest.past.history.Pace", lambda: pace)
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

    def compare(self, explained):
        for path in PATHS:
            one, other = self.plain.nest[path], self.stored.nest[path]
            assert shown(other.state) == shown(one.state), path
        one, other = self.plain.nest[explained], self.stored.nest[explained]
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
    """Return the content of a state without the grounds of its blocks, which vary."""
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
            twins.compare(data.draw(PATH))
            twins.compare_past([data.draw(PATH)])
            twins.resume()
            twins.compare_past(["/"])
            twins.compare(data.draw(PATH))
            path = data.draw(PATH)
            one, other = twins.plain.nest[path], twins.stored.nest[path]
            assert everything(other.state) == everything(one.state)
        finally:
            twins.close()


def walked(store, ticks):
    """Play a run in which ann and bob walk and talk, and /ann/bob is asked for."""
    world = bn.ScriptedWorld(BOX, agents={"ann": (1.5, 0.0, 1.5), "bob": (5.5, 0.0, 5.5)})
    with PACE:
        nest = bn.Nest(world, static_blocks=["air"], store=store)
    assert nest["/ann/bob"].state.agents
    for tick in range(ticks):
        with world.tick():
            world.place_agent("ann", (tick % 7 + 0.5, 0.0, tick % 5 + 0.5))
            if tick % 20 == 0:
                world.say("bob", f"tick {tick}")
    return nest


def resumed(store):
    with PACE:
        return bn.Nest.resume(store)


def kept(store):
    with closing(sqlite3.connect(store)) as connection:
        return connection.execute("SELECT name, entries FROM keyframe ORDER BY id").fetchall()


def test_a_resumed_run_reads_little_of_what_was(tmp_path):
    with walked(tmp_path / "run.bn", TICKS) as nest:
        expected = shown_here(nest)
    with resumed(tmp_path / "run.bn") as nest, counted_entries() as count:
        assert nest["/ann/bob"].state.agents == expected["/ann/bob"]["agents"]
        assert nest["/"].state.agents == expected["/"]["agents"]
        assert count.read <= 2 * PACE_USED.every
        assert shown_here(nest) == expected


def test_a_past_tick_is_reached_by_few_entries(tmp_path):
    walked(tmp_path / "run.bn", TICKS).close()
    with PACE:
        reading = bn.Nest.read(tmp_path / "run.bn")
    with reading, counted_entries() as count:
        for path in ("/", "/ann/bob"):
            before = count.read
            assert reading.at(TICKS - 3 * PACE_USED.every // 2)[path].state.agents
            assert count.read - before <= 2 * PACE_USED.every


def test_without_its_checkpoints_a_run_holds_the_same(tmp_path):
    with walked(tmp_path / "run.bn", TICKS) as nest:
        expected = shown_here(nest)
    assert len(kept(tmp_path / "run.bn")) >= TICKS // PACE_USED.every
    with closing(sqlite3.connect(tmp_path / "run.bn")) as connection, connection:
        connection.execute("DELETE FROM keyframe")
    with resumed(tmp_path / "run.bn") as nest:
        assert shown_here(nest) == expected


def test_checkpoints_of_another_program_are_left_alone(tmp_path):
    with walked(tmp_path / "run.bn", TICKS) as nest:
        expected = shown_here(nest)
    left = kept(tmp_path / "run.bn")
    other = patch("beliefnest.nest.past.checkpoints._program", lambda: b"another")
    with other, counted_entries() as count, resumed(tmp_path / "run.bn") as nest:
        assert shown_here(nest) == expected
        assert count.read >= TICKS
    assert kept(tmp_path / "run.bn")[: len(left)] == left
    assert {name for name, _ in kept(tmp_path / "run.bn")} > {name for name, _ in left}


def test_readers_leave_none(tmp_path):
    nest = walked(tmp_path / "run.bn", TICKS)
    with nest, PACE, bn.Nest.read(tmp_path / "run.bn") as reading:
        left = kept(tmp_path / "run.bn")
        assert reading["/bob/ann"].state.agents
    assert kept(tmp_path / "run.bn")[: len(left)] == left
    with PACE, bn.Nest.read(tmp_path / "run.bn") as reading:
        left = kept(tmp_path / "run.bn")
        assert reading["/bob/ann"].state.agents
        assert kept(tmp_path / "run.bn") == left


def shown_here(nest):
    return {path: shown(nest[path].state) for path in ("/", "/ann", "/ann/bob")}


@contextmanager
def counted_entries():
    """Count entries that are read one after the other."""
    count = SimpleNamespace(read=0)
    read = Journal.entries

    def counting(*args):
        for entry in read(*args):
            count.read += 1
            yield entry

    with patch.object(Journal, "entries", counting):
        yield count
