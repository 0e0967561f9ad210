"""Traces of other programs become entries; bad lines are told by number."""

import json
import re
from pathlib import Path

import numpy as np
import pytest

import beliefnest as bn
from beliefnest.errors import InputError
from beliefnest.timeline.journal import TimelineInfo, TimelineKey
from beliefnest.timeline.store import Journal
from beliefnest.timeline.trace import load_trace, read_trace, record_trace
from beliefnest.world.claims import claims_written
from beliefnest.world.frames import Frame
from beliefnest.world.registry import Registry
from beliefnest.world.values import AgentState, Box, DroppedItem, Event, EventKind

DOCS = Path(__file__).parents[2] / "docs" / "export.md"
FIRST = {
    "box": [[0, 0, 0], [9, 3, 9]],
    "fills": [[[0, 0, 0], [9, 0, 9], "stone"]],
    "blocks": [[3, 1, 3, "chest"]],
    "containers": [[3, 1, 3, {"diamond": 1}]],
    "agents": {"sally": {"position": [2.5, 1, 2.5], "inventory": {"bread": 1}}, "anne": None},
}


@pytest.fixture(scope="module")
def registry():
    return Registry.load()


def read(registry, *lines):
    return read_trace([json.dumps(line).encode() for line in (FIRST, *lines)], registry)


def test_the_documented_trace_is_read(registry):
    text = re.search(r"```jsonl\n(.*?)```", DOCS.read_text(), re.DOTALL).group(1)
    trace = read_trace(text.encode().splitlines(), registry)
    chest = (3, 1, 3)
    anne = AgentState((4.5, 1.0, 2.5), yaw=1.57)
    taken = {"position": chest, "items": {"diamond": 1}}
    assert trace.bad == ()
    assert trace.agents == ("sally", "anne")
    assert trace.entries == (
        Frame(4, {"anne": anne}),
        Frame(
            7,
            {"anne": AgentState((4.5, 1.0, 2.5), yaw=1.57, inventory={"diamond": 1})},
            containers={chest: {}},
            events=(Event(EventKind.GET_ITEM_FROM_CHEST, "anne", taken),),
        ),
        Frame(9, events=(Event(EventKind.CHAT, "anne", {"text": "mine"}),)),
    )
    assert trace.first.tick == 0
    assert trace.first.box == Box((0, 0, 0), (9, 3, 9))
    assert trace.first.agents == {"sally": AgentState((2.5, 1.0, 2.5))}
    assert trace.first.containers == {chest: {"diamond": 1}}
    grid = np.zeros((10, 4, 10), np.int32)
    grid[:, 0, :] = registry.state_id("stone")
    grid[chest] = registry.state_id("chest")
    assert np.array_equal(trace.first.blocks, grid)


def test_what_a_line_leaves_out_stays(registry):
    trace = read(registry, {"tick": 1, "agents": {"sally": {"pitch": 0.5}}})
    sally = AgentState((2.5, 1.0, 2.5), pitch=0.5, inventory={"bread": 1})
    assert trace.entries == (Frame(1, {"sally": sally}),)


RIGHT, LEFT = (4, 1, 7), (5, 1, 7)
HALVES = {
    "blocks": [
        [*RIGHT, "chest[facing=south,type=right]"],
        [*LEFT, "chest[facing=south,type=left]"],
    ]
}


@pytest.mark.parametrize(
    ("first", "later", "last"),
    [
        ([[*RIGHT, {"egg": 1}]], [[*LEFT, {}]], {}),
        ([[*LEFT, {"egg": 1}]], [[*RIGHT, {"egg": 2}]], {"egg": 2}),
        ([[*RIGHT, {"egg": 1}], [*LEFT, {}]], [[*LEFT, {"egg": 4}]], {"egg": 5}),
        ([[*LEFT, {}], [*RIGHT, {"egg": 1}]], [[*RIGHT, {"bone": 1}]], {"bone": 1}),
        ([], [[*LEFT, {"egg": 1}], [*RIGHT, {"egg": 1, "bone": 1}]], {"egg": 2, "bone": 1}),
    ],
)
def test_contents_at_either_half_are_those_of_one_chest(registry, first, later, last):
    begun = {**FIRST, **HALVES, "containers": first}
    told = [{"kind": "located", "item": "egg", "place": LEFT}]
    events = [
        {"kind": "open_container", "actor": "sally", "detail": {"position": LEFT}},
        {"kind": "chat", "actor": "sally", "detail": {"text": "egg", "claims": told}},
    ]
    lines = [begun, {"tick": 2, "containers": later, "events": events}]
    trace = read_trace([json.dumps(line).encode() for line in lines], registry)
    assert trace.bad == ()
    assert trace.first.containers == ({RIGHT: {"egg": 1}} if first else {})
    (frame,) = trace.entries
    assert frame.containers == {RIGHT: last}
    opened, said = frame.events
    assert opened.detail["position"] == RIGHT
    # A claim is recorded as it was made: each hearer knows of its own halves.
    assert said.detail["claims"][0]["place"] == LEFT


