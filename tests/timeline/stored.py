"""What tests put into run files."""

from dataclasses import replace

import numpy as np

from beliefnest.timeline.journal import TimelineKey
from beliefnest.timeline.records import ProgramRecord, PromptRecord, RunRecord
from beliefnest.world.frames import Snapshot
from beliefnest.world.values import AgentState, Box

MAIN = TimelineKey((), "main")
PLAN = TimelineKey(("sally",), "plan")
RUN = RunRecord("sally-anne", "box: …\n", "3", 7, {"minecraft": "1.20.4"}, b"\0setting")
PROGRAM = ProgramRecord(("sally",), "plan", "sally", "await x()", 12, False, "line 1: no x", 3)
LONG = replace(
    PROGRAM, ok=True, error=None, lines=(1, 3), log=("a", "é"), unfinished=("waitTicks of line 3",)
)
PROMPT = PromptRecord(
    ("sally", "anne"),
    PLAN,
    12,
    "offline",
    1,
    (("system", "You are …"), ("user", "Get a diamond.")),
    {"temperature": 0.5, "seed": None},
    "await x()",
    None,
)


def kept(journal):
    return [
        (info, list(journal.entries(info.key, 0, info.entries))) for info in journal.timelines()
    ]


def snapshot(tick):
    grid = np.arange(24, dtype=np.int32).reshape(2, 3, 4) + tick
    sally = AgentState((0.1, 1.0, 2.0))
    return Snapshot(
        tick, Box((0, 0, 0), (1, 2, 3)), grid, {(0, 0, 0): {"egg": 1}}, {"sally": sally}
    )
