"""Values become bytes and come back the same, bit for bit."""

import math
import struct

import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec.structs import replace
from tests.profiles import at_night

from beliefnest.errors import StoreError
from beliefnest.timeline import codec
from beliefnest.timeline.journal import Edit
from beliefnest.world import terrain
from beliefnest.world.compression import compressed, decompressed
from beliefnest.world.frames import Frame, Snapshot
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import EQUIPMENT_SLOTS, AgentState, Box, DroppedItem, Event, EventKind

floats = st.floats(allow_nan=False)
whole = st.integers(-(2**31), 2**31 - 1)
names = st.text(max_size=16)
positions = st.tuples(whole, whole, whole)
points = st.tuples(floats, floats, floats)
contents = st.dictionaries(names, st.integers(1, 10_000), max_size=4)
ticks = st.integers(0, 2**40)
agents = st.builds(
    AgentState,
    position=points,
    yaw=floats,
    pitch=floats,
    on_ground=st.booleans(),
    equipment=st.dictionaries(st.sampled_from(EQUIPMENT_SLOTS), names),
    inventory=contents,
    health=floats,
    food=floats,
)
dropped = st.builds(DroppedItem, name=names, count=st.integers(1, 64), position=points)
details = st.dictionaries(
    names,
    st.recursive(
        names | whole | floats | st.booleans() | st.none() | positions | points | contents,
        lambda inner: st.lists(inner, max_size=3).map(tuple) | st.dictionaries(names, inner),
        max_leaves=5,
    ),
    max_size=4,
)
events = st.builds(Event, kind=st.sampled_from(EventKind), actor=names | st.none(), detail=details)
frames = st.builds(
    Frame,
    tick=ticks,
    agents=st.dictionaries(names, agents | st.none(), max_size=3),
    blocks=st.dictionaries(positions, whole, max_size=5),
    containers=st.dictionaries(positions, contents | st.none(), max_size=3),
    items=st.dictionaries(whole, dropped | st.none(), max_size=3),
    events=st.lists(events, max_size=3).map(tuple),
)
edits = st.builds(
    Edit,
    tick=ticks,
    path=st.lists(names, max_size=3).map(tuple),
    blocks=st.dictionaries(positions, whole, max_size=5),
    containers=st.dictionaries(positions, contents, max_size=3),
)


@st.composite
def snapshots(draw):
    low = draw(positions)
    shape = draw(st.tuples(*[st.integers(1, 4)] * 3))
    box = Box(low, tuple(a + n - 1 for a, n in zip(low, shape, strict=True)))
    count = math.prod(shape)
    cells = draw(st.lists(whole, min_size=count, max_size=count))
    return Snapshot(
        draw(ticks),
        box,
        Terrain.of(np.array(cells, dtype=np.int32).reshape(shape)),
        draw(st.dictionaries(positions, contents, max_size=3)),
        draw(st.dictionaries(names, agents, max_size=3)),
        draw(st.dictionaries(whole, dropped, max_size=3)),
    )


@given(frames | edits)
def test_entries_round_trip(entry):
    back = codec.decode_entry(codec.encode_entry(entry))
    assert back == entry
    assert repr(back) == repr(entry)


@given(agents | events | dropped)
def test_single_values_round_trip(value):
    back = codec.decode(codec.encode(value), type(value))
    assert repr(back) == repr(value)


@given(snapshots())
def test_snapshots_round_trip(snapshot):
    back = codec.decode_snapshot(codec.encode_snapshot(snapshot))
    assert back.blocks.dense().dtype == np.int32
    assert not back.blocks.dense().flags.writeable
    assert back.blocks == snapshot.blocks
    for part in ("tick", "box", "containers", "agents", "items"):
        assert repr(getattr(back, part)) == repr(getattr(snapshot, part))


@given(st.lists(frames | edits, max_size=5))
@settings(max_examples=at_night(2000, 30))
def test_joined_entries_are_split_again(entries):
    encoded = codec.split(codec.join(codec.encode_entry(entry) for entry in entries))
    assert [codec.decode_entry(one) for one in encoded] == entries
    assert codec.decode_ticks(encoded) == [entry.tick for entry in entries]


@pytest.mark.parametrize("bits", [1, 0x7FEFFFFFFFFFFFFF, 0x8000000000000000, 0x7FF8DEADBEEF0001])
def test_floats_keep_every_bit(bits):
    value = struct.unpack("<d", struct.pack("<Q", bits))[0]
    back = codec.decode(codec.encode(AgentState((value, 0.0, 0.0))), AgentState)
    assert struct.pack("<d", back.position[0]) == struct.pack("<Q", bits)


@given(frames | edits, st.data())
@settings(max_examples=at_night(2000, 50))
def test_cut_bytes_are_refused(entry, data):
    whole_entry = codec.encode_entry(entry)
    cut = data.draw(st.integers(0, len(whole_entry) - 1))
    with pytest.raises(StoreError):
        codec.decode_entry(whole_entry[:cut])


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"tick": 1.5}, "tick"),
        ({"tick": "1"}, "tick"),
        ({"agents": {"sally": {"position": [0, 1]}}}, "position"),
        ({"agents": {"sally": {"position": [0, 1, True]}}}, "position"),
        ({"blocks": {"0,0,0": 1}}, "blocks"),
        ({"events": [{"kind": "dance", "actor": None}]}, "kind"),
    ],
)
def test_values_of_another_type_are_refused_by_name(change, told):
    body = msgspec.msgpack.encode(["frame", {"tick": 1, **change}])
    with pytest.raises(StoreError, match=told):
        codec.decode_entry(body)


