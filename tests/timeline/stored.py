"""Records that tests put into run files."""

import numpy as np
from msgspec.structs import replace

from beliefnest.errors import StoreError
from beliefnest.timeline.journal import TimelineKey
from beliefnest.timeline.run_records import ProgramRecord, PromptRecord, RunRecord
from beliefnest.world.frames import Snapshot
from beliefnest.world.terrain import Terrain
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


def verify(journal):
    """Read all of a run file; StoreError names the first damage."""
    database, records = journal._database, journal.records
    with journal.unchanging():
        (found,) = database.row("PRAGMA integrity_check(1)")
        if found != "ok":
            raise StoreError(f"{journal.path} is damaged ({found})")
        kept(journal), records.selected(), records.programs(), records.prompts()
        for (name,) in database.rows("SELECT name FROM meta"):
            records.state(name)
        ids = [number for (number,) in database.rows("SELECT id FROM timeline ORDER BY id")]
        keys = dict(zip(ids, (info.key for info in journal.timelines()), strict=True))
        for timeline, name, entries in database.rows(
            "SELECT timeline, name, entries FROM keyframe"
        ):
            journal.nearest_checkpoint(keys[timeline], name, entries)
        for timeline, *moment in database.rows("SELECT timeline, entries, tick FROM body_state"):
            journal.body_state(keys[timeline], *moment)


def snapshot(tick):
    grid = np.arange(24, dtype=np.int32).reshape(2, 3, 4) + tick
    sally = AgentState((0.1, 1.0, 2.0))
    return Snapshot(
        tick, Box((0, 0, 0), (1, 2, 3)), Terrain.of(grid), {(0, 0, 0): {"egg": 1}}, {"sally": sally}
    )
