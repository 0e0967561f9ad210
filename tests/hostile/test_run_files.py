"""Run files of strangers, well formed and sealed: refused in a line, or read as they are."""

import math
import shutil
from pathlib import Path

import numpy as np
import pytest
from msgspec.structs import replace
from tests.hostile.forging import (
    change_checkpoint,
    change_entries,
    change_rows,
    change_start,
    node_changed,
)
from tests.hostile.limits import ends_well

import beliefnest as bn
from beliefnest.errors import BeliefNestError
from beliefnest.nest.face.recorded import RecordedNest
from beliefnest.timeline import codec
from beliefnest.timeline.journal import TimelineKey
from beliefnest.timeline.store import Journal
from beliefnest.world.compression import compressed, decompressed

ROOM = {
    "name": "room",
    "box": [[0, 0, 0], [8, 4, 8]],
    "blocks": [{"block": "stone", "fill": [[0, 0, 0], [8, 0, 8]]}],
    "agents": {"ann": {"position": [2.5, 1, 2.5]}, "bob": {"position": [4.5, 1, 4.5]}},
    "containers": [{"at": [6, 1, 6], "items": {"diamond": 2}}],
}
GO = "await goToPosition(bot, new Vec3({}, 1, {}), 0); await say(bot, 'here')"
TAKE = "await getItemFromChest(bot, new Vec3(6, 1, 6), {diamond: 1})"


@pytest.fixture(scope="module")
def sound(tmp_path_factory):
    """Run of some 350 entries, with a checkpoint of the belief of ann about bob."""
    path = tmp_path_factory.mktemp("sound") / "run.bn"
    with bn.Nest.open(bn.Scenario.from_mapping(ROOM), "scripted", store=path) as nest:
        nest["/"].run("ann", TAKE)
        for turn in range(60):
            x, z = (1, 7) if turn % 2 else (7, 1)
            nest["/"].run_all({"ann": GO.format(x, z), "bob": GO.format(z, x + (x == 7) - 1)})
        assert nest["/ann/bob"].state.tick > 256
    return path


@pytest.fixture
def run(sound, tmp_path):
    return Path(shutil.copy(sound, tmp_path / "run.bn"))


