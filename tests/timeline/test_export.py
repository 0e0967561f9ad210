"""Exports hold what the journal holds, in the columns the documentation lists."""

import json
import re
import sys
from pathlib import Path

import numpy as np
import pytest
from msgspec.structs import replace

from beliefnest.errors import BranchError, InputError
from beliefnest.timeline.export import FORMATS, export
from beliefnest.timeline.export_tables import (
    IF_ANY,
    TABLES,
    BeliefRow,
    program_row,
    prompt_row,
    run_row,
)
from beliefnest.timeline.journal import Edit, ForkPoint, TimelineKey
from beliefnest.timeline.run_records import ProgramRecord, PromptRecord, RunRecord
from beliefnest.timeline.store import Journal
from beliefnest.world.frames import Frame, Snapshot
from beliefnest.world.registry import Registry
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import AgentState, Box, DroppedItem, Event, EventKind, Sign

DOCS = Path(__file__).parents[2] / "docs" / "export.md"
MAIN = TimelineKey((), "main")
PLAN = TimelineKey(("sally",), "plan")
RUN = RunRecord("short", "name: short", "", 7, {"node": "v24"}, b"", {"short.txt": "{{ task }}"})
PROGRAM = ProgramRecord(("sally",), "plan", "sally", "x()", 5, False, "no x", 3, 2, step=1)
PROMPT = PromptRecord(
    ("sally", "anne"),
    PLAN,
    5,
    "told",
    1,
    (("user", "Go."),),
    {"temperature": 0.0, "seed": None},
    "x()",
    None,
    1,
    20,
    3,
    None,
)
BELIEF = BeliefRow(
    ("sally",),
    MAIN,
    6,
    {"containers": {"1,2,3": {"items": {}, "complete": False}}},
    {"1,2,3": None, "1,2,4": "stone"},
)


@pytest.fixture(scope="module")
def registry():
    return Registry.load()


@pytest.fixture
def first(registry):
    grid = np.zeros((2, 1, 1), np.int32)
    grid[1, 0, 0] = registry.state_id("stone")
    box = Box((5, 0, 0), (6, 0, 0))
    return Snapshot(
        0, box, Terrain.of(grid), {(6, 0, 0): {"egg": 1}}, {"sally": AgentState((5.5, 0.0, 0.5))}
    )


def test_very_many_first_blocks_are_told_as_cuboids(registry, tmp_path):
    stone, sign = registry.state_id("stone"), registry.state_id("oak_sign")
    draft = Terrain.full((300, 40, 300), registry.air).draft()
    draft.fill((0, 0, 0), (300, 30, 300), stone)
    draft[7, 30, 9] = sign
    box = Box((5, 0, -4), (304, 39, 295))
    place = (12, 30, 5)
    snapshot = Snapshot(0, box, draft.terrain(), {}, {}, signs={place: "hi"})
    out = tmp_path / "out"
    journal = Journal()
    journal.create(MAIN, None, 0)
    counts = export(journal, "jsonl", out, registry=registry, first=snapshot)
    assert (counts["cuboids"], counts["blocks"], counts["signs"]) == (2, 1, 1)
    whole, single = map(json.loads, (out / "cuboids.jsonl").read_text().splitlines())
    corners = ("x", "y", "z", "x2", "y2", "z2")
    assert [whole[name] for name in corners] == [5, 0, -4, 304, 29, 295]
    assert (whole["entry"], whole["block"]) == (-1, "stone")
    assert [single[name] for name in corners] == [*place, *place]


@pytest.fixture
def journal(registry):
    journal = Journal()
    journal.create(MAIN, None, 0)
    pose = AgentState((0.1, 1.0, -2.5), 0.5, -0.25, False, {"head": "iron_helmet"}, {"egg": 2})
    talk = Event(EventKind.CHAT, "sally", {"text": "hé"})
    update = Event(EventKind.BLOCK_UPDATE, None, {"position": (1, 2, 3), "block": "air"})
    entries = [
        Frame(3, {"sally": pose}, items={7: DroppedItem("egg", 2, (1.0, 2.0, 3.5))}),
        Frame(
            5,
            blocks={
                (1, 2, 3): registry.state_id("lever[face=wall,facing=north,powered=true]"),
                (1, 2, 4): Sign(registry.state_id("oak_sign"), "way\nout"),
            },
        ),
        Edit(5, ("sally", "anne"), {(1, 2, 3): -1}, {(4, 5, 6): {"egg": 1}}),
        Frame(6, {"sally": None}, {}, {(4, 5, 6): None}, {7: None}, (talk, update)),
    ]
    journal.append(MAIN, entries, 9)
    journal.create(PLAN, ForkPoint(MAIN, 2, 5), 5)
    journal.describe(PLAN, "try")
    return journal


