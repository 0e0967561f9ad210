"""Histories of other programs in which something cannot be: told by line, and nothing is left."""

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

import beliefnest as bn
from beliefnest.cli.app import run_command_line
from beliefnest.errors import InputError, StoreError
from beliefnest.nest.face.recorded import RecordedNest
from beliefnest.nest.past.trace_import import import_trace
from beliefnest.timeline.trace import load_trace, read_trace
from beliefnest.world.registry import Registry

CHEST = [3, 1, 3]
FIRST = {
    "box": [[0, 0, 0], [9, 3, 9]],
    "fills": [[[0, 0, 0], [9, 0, 9], "stone"]],
    "blocks": [[*CHEST, "chest"]],
    "containers": [[*CHEST, {"diamond": 1}]],
    "agents": {"sally": {"position": [2.5, 1, 2.5]}, "anne": {"position": [5.5, 1, 2.5]}},
}
FAR = 30_000_001
HALVES = ((0, "right"), (1, "left"))


def opening(place):
    return {"kind": "open_container", "actor": "sally", "detail": {"position": place}}


def event(kind, **detail):
    return {"tick": 1, "events": [{"kind": kind, "actor": "sally", "detail": detail}]}


def dropped(count, x, number="4"):
    return {"tick": 1, "items": {number: {"name": "egg", "count": count, "position": [x, 1, 1]}}}


@pytest.fixture(scope="module")
def registry():
    return Registry.load()


def written(folder, *lines):
    path = folder / "trace.jsonl"
    path.write_bytes(b"\n".join(json.dumps(line).encode() for line in lines))
    return path


IMPOSSIBLE = {
    "an opening outside": ({"tick": 1, "events": [opening([3, 0, 13])]}, r"\(3, 0, 13\) lies out"),
    "an opening of air": ({"tick": 1, "events": [opening([4, 1, 4])]}, "air, which holds no items"),
    "a block outside": (event("mine_block", position=[-1, 1, 3]), "lies outside"),
    "an update outside": (event("block_update", position=[3, 4, 3]), "lies outside"),
    "a way to nowhere": (event("move_to", destination=[FAR, 1, 1]), "is no position"),
    "no such block": (event("place_block", position=CHEST, block="stonee"), "stonee"),
    "no such item": (event("craft_item", items={"diamondd": 1}), "diamondd"),
    "too many items": (event("craft_item", items={"diamond": 10**6}), "slots"),
    "nothing given": (event("give_item_to_other", other="anne", items={"egg": 0}), "positive"),
    "a full chest": ({"tick": 1, "containers": [[*CHEST, {"egg": 433}]]}, "28 slots"),
    "a rich agent": ({"tick": 1, "agents": {"sally": {"inventory": {"egg": 10**9}}}}, "slots"),
    "a far agent": (
        {"tick": 1, "agents": {"sally": {"position": [1e300, 1, 1]}}},
        "is no position",
    ),
    "a heap of eggs": (dropped(17, 1), "2 slots"),
    "an egg outside": (dropped(1, 99), "lies outside"),
    "an egg of a large number": (dropped(1, 1, str(2**60)), "item number .* is out of range"),
    "a tick too late": ({"tick": 2**60}, "tick 1152921504606846976 is out of range"),
    "nested without end": (b'{"tick": 1, "agents": ' + b"[" * 100_000, "line 2"),
    "no text": (b'{"tick": "\xff"}', "line 2"),
}


@pytest.mark.parametrize(("line", "told"), IMPOSSIBLE.values(), ids=IMPOSSIBLE)
def test_what_cannot_be_is_told_by_its_line(tmp_path, registry, line, told):
    path = written(tmp_path, FIRST)
    with path.open("ab") as file:
        file.write(b"\n" + (line if isinstance(line, bytes) else json.dumps(line).encode()))
    with pytest.raises(InputError, match=told) as fault:
        load_trace(path, registry)
    assert "line 2" in str(fault.value)
    assert "\n" not in str(fault.value)


@pytest.mark.parametrize(
    "change",
    [
        {"box": [[0, 0, 0], [2**40, 3, 9]]},
        {"box": [[FAR, 0, 0], [FAR + 9, 3, 9]]},
        {"box": [[9, 3, 9], [0, 0, 0]]},
        {"tick": -1},
        {"agents": {"__proto__": {"position": [2.5, 1, 2.5]}}},
        {"agents": {"a b": {"position": [2.5, 1, 2.5]}}},
        {"agents": {f"a{n}": None for n in range(201)}},
    ],
)
def test_an_impossible_beginning_is_refused(registry, change):
    with pytest.raises(InputError, match="line 1, the first state"):
        read_trace([json.dumps({**FIRST, **change}).encode()], registry)