def believed(path):
    """Read all that matters of a run: states of two depths, now and in the middle."""
    with RecordedNest.read(path) as nest:
        found = []
        for name in ("/ann", "/ann/bob"):
            for tick in (nest.head("/"), nest.head("/") // 2):
                state = nest.at(tick)[name].state
                found.append((state.agents, state.containers, state.blocks.grid.tolist()))
    return found


def refused(path):
    with pytest.raises(BeliefNestError) as fault:
        believed(path)
    assert fault.value.exit_status == 2
    assert "\n" not in str(fault.value)
    return str(fault.value)


def every(change, kind="frame"):
    """Return a change of the values of all entries of a kind."""

    def changed(entries):
        return [[name, change(value) if name == kind else value] for name, value in entries]

    return changed


def agent(**values):
    def changed(frame):
        told = {name: {**state, **values} for name, state in frame["agents"].items()}
        return {**frame, "agents": told}

    return changed


def event(**detail):
    made = {"kind": "open_container", "actor": "ann", "detail": {"position": [6, 1, 6]}}
    return lambda frame: {**frame, "events": [{**made, **detail}]}


ENTRIES = {
    "a block outside the box": lambda f: {**f, "blocks": {(900, 1, 1): 1}},
    "a block below the box": lambda f: {**f, "blocks": {(0, -1, 0): 1}},
    "a block far away": lambda f: {**f, "blocks": {(2**40, 0, 0): 1}},
    "a state that is none": lambda f: {**f, "blocks": {(1, 1, 1): 26_644}},
    "a state below unknown": lambda f: {**f, "blocks": {(1, 1, 1): -2}},
    "a huge state": lambda f: {**f, "blocks": {(1, 1, 1): 2**40}},
    "a sign of a state that is none": lambda f: {**f, "blocks": {(1, 1, 1): [-5, "x"]}},
    "a container outside": lambda f: {**f, "containers": {(900, 1, 1): {"diamond": 1}}},
    "a negative count": lambda f: {**f, "containers": {(6, 1, 6): {"diamond": -1}}},
    "a huge count": lambda f: {**f, "containers": {(6, 1, 6): {"diamond": 2**62}}},
    "an item that is none": lambda f: {**f, "containers": {(6, 1, 6): {"ray_gun": 1}}},
    "a dropped item at NaN": lambda f: {
        **f,
        "items": {5: {"name": "bread", "count": 1, "position": [math.nan, 1, 1]}},
    },
    "a dropped item of a negative number": lambda f: {**f, "items": {-5: None}},
    "an unknown agent": lambda f: {**f, "agents": {"zoe": None}},
    "an agent at NaN": agent(position=[math.nan, 1.0, 1.0]),
    "an agent at infinity": agent(position=[math.inf, 1.0, 1.0]),
    "an agent far away": agent(position=[1e300, 1.0, 1.0]),
    "an endless turn": agent(yaw=1e300),
    "a pitch that is none": agent(pitch=math.nan),
    "endless health": agent(health=math.inf),
    "a slot that is none": agent(equipment={"tail": "diamond"}),
    "a late tick": lambda f: {**f, "tick": 2**40},
    "a negative tick": lambda f: {**f, "tick": -5},
    "an actor that is none": event(actor="zoe"),
    "an act outside the box": event(detail={"position": [900, 1, 6]}),
    "an act without its place": event(detail={}),
    "a place of two numbers": event(detail={"position": [6, 1]}),
    "speech to nobody known": event(kind="chat", detail={"text": "x", "to": "zoe"}),
    "an endless destination": event(kind="move_to", detail={"destination": [math.nan, 1, 1]}),
    "a claim outside the box": event(
        kind="chat",
        detail={
            "text": "x",
            "claims": [{"kind": "located", "item": "diamond", "place": [900, 1, 1]}],
        },
    ),
    "another type": lambda f: {**f, "agents": "x"},
}


@pytest.mark.parametrize("change", ENTRIES.values(), ids=ENTRIES)
def test_an_entry_out_of_bounds_is_refused(run, change):
    change_entries(run, every(change))
    assert str(run) in refused(run)


def test_an_edit_of_an_unknown_simulator_is_refused(run):
    edit = {"tick": 0, "path": ["zoe"], "blocks": {}, "containers": {}}
    change_entries(run, lambda entries: [["edit", {**edit, "tick": v["tick"]}] for _, v in entries])
    assert "no path of agents" in refused(run)


def test_last_states_of_agents_out_of_bounds_are_refused(run):
    change_entries(run, lambda agents: {**agents, "zoe": None}, "agents")
    with (
        pytest.raises(BeliefNestError, match="unknown agent 'zoe'"),
        RecordedNest.read(run) as nest,
    ):
        assert nest.at(nest.head("/") - 1)["/"].state.agents


def random_codes(row):
    return {**row, "codes": np.random.default_rng(1).bytes(len(row["codes"]) or 64)}


FORGED = {
    "other blocks": lambda node: {
        **node,
        "row": {
            **node["row"],
            "blocks": np.full(len(node["row"]["blocks"]) // 2, 5000, np.int16).tobytes(),
        },
    },
    "blocks that are none": lambda node: {
        **node,
        "row": {
            **node["row"],
            "blocks": np.full(len(node["row"]["blocks"]) // 2, 32767, np.int16).tobytes(),
        },
    },
    "random codes": lambda node: {**node, "row": random_codes(node["row"])},
    "a pose that is none": lambda node: {
        **node,
        "row": {**node["row"], "pose": np.full(2, -5, np.int32).tobytes()},
    },
    "another pose": lambda node: {
        **node,
        "row": {**node["row"], "pose": np.full(2, 0, np.int32).tobytes()},
    },
    "short rows": lambda node: {**node, "row": {**node["row"], "pose": b"abc"}},
    "cells that are none": lambda node: {
        **node,
        "row": {**node["row"], "edited_cells": [2**40]},
    },
}


@pytest.mark.parametrize("change", FORGED.values(), ids=FORGED)
def test_a_checkpoint_of_somebody_else_changes_no_belief(sound, run, change):
    change_checkpoint(run, lambda body: node_changed(body, change))
    assert believed(run) == believed(sound)


def test_poses_of_a_forged_checkpoint_change_no_belief(sound, run):
    def far(body):
        poses = body["state"]["poses"]
        poses["feet"] = np.full(len(poses["feet"]) // 8, 1e300).tobytes()
        return body

    change_checkpoint(run, far)
    assert believed(run) == believed(sound)


def test_own_checkpoints_are_used(run, monkeypatch):
    from beliefnest.nest.past import checkpoints

    found = []
    restored = checkpoints.restored
    monkeypatch.setattr(checkpoints, "restored", lambda *args: found.append(1) or restored(*args))
    with RecordedNest.read(run) as nest:
        assert nest["/ann/bob"].state.agents
    assert found


START = {
    "an empty box": lambda s: {**s, "snapshot": {**s["snapshot"], "low": [9, 9, 9]}},
    "a huge box": lambda s: {**s, "snapshot": {**s["snapshot"], "high": [2**40, 4, 8]}},
    "other blocks": lambda s: {
        **s,
        "snapshot": {**s["snapshot"], "blocks": b"\xff\xff\xff\x7f" * 405},
    },
    "an agent at NaN": lambda s: {
        **s,
        "snapshot": {
            **s["snapshot"],
            "agents": {"ann": {"position": [math.nan, 1, 1]}, "bob": {"position": [1, 1, 1]}},
        },
    },
    "a late tick": lambda s: {**s, "snapshot": {**s["snapshot"], "tick": 2**40}},
    "an item far away": lambda s: {
        **s,
        "snapshot": {
            **s["snapshot"],
            "items": {1: {"name": "bread", "count": 1, "position": [1e300, 0, 0]}},
        },
    },
    "a view that is none": lambda s: {
        **s,
        "perception": {**s["perception"], "field_of_view": math.nan},
    },
    "an unknown form": lambda s: {**s, "form": 2**40},
}


@pytest.mark.parametrize("change", START.values(), ids=START)
def test_a_start_that_cannot_be_is_refused(run, change):
    change_start(run, change)
    refused(run)


ROWS = {
    "a base that is itself": ("timeline", {"base": 1, "base_entries": 0, "base_tick": 0}),
    "a head before the start": ("timeline", {"head": -5}),
    "a late head": ("timeline", {"head": 2**40}),
    "a head that is a text": ("timeline", {"head": "x"}),
    "more packed entries than entries": ("timeline", {"packed": 2**40}),
    "a simulator of nobody": ("timeline", {"path": '["zoe"]'}),
    "a path that is none": ("timeline", {"path": "[[["}),
    "a count of entries that is none": ("piece", {"count": 2**40}),
    "ticks that are not those of the entries": ("piece", {"first_tick": 90_000}),
    "a branch that is none": ("selected", {"branch": "x" * 100_000}),
}


@pytest.mark.parametrize(("table", "values"), ROWS.values(), ids=ROWS)
def test_a_row_that_cannot_be_is_refused(run, table, values):
    change_rows(run, table, "1", lambda row: {**row, **values})
    assert len(refused(run)) < 1000


def test_a_count_of_events_that_is_none_is_refused(run):
    change_rows(run, "piece", "1", lambda row: {**row, "events": 2**40})
    with Journal.read(run) as journal:
        key = TimelineKey((), "main")
        with pytest.raises(BeliefNestError, match="it counts"):
            journal.events_until(key, journal.info(key).entries)


@pytest.mark.parametrize("name", ["first_tick", "last_tick", "events", "changes"])
def test_a_chunk_that_tells_a_plausible_lie_is_refused(run, name):
    change_rows(run, "piece", "compressed", lambda row: {**row, name: row[name] + 1})
    with (
        RecordedNest.read(run) as nest,
        pytest.raises(BeliefNestError, match=r"a chunk tells|stands") as e,
    ):
        nest["/"].render("{{ branch | story }}")
    assert e.value.exit_status == 2


def test_agents_that_a_chunk_lies_about_are_refused(run):
    def moved(row):
        known = codec.decode_agents(decompressed(row["agents"], 2**26))
        known["ann"] = replace(known["ann"], health=known["ann"].health - 1)
        return {**row, "agents": compressed(codec.encode(known), 3)}

    change_rows(run, "piece", "compressed", moved)
    with RecordedNest.read(run) as nest, pytest.raises(BeliefNestError, match="other agents than"):
        nest["/"].render("{{ branch | story }}")


def test_a_chunk_that_unpacks_to_any_size_is_refused(run):
    bomb = compressed(bytes(1_500_000_000), 3)
    change_rows(run, "piece", "compressed", lambda row: {**row, "body": bomb})
    assert "would unpack to more than" in refused(run)


@pytest.mark.parametrize(
    "command",
    [["show", "run.bn", "--html", "page.html"], ["export", "run.bn", "--out", "tables"]],
    ids=" ".join,
)
def test_a_command_ends_well(run, command):
    change_entries(run, every(ENTRIES["a block outside the box"]))
    assert "lies outside the box" in ends_well(command, run.parent)