def jsonl(out, table):
    return [json.loads(line) for line in (out / f"{table}.jsonl").read_text().splitlines()]


def parquet(out, table):
    from pyarrow import parquet as pq

    objects = [name for name, kind in TABLES[table].items() if kind == "object"]
    rows = pq.read_table(out / f"{table}.parquet").to_pylist()
    for row in rows:
        row.update({name: json.loads(row[name]) for name in objects if row[name] is not None})
    return rows


def needing(name):
    return pytest.param(name, marks=pytest.mark.extra("pyarrow") if name == "parquet" else ())


@pytest.fixture(params=[needing(name) for name in FORMATS])
def written(request, journal, registry, first, tmp_path):
    out = tmp_path / "out"
    counts = export(
        journal,
        request.param,
        out,
        registry=registry,
        first=first,
        beliefs=iter([BELIEF]),
        notes=iter(
            [
                run_row(RUN, [RUN.versions]),
                program_row(PROGRAM),
                prompt_row(PROMPT),
                # Of episodes, of which timelines know nothing, and of large places.
                *((name, dict.fromkeys(TABLES[name])) for name in ("rounds", "goals", "cuboids")),
            ]
        ),
    )
    tables = {
        name: {"jsonl": jsonl, "parquet": parquet}[request.param](out, name) for name in TABLES
    }
    assert {name: len(rows) for name, rows in tables.items()} == counts
    return tables


def place(entry, tick):
    return {"path": "/", "branch": "main", "entry": entry, "tick": tick}


def test_every_row_has_every_column(written):
    for name, rows in written.items():
        assert rows
        for row in rows:
            assert list(row) == list(TABLES[name])


def test_timelines(written):
    main, plan = written["timelines"]
    assert (main["path"], main["branch"], main["base_path"], main["entries"]) == (
        "/",
        "main",
        None,
        4,
    )
    assert plan == {
        "path": "/sally",
        "branch": "plan",
        "base_path": "/",
        "base_branch": "main",
        "base_entries": 2,
        "base_tick": 5,
        "start": 5,
        "head": 5,
        "entries": 0,
        "description": "try",
    }


def test_agents(written):
    begun, came, left = written["agents"]
    assert (begun["entry"], begun["tick"], begun["x"]) == (-1, 0, 5.5)
    assert came == {
        **place(0, 3),
        "agent": "sally",
        "x": 0.1,
        "y": 1.0,
        "z": -2.5,
        "yaw": 0.5,
        "pitch": -0.25,
        "on_ground": False,
        "health": 20.0,
        "food": 20.0,
        "equipment": {"head": "iron_helmet"},
        "inventory": {"egg": 2},
    }
    assert {k: v for k, v in left.items() if v is not None} == {**place(3, 6), "agent": "sally"}


def test_blocks_and_edits(written):
    cell = {"x": 1, "y": 2, "z": 3}
    lever = "lever[face=wall,facing=north,powered=true]"
    assert written["blocks"] == [
        {**place(-1, 0), "x": 6, "y": 0, "z": 0, "block": "stone", "edited": None},
        {**place(1, 5), **cell, "block": lever, "edited": None},
        {
            **place(1, 5),
            **(cell | {"z": 4}),
            "block": "oak_sign[rotation=0,waterlogged=false]",
            "edited": None,
        },
        {**place(2, 5), **cell, "block": None, "edited": "/sally/anne"},
    ]
    assert written["signs"] == [
        {**place(1, 5), **(cell | {"z": 4}), "text": "way\nout", "claims": [], "edited": None}
    ]