def test_a_double_chest_holds_54_stacks(registry):
    both = {**FIRST, **HALVES, "containers": []}
    for count, fits in ((54, True), (55, False)):
        line = {"tick": 1, "containers": [[*LEFT, {"iron_sword": count}]]}
        trace = read_trace([json.dumps(each).encode() for each in (both, line)], registry)
        assert (trace.bad == ()) == fits


def test_items_and_new_containers(registry):
    trace = read(
        registry,
        {"tick": 1, "items": {"4": {"name": "egg", "count": 2, "position": [1, 1, 1]}}},
        {"tick": 2, "items": {"4": None}, "blocks": [[5, 1, 5, "barrel"]]},
        {"tick": 3, "containers": [[5, 1, 5, {"egg": 2}]]},
        {"tick": 4, "blocks": [[5, 1, 5, "air"]], "containers": [[5, 1, 5, None]]},
    )
    assert trace.bad == ()
    assert [entry.items for entry in trace.entries[:2]] == [
        {4: DroppedItem("egg", 2, (1.0, 1.0, 1.0))},
        {4: None},
    ]
    assert [entry.containers for entry in trace.entries[2:]] == [
        {(5, 1, 5): {"egg": 2}},
        {(5, 1, 5): None},
    ]


BAD = [
    ({"tick": 0}, "tick 0 is not later than tick 0"),
    ({"tick": "1"}, "Expected `int`"),
    ({}, "tick"),
    ({"tick": 1, "block": []}, "block"),
    ({"tick": 1, "blocks": [[1, 1, 1, "stonee"]]}, "stonee"),
    ({"tick": 1, "blocks": [[1, 9, 1, "stone"]]}, r"\(1, 9, 1\) lies outside the box"),
    ({"tick": 1, "blocks": [[1, 1, "stone"]]}, "blocks"),
    ({"tick": 1, "containers": [[1, 1, 1, {"egg": 1}]]}, "air, which holds no items"),
    ({"tick": 1, "containers": [[3, 1, 3, {"egg": 0}]]}, "counts must be positive"),
    ({"tick": 1, "containers": [[3, 1, 3, {"eggg": 1}]]}, "eggg"),
    ({"tick": 1, "agents": {"bob": {"position": [1, 1, 1]}}}, "unknown agent 'bob'"),
    ({"tick": 1, "agents": {"anne": {"yaw": 1}}}, "'anne' appears without a position"),
    ({"tick": 1, "agents": {"sally": {"position": [50, 1, 1]}}}, "outside the box"),
    ({"tick": 1, "agents": {"sally": {"equipment": {"hat": "egg"}}}}, "unknown slot 'hat'"),
    ({"tick": 1, "agents": {"sally": {"equipment": {"head": "eggg"}}}}, "eggg"),
    ({"tick": 1, "agents": {"sally": {"inventory": {"egg": -1}}}}, "counts must be positive"),
    ({"tick": 1, "items": {"1": {"name": "eggg", "count": 1, "position": [1, 1, 1]}}}, "eggg"),
    ({"tick": 1, "events": [{"kind": "dance", "actor": "sally"}]}, "unknown event 'dance'"),
    ({"tick": 1, "events": [{"kind": "chat"}]}, "no actor"),
    (
        {
            "tick": 1,
            "events": [
                {"kind": "chat", "actor": "sally", "detail": {"text": "", "claims_from": "me"}}
            ],
        },
        "'claims_from' without 'claims'",
    ),
    ({"tick": 1, "events": [{"kind": "chat", "actor": "sally"}]}, "lacks the detail text"),
    ({"tick": 1, "events": [{"kind": "chat", "actor": "bob", "detail": {"text": ""}}]}, "'bob'"),
    (
        {"tick": 1, "events": [{"kind": "chat", "actor": "sally", "detail": {"txt": ""}}]},
        "txt",
    ),
    (
        {
            "tick": 1,
            "events": [{"kind": "chat", "actor": "sally", "detail": {"text": "", "to": "bob"}}],
        },
        "'bob'",
    ),
    (
        {
            "tick": 1,
            "events": [{"kind": "think", "actor": "sally", "detail": {"text": "", "to": "anne"}}],
        },
        "only a whispered chat has",
    ),
    (
        {
            "tick": 1,
            "events": [{"kind": "use_lever", "actor": "sally", "detail": {"position": [1]}}],
        },
        "position",
    ),
]