def test_entries_of_an_unknown_sort_are_refused():
    with pytest.raises(StoreError, match="entry"):
        codec.decode_entry(msgspec.msgpack.encode(["dream", {"tick": 1}]))


def test_numpy_numbers_are_stored_as_numbers():
    frame = Frame(
        1, blocks={(0, 0, 0): np.int32(7)}, agents={"a": AgentState((np.float64(0.1),) * 3)}
    )
    back = codec.decode_entry(codec.encode_entry(frame))
    assert back.blocks == {(0, 0, 0): 7}
    assert back.agents["a"].position == (0.1, 0.1, 0.1)
    assert type(back.agents["a"].position[0]) is float


CUT = (9, 7, 30)


@pytest.fixture
def in_chunks(monkeypatch):
    monkeypatch.setattr(terrain, "DENSE", 0)


def cut_snapshot(grid):
    low = (-3, 5, 2)
    box = Box(low, tuple(a + n - 1 for a, n in zip(low, grid.shape, strict=True)))
    return Snapshot(4, box, Terrain.of(grid), {}, {"ann": AgentState((0.5, 6.0, 3.5))})


def random_grid(seed):
    chance = np.random.default_rng(seed)
    grid = chance.choice([0, 0, -1, 7, 20_000], CUT).astype(np.int32)
    grid[:, :, :17] = chance.integers(0, 3)
    return grid


@pytest.mark.usefixtures("in_chunks")
@pytest.mark.parametrize("seed", range(at_night(50, 5)))
def test_snapshots_in_chunks_round_trip(seed):
    grid = random_grid(seed)
    data = codec.encode_snapshot(cut_snapshot(grid))
    back = codec.decode_snapshot(data)
    assert not back.blocks.is_dense
    assert np.array_equal(back.blocks.dense(), grid)
    assert codec.encode_snapshot(back) == data


@pytest.mark.usefixtures("in_chunks")
def test_equal_snapshots_in_chunks_have_equal_bytes():
    grid = random_grid(0)
    draft = Terrain.full(CUT, 3).draft()
    for index in np.ndindex(CUT):
        draft[index] = int(grid[index])
    one = cut_snapshot(grid)
    assert codec.encode_snapshot(replace(one, blocks=draft.terrain())) == codec.encode_snapshot(one)


def test_snapshots_of_large_boxes_are_small(monkeypatch):
    shape = (400, 64, 400)
    draft = Terrain.full(shape, 0).draft()
    draft.fill((0, 0, 0), (400, 5, 400), 1)
    box = Box((0, 0, 0), (399, 63, 399))
    monkeypatch.setattr(Terrain, "dense", None)
    data = codec.encode_snapshot(Snapshot(0, box, draft.terrain(), {}, {}))
    assert len(data) < 10_000
    assert codec.decode_snapshot(data).blocks == draft.terrain()


def test_boxes_of_one_chunk_are_stored_as_before(monkeypatch):
    grid = random_grid(1)
    one = cut_snapshot(grid)
    stored = msgspec.msgpack.decode(codec.encode_snapshot(one))
    assert stored["blocks"] == grid.astype("<i4").tobytes()
    assert "chunks" not in stored
    # Versions that had no chunks stored larger boxes in the same way.
    monkeypatch.setattr(terrain, "DENSE", 0)
    back = codec.decode_snapshot(msgspec.msgpack.encode(stored))
    assert not back.blocks.is_dense
    assert np.array_equal(back.blocks.dense(), grid)


def test_chunks_are_joined_if_the_box_has_become_one_chunk(monkeypatch):
    grid = random_grid(2)
    with monkeypatch.context() as patch:
        patch.setattr(terrain, "DENSE", 0)
        data = codec.encode_snapshot(cut_snapshot(grid))
    back = codec.decode_snapshot(data)
    assert back.blocks.is_dense
    assert np.array_equal(back.blocks.dense(), grid)


@pytest.mark.usefixtures("in_chunks")
def test_damaged_chunks_are_refused():
    good = msgspec.msgpack.decode(codec.encode_snapshot(cut_snapshot(random_grid(3))))
    numbers = np.frombuffer(decompressed(good["blocks"], 2**20), dtype="<i4")

    def packed(changed):
        return compressed(changed.astype("<i4").tobytes(), 3)

    beyond, below = numbers.copy(), numbers.copy()
    beyond[0], below[1] = good["chunks"], -1
    for fault, change in (
        ("do not fill", {"chunks": good["chunks"] + 1}),
        ("do not fill", {"chunks": -1}),
        ("does not fill", {"chunks": 0}),
        ("is cut", {"blocks": good["blocks"][:-3]}),
        ("decompress", {"blocks": b"no frame"}),
        ("do not fill", {"blocks": packed(numbers[:-1])}),
        ("not there", {"blocks": packed(beyond)}),
        ("not there", {"blocks": packed(below)}),
        ("at most", {"high": (30_000_000, 30_000_000, 30_000_000)}),
    ):
        with pytest.raises(StoreError, match=fault):
            codec.decode_snapshot(msgspec.msgpack.encode({**good, **change}))


def test_a_grid_that_does_not_fill_its_box_is_refused():
    box = Box((0, 0, 0), (1, 1, 1))
    with pytest.raises(StoreError, match="does not fill"):
        codec.encode_snapshot(Snapshot(0, box, Terrain.full((1, 2, 2), 0), {}, {}))
    good = msgspec.msgpack.decode(
        codec.encode_snapshot(Snapshot(0, box, Terrain.full((2, 2, 2), 0), {}, {}))
    )
    for blocks in (b"", b"\0" * 31, b"\0" * 36):
        with pytest.raises(StoreError, match="does not fill"):
            codec.decode_snapshot(msgspec.msgpack.encode({**good, "blocks": blocks}))