def test_containers_items_and_events(written):
    assert [(r["entry"], r["items"], r["edited"]) for r in written["containers"]] == [
        (-1, {"egg": 1}, None),
        (2, {"egg": 1}, "/sally/anne"),
        (3, None, None),
    ]
    assert [(r["item"], r["name"], r["z"]) for r in written["items"]] == [
        (7, "egg", 3.5),
        (7, None, None),
    ]
    assert [(r["number"], r["kind"], r["actor"], r["detail"]) for r in written["events"]] == [
        (0, "chat", "sally", {"text": "hé"}),
        (1, "block_update", None, {"position": [1, 2, 3], "block": "air"}),
    ]


def test_beliefs(written):
    (row,) = written["beliefs"]
    assert (row["tick"], row["path"]) == (6, "/sally")
    assert (row["timeline_path"], row["timeline_branch"]) == ("/", "main")
    assert row["state"] == {"containers": {"1,2,3": {"items": {}, "complete": False}}}
    assert row["blocks"] == {"1,2,3": None, "1,2,4": "stone"}


def test_the_run_its_programs_and_its_prompts(written):
    assert written["run"] == [
        {
            "scenario": "short",
            "condition": None,
            "seed": 7,
            "versions": [{"node": "v24"}],
            "text": "name: short",
            "templates": {"short.txt": "{{ task }}"},
        }
    ]
    (program,) = written["programs"]
    assert (program["path"], program["branch"], program["tick"]) == ("/sally", "plan", 5)
    assert (program["agent"], program["code"], program["ok"]) == ("sally", "x()", False)
    assert (program["error"], program["ticks"], program["call"]) == ("no x", 3, 2)
    assert program["detail"] == {"step": "1", "timeout_ticks": "0", "entries": "0"}
    (prompt,) = written["prompts"]
    assert (prompt["path"], prompt["timeline_path"], prompt["timeline_branch"]) == (
        "/sally/anne",
        "/sally",
        "plan",
    )
    assert prompt["messages"] == [{"role": "user", "text": "Go."}]
    assert prompt["sampling"] == {"temperature": 0.0, "seed": None}
    assert (prompt["answer"], prompt["error"], prompt["attempt"]) == ("x()", None, 1)
    assert (prompt["input_tokens"], prompt["output_tokens"], prompt["cost"]) == (20, 3, None)


def test_chosen_timelines_alone(journal, registry, tmp_path):
    counts = export(journal, "jsonl", tmp_path / "out", registry=registry, timelines=[PLAN])
    always = [name for name in TABLES if name not in IF_ANY]
    assert counts == {**dict.fromkeys(always, 0), "timelines": 1}
    assert not (tmp_path / "out" / "signs.jsonl").exists()


def test_nothing_is_written_when_it_fails(journal, registry, tmp_path):
    out = tmp_path / "out"
    with pytest.raises(BranchError):
        export(journal, "jsonl", out, registry=registry, timelines=[TimelineKey((), "none")])
    odd = replace(BELIEF, state={"x": object()})
    with pytest.raises(InputError, match="JSON cannot represent"):
        export(journal, "jsonl", out, registry=registry, beliefs=[odd])
    with pytest.raises(InputError, match="unknown format 'csv'; choose jsonl or parquet"):
        export(journal, "csv", out, registry=registry)
    assert list(tmp_path.iterdir()) == []


def test_a_folder_with_something_in_it_is_left_alone(journal, registry, tmp_path):
    (tmp_path / "mine.txt").write_text("x")
    with pytest.raises(InputError, match="exists already"):
        export(journal, "jsonl", tmp_path, registry=registry)
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]


def test_a_missing_library_is_named(journal, registry, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(InputError, match=r"pip install 'beliefnest\[parquet\]'"):
        export(journal, "parquet", tmp_path / "out", registry=registry)


def test_the_documentation_lists_every_column_with_its_type():
    text = DOCS.read_text()
    common = dict.fromkeys(("path", "branch", "entry", "tick"))
    for name, columns in TABLES.items():
        section = text.split(f"\n### {name}\n")[1].split("\n#")[0]
        listed = {
            column: kind
            for cells, kind in re.findall(r"^\| (`[a-z0-9_` ]+) \| (\w+) \|", section, re.MULTILINE)
            for column in re.findall(r"`(\w+)`", cells)
        }
        own = {c: k for c, k in columns.items() if c not in common or c in listed}
        assert listed == own, name