@pytest.mark.parametrize(("line", "fault"), BAD)
def test_a_bad_line_is_left_out_and_told(registry, line, fault):
    trace = read(registry, line, {"tick": 2, "agents": {"sally": {"yaw": 1.0}}})
    assert [bad.line for bad in trace.bad] == [2]
    assert re.search(fault, trace.bad[0].fault)
    sally = AgentState((2.5, 1.0, 2.5), yaw=1.0, inventory={"bread": 1})
    assert trace.entries == (Frame(2, {"sally": sally}),)


@pytest.mark.parametrize(
    ("change", "fault"),
    [
        ({"box": [[0, 0, 0], [-1, 3, 9]]}, "is empty"),
        ({"fills": [[[5, 0, 0], [1, 0, 9], "stone"]]}, "lower corner first"),
        ({"fills": [[[0, 0, 0], [99, 0, 9], "stone"]]}, "outside the box"),
        ({"agents": {"sally": {}}}, "without a position"),
        ({"containers": [[4, 1, 4, {}]]}, "holds no items"),
        ({"events": []}, "events"),
    ],
)
def test_a_bad_first_line_ends_it(registry, change, fault):
    with pytest.raises(InputError, match=rf"line 1, the first state: .*{fault}"):
        read_trace([json.dumps({**FIRST, **change}).encode()], registry)


SIGN, CLAIM = (4, 1, 4), {"kind": "located", "item": "diamond", "place": [3, 1, 3]}


def with_a_sign(text, claims):
    return {
        **FIRST,
        "blocks": [*FIRST["blocks"], [*SIGN, "oak_sign"]],
        "signs": [[*SIGN, text, claims]],
    }


def test_signs_claim_something_from_the_start_and_when_they_are_written(registry):
    update = {"position": SIGN, "text": "none", "claims": [CLAIM | {"kind": "absent"}]}
    events = [{"kind": "block_update", "actor": "sally", "detail": update}]
    lines = with_a_sign("here", [CLAIM]), {"tick": 1, "signs": [[*SIGN, "none"]], "events": events}
    trace = read_trace([json.dumps(line).encode() for line in lines], registry)
    assert trace.bad == ()
    there = bn.Claim.located("diamond", (3, 1, 3)).plain()
    assert (trace.first.signs, trace.first.sign_claims) == ({SIGN: "here"}, {SIGN: (there,)})
    assert claims_written(trace.entries[0], SIGN) == (bn.Claim.absent("diamond", (3, 1, 3)),)


@pytest.mark.parametrize(
    ("text", "claim", "fault"),
    [
        ("", CLAIM, "has claims and no text"),
        ("here", {**CLAIM, "item": "diamnd"}, "claim 1: .*diamnd"),
        ("here", {**CLAIM, "place": [99, 1, 1]}, "outside the box"),
        ("here", {**CLAIM, "kind": "holds"}, "claim 1"),
    ],
)
def test_a_wrong_claim_of_a_sign_is_named(registry, text, claim, fault):
    with pytest.raises(InputError, match=rf"the first state: the sign at \(4, 1, 4\).*{fault}"):
        read_trace([json.dumps(with_a_sign(text, [claim])).encode()], registry)


def test_a_file_tells_all_its_bad_lines_by_number(registry, tmp_path):
    path = tmp_path / "trace.jsonl"
    lines = [json.dumps(FIRST), "", '{"tick": 1', '{"tick": 2}', "\xff", '{"tick": 1}']
    path.write_bytes("\n".join(lines).encode("latin-1"))
    with pytest.raises(
        InputError, match=r"trace\.jsonl has 3 bad lines: line 3: .*line 5: .*line 6"
    ):
        load_trace(path, registry)
    for content in ("", "[]", "nothing"):
        path.write_text(content)
        with pytest.raises(InputError, match=r"trace\.jsonl: line 1"):
            load_trace(path, registry)
    with pytest.raises(InputError, match="cannot be read"):
        load_trace(tmp_path / "none.jsonl", registry)


def test_a_trace_is_recorded_as_a_timeline(registry):
    key = TimelineKey((), "main")
    trace = read(registry, {"tick": 3, "agents": {"sally": {"yaw": 1}}}, {"tick": 8})
    journal = Journal()
    record_trace(trace, journal, key)
    assert journal.info(key) == TimelineInfo(key, None, 0, 8, 2)
    assert tuple(journal.entries(key, 0, 9)) == trace.entries


def test_every_kind_of_event_is_documented_with_its_details():
    section = DOCS.read_text().split("### Kinds of events")[1]
    listed = {}
    for kinds, details in re.findall(r"^\| (`.*?`) \| (.*?) \|$", section, re.MULTILINE):
        for kind in re.findall(r"`(\w+)`", kinds):
            listed[kind] = tuple(re.findall(r"`(\w+)`", details))
    assert listed == {kind.value: kind.traits.needs for kind in EventKind}
