"""A simulator whose body is made anew goes on as if it had never stopped, whatever was under way.

Two runs of the same random calls: one is left alone; in the other the body is taken away between
the calls, by a resume or a visit to another branch. Every frame must be the same, and so must be
those of a replay of all of it.
"""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

import beliefnest as bn
from beliefnest.nest.acting.replay import replay
from beliefnest.nest.past.setting import Setting
from beliefnest.timeline.compare import first_difference
from beliefnest.timeline.journal import TimelineKey
from beliefnest.timeline.store import Journal
from beliefnest.world.frames import Snapshot
from beliefnest.world.registry import Registry
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import AgentState, Box
from beliefnest.worlds.by_name import Worlds

BOX = Box((0, 0, 0), (13, 8, 13))
CHEST, FURNACE, TABLE, BARREL = (3, 1, 3), (6, 1, 3), (9, 1, 3), (3, 1, 9)
BUTTON, SAND, HOLD, BED = (6, 1, 9), (10, 3, 10), (10, 2, 10), (11, 1, 6)
PLAIN = {
    CHEST: "chest[facing=south]",
    FURNACE: "furnace[facing=south]",
    TABLE: "crafting_table",
    BARREL: "barrel[facing=up]",
    BUTTON: "stone_button[face=floor]",
    (6, 1, 10): "oak_door[half=lower]",
    (6, 2, 10): "oak_door[half=upper]",
    SAND: "sand",
    (10, 4, 10): "sand",
    HOLD: "dirt",
    (10, 1, 10): "dirt",
    BED: "red_bed[part=foot,facing=north]",
    (11, 1, 5): "red_bed[part=head,facing=north]",
    (1, 1, 12): "stone",
    (2, 1, 12): "stone",
    (2, 2, 12): "stone",
}
INVENTORY = {"dirt": 70, "diamond": 2, "oak_log": 3, "raw_iron": 3, "coal": 2, "bread": 2}
FULL = INVENTORY | dict.fromkeys(("apple", "arrow", "bone", "book", "bow", "bowl", "clay"), 3)
"""More than the nine slots at hand."""

EDITS = (
    ({HOLD: "air"}, {}),
    ({(10, 5, 10): "sand"}, {}),
    ({(6, 1, 10): "air"}, {}),
    ({BUTTON: "air"}, {}),
    ({FURNACE: "stone"}, {}),
    ({FURNACE: "furnace[facing=south]"}, {FURNACE: {"coal": 1, "raw_iron": 2}}),
    ({}, {CHEST: {"dirt": 3, "diamond": 1}}),
)

WALK = "bot.setControlState('forward', true)"
ACTS = (Path(__file__).parent / "acts.js").read_text().split("// --\n")[1:]
"""Programs, in which NUMBER stands for one; many leave something under way."""


def program(act: str, number: int) -> str:
    return act.replace("NUMBER", str(number))


calls = st.one_of(
    st.tuples(st.just("step"), st.integers(1, 60)),
    st.tuples(
        st.dictionaries(
            st.sampled_from(["anne", "sally"]),
            st.builds(program, st.sampled_from(ACTS), st.integers(1, 30)),
            min_size=1,
        ),
        st.sampled_from([1, 2, 3, 5, 8, 13, 40, 200]),
    ),
)
pauses = st.sampled_from(["none", "resume", "away", "past", *EDITS])


def start() -> Setting:
    registry = Registry.load()
    blocks = np.zeros(BOX.shape, dtype=np.int32)
    blocks[:, 0, :] = registry.state_id("dirt")
    for place, text in PLAIN.items():
        blocks[BOX.index(place)] = registry.state_id(text)
    agents = {
        "sally": AgentState((4.5, 1.0, 5.5), inventory=INVENTORY, food=10),
        "anne": AgentState((8.5, 1.0, 7.5), yaw=1.0, inventory=FULL, food=10),
    }
    contents = {CHEST: {"emerald": 3, "dirt": 5}, FURNACE: {}, BARREL: {}}
    return Setting("place", Snapshot(0, BOX, Terrain.of(blocks), contents, agents), bn.Perception())


@pytest.fixture(scope="module")
def lent() -> Iterator[tuple[Worlds, Worlds]]:
    with Worlds(1) as one, Worlds(1) as other:
        yield one, other


def act(nest: bn.Nest, call: tuple[object, int]) -> object:
    what, ticks = call
    if what == "step":
        return nest["/"].step(ticks)
    return {
        agent: (result.ok, str(result.error), result.ticks, result.events)
        for agent, result in nest["/"].run_all(what, ticks).items()
    }


def visit(nest: bn.Nest, number: int, at: int | None) -> None:
    """Do something on another branch, and come back."""
    world = nest["/"]
    before = world.branch
    world.switch(f"away {number}", at)
    world.run_all({"sally": WALK + "; await bot.waitForTicks(7)"}, 20)
    world.step(3)
    world.switch(before)


def entries(nest: bn.Nest) -> list[object]:
    journal = nest._recording.journal
    key = TimelineKey((), "main")
    return list(journal.entries(key, 0, journal.info(key).entries))


# Not made smaller: that takes minutes, and a script of a few calls can be read.
@settings(phases=[Phase.explicit, Phase.reuse, Phase.generate])
@given(script=st.lists(st.tuples(calls, pauses), min_size=2, max_size=5))
def test_a_body_made_anew_goes_on_as_before(lent, tmp_path_factory, script):
    one, other = lent
    store = tmp_path_factory.mktemp("run") / "run.bn"
    left_alone = bn.Nest.open(start(), worlds=one, seed=5)
    disturbed = bn.Nest.open(start(), worlds=other, seed=5, store=store)
    try:
        for number, (call, pause) in enumerate(script):
            told = act(left_alone, call)
            assert act(disturbed, call) == told
            if pause == "resume" or pause in EDITS:
                disturbed.close()
                disturbed = bn.Nest.resume(store, worlds=other)
            if pause in EDITS:
                for nest in (left_alone, disturbed):
                    nest["/"].edit(*pause)
            elif pause in ("away", "past"):
                visit(disturbed, number, disturbed.tick // 2 if pause == "past" else None)
            assert first_difference(entries(left_alone), entries(disturbed)) is None
            assert disturbed.tick == left_alone.tick
    finally:
        disturbed.close()
        left_alone.close()
    with Journal.read(store) as journal:
        programs = journal.records.programs()
        lent_once = other.lend("embedded")
        for replayed in replay(start(), journal, programs, lent_once, 5):
            assert replayed.difference is None
        lent_once.close()
