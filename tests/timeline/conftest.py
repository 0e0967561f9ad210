"""Journals under test, and histories to put into them."""

import math
import random

import pytest

from beliefnest.timeline.journal import Edit, TimelineKey
from beliefnest.timeline.store import Journal
from beliefnest.world.frames import Frame
from beliefnest.world.values import AgentState, DroppedItem, Event, EventKind

MAIN = TimelineKey((), "main")


def history(ticks, seed=0):
    """Entries of ticks 1 to `ticks`: agents that walk, and now and then everything else."""
    chance = random.Random(seed)
    entries = []
    for tick in range(1, ticks + 1):
        turn = tick * 0.1
        agents = {
            name: AgentState((math.sin(turn + n), 1.0, math.cos(turn - n)), yaw=turn, pitch=-0.25)
            for n, name in enumerate(("sally", "anne"))
        }
        if chance.random() < 0.2:
            place = (chance.randrange(-9, 9), -51, chance.randrange(-9, 9))
            entries.append(
                Frame(
                    tick,
                    {**agents, "observer": None},
                    {place: chance.randrange(-1, 2000)},
                    {place: {"diamond": 1 + chance.randrange(3)}, (0, 0, 0): None},
                    {tick: DroppedItem("bread", 2, (0.5, 1.25, -3.0)), tick - 1: None},
                    (
                        Event(EventKind.CHAT, "sally", {"text": "hé"}),
                        Event(EventKind.OPEN_CONTAINER, "anne", {"position": place}),
                    ),
                )
            )
        else:
            entries.append(Frame(tick, agents))
        if chance.random() < 0.05:
            entries.append(Edit(tick, ("sally", "anne"), {(1, 2, 3): -1}, {(4, 5, 6): {"egg": 2}}))
    return entries


@pytest.fixture
def make_history():
    return history


@pytest.fixture
def run_file(tmp_path):
    """Write a run file with 300 ticks on one branch, and close it."""
    path = tmp_path / "run.bn"
    with Journal.create_file(path) as journal:
        journal.create(MAIN, None, 0)
        journal.append(MAIN, history(300), 300)
    return path


@pytest.fixture(params=["memory", "sqlite"])
def journal(request, tmp_path):
    made = Journal() if request.param == "memory" else Journal.create_file(tmp_path / "run.bn")
    yield made
    made.close()