def test_a_chest_may_go_in_the_tick_in_which_it_is_opened(registry):
    gone = {"tick": 1, "blocks": [[*CHEST, "air"]], "events": [opening(CHEST)]}
    lines = [json.dumps(line).encode() for line in (FIRST, gone)]
    assert read_trace(lines, registry).bad == ()


def test_a_failed_import_leaves_no_file(tmp_path, capsys):
    path = written(tmp_path, FIRST, {"tick": 1, "events": [opening([3, 0, 13])]})
    assert run_command_line(["import", str(path), "--out", str(tmp_path / "run.bn")]) == 2
    assert capsys.readouterr().err.count("\n") == 1
    assert list(tmp_path.iterdir()) == [path]


def test_an_import_that_fails_while_it_is_written_leaves_no_file(tmp_path, registry, monkeypatch):
    def refuse(*_):
        raise StoreError("full")

    trace = load_trace(written(tmp_path, FIRST), registry)
    monkeypatch.setattr("beliefnest.nest.past.trace_import.record_trace", refuse)
    with pytest.raises(StoreError, match="full"):
        import_trace(trace, "x", tmp_path / "run.bn")
    assert [path.name for path in tmp_path.iterdir()] == ["trace.jsonl"]


def test_an_import_leaves_the_file_of_another_run(tmp_path, registry):
    trace = load_trace(written(tmp_path, FIRST), registry)
    import_trace(trace, "x", tmp_path / "run.bn")
    before = (tmp_path / "run.bn").read_bytes()
    with pytest.raises(StoreError, match="exists"):
        import_trace(trace, "x", tmp_path / "run.bn")
    assert (tmp_path / "run.bn").read_bytes() == before


PLACES = st.tuples(*[st.integers(-1, 13)] * 3).map(list)
EVENTS = st.one_of(
    PLACES.map(opening),
    st.tuples(
        st.sampled_from(["mine_block", "place_block", "block_update", "use_lever"]), PLACES
    ).map(lambda each: event(each[0], position=each[1])["events"][0]),
    st.tuples(PLACES, st.integers(-1, 3)).map(
        lambda each: event("get_item_from_chest", position=each[0], items={"diamond": each[1]})[
            "events"
        ][0]
    ),
    st.text(max_size=400).map(lambda text: event("chat", text=text)["events"][0]),
)
LINES = st.lists(
    st.fixed_dictionaries(
        {"events": st.lists(EVENTS, max_size=2)},
        optional={
            "blocks": st.lists(
                st.tuples(PLACES, st.sampled_from(["air", "chest", "stone"])).map(
                    lambda each: [*each[0], each[1]]
                ),
                max_size=2,
            )
        },
    ),
    min_size=1,
    max_size=5,
)


@given(lines=LINES)
def test_what_is_imported_teaches_of_what_is_there_alone(registry, tmp_path_factory, lines):
    numbered = [{**line, "tick": n} for n, line in enumerate(lines, 1)]
    told = read_trace([json.dumps(line).encode() for line in (FIRST, *numbered)], registry)
    path = tmp_path_factory.mktemp("trace") / "run.bn"
    import_trace(told, "x", path)
    opened = {
        event.detail["position"]
        for entry in told.entries
        for event in entry.events
        if "items" in event.detail or event.kind == "open_container"
    }
    with bn.Nest.read(path) as nest:
        for name in ("/sally", "/sally/anne", "/anne"):
            for place, content in nest[name].state.containers.items():
                assert place in told.first.box
                assert not (content.items or content.complete) or place in opened


def test_two_halves_of_a_chest_are_one_belief(tmp_path, registry):
    halves = {"blocks": [[3 + x, 1, 3, f"chest[facing=south,type={t}]"] for x, t in HALVES]}
    apart = {"containers": [[3, 1, 3, {"diamond": 1}], [4, 1, 3, {"egg": 2}]]}
    taking = {"kind": "get_item_from_chest", "actor": "sally"}
    taken = {
        "tick": 3,
        "containers": [[4, 1, 3, {"egg": 1}]],
        "events": [{**taking, "detail": {"position": [4, 1, 3], "items": {"egg": 1}}}],
    }
    look = {"tick": 1, "events": [opening([4, 1, 3])]}
    trace = load_trace(written(tmp_path, {**FIRST, **halves, **apart}, look, taken), registry)
    import_trace(trace, "halves", tmp_path / "halves.bn")
    with RecordedNest.read(tmp_path / "halves.bn") as nest:
        for path in ("/", "/sally"):
            held = nest[path].state.containers
            assert {at: dict(each.items) for at, each in held.items()} == {
                (3, 1, 3): {"diamond": 1, "egg": 1}
            }
            assert held[4, 1, 3].complete
        assert nest["/anne/sally"].state.containers[4, 1, 3].items == {}
