"""Blocks in messages to and from Node."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from beliefnest.errors import BodyError
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import Box
from beliefnest.worlds.minecraft.node_messages import blocks_message, runs_of, snapshot_of


def message(blocks: bytes) -> dict[str, object]:
    return {"tick": 0, "blocks": blocks, "containers": [], "agents": {}}


@given(arrays(np.int32, (3, 2, 4), elements=st.sampled_from([-1, 0, 1, 26000])))
def test_blocks_come_back_as_they_were_sent(blocks):
    box = Box((0, 0, 0), (2, 1, 3))
    assert np.array_equal(snapshot_of(message(runs_of(blocks)), box).blocks, blocks)


def test_a_large_box_of_one_block_is_a_short_message():
    assert len(runs_of(np.zeros((200, 64, 200), dtype=np.int32))) == 8


def test_a_box_costs_in_a_message_what_it_contains():
    plain = Terrain.full((1000, 100, 1000), 0).draft()
    plain.fill((0, 0, 0), (1000, 1, 1000), 1)
    plain[500, 7, 500] = 26000
    told = blocks_message(plain.terrain(), (-500, -60, 0))
    assert told["first"] == [-501, -61, -1]
    assert told["counts"] == (126, 13, 126)
    numbers, counts = np.frombuffer(told["rows"], dtype="<i4").reshape(-1, 2).T
    assert counts.sum() == 126 * 13 * 126
    states = np.frombuffer(told["states"], dtype="<i4").reshape(-1, 2)[:, 1].sum()
    assert states == (numbers.max() + 1) * told["side"] ** 3
    assert len(told["rows"]) + len(told["states"]) < 600_000


@given(
    st.sampled_from([(3, 2, 4), (41, 41, 41)]),
    st.lists(
        st.tuples(st.integers(0, 2), st.integers(0, 1), st.integers(0, 3), st.integers(0, 9)),
        max_size=8,
    ),
)
def test_changes_are_applied_to_the_blocks_before(shape, changed):
    low = (-7, 3, 100)
    box = Box(low, tuple(a + b - 1 for a, b in zip(low, shape, strict=True)))
    before = Terrain.full(shape, 2)
    rows = [[x - 7, y + 3, z + 100, state] for x, y, z, state in changed]
    told = {"tick": 0, "changes": rows, "containers": [], "agents": {}}
    blocks = np.full(shape, 2)
    for x, y, z, state in changed:
        blocks[x, y, z] = state
    assert np.array_equal(snapshot_of(told, box, before).blocks, blocks)
    assert before == Terrain.full(shape, 2)


@pytest.mark.parametrize("row", [[2, 0, 0, 1], [0, -1, 0, 1]])
def test_a_change_outside_the_box_is_a_fault_of_node(row):
    box = Box((0, 0, 0), (1, 1, 1))
    told = {"tick": 0, "changes": [row], "containers": [], "agents": {}}
    with pytest.raises(BodyError, match="outside the box"):
        snapshot_of(told, box, Terrain.full((2, 2, 2), 0))


def test_changes_of_nothing_are_a_fault_of_node():
    told = {"tick": 0, "changes": [], "containers": [], "agents": {}}
    with pytest.raises(BodyError, match="all blocks"):
        snapshot_of(told, Box((0, 0, 0), (1, 1, 1)))


def rows(*values: int) -> bytes:
    return np.array(values, dtype="<i4").tobytes()


@pytest.mark.parametrize(
    "runs", [b"", rows(1, 7), rows(1, 9), rows(1, 8, 0), rows(1, 9, 2, -1), b"\x01" * 7]
)
def test_runs_of_another_number_of_blocks_are_a_fault_of_node(runs):
    with pytest.raises(BodyError, match="needs 8"):
        snapshot_of(message(runs), Box((0, 0, 0), (1, 1, 1)))
