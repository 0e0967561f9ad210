"""Blocks in messages to and from Node."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from beliefnest.errors import BodyError
from beliefnest.world.values import Box
from beliefnest.worlds.minecraft.node_messages import runs_of, snapshot_of


def message(blocks: bytes) -> dict[str, object]:
    return {"tick": 0, "blocks": blocks, "containers": [], "agents": {}}


@given(arrays(np.int32, (3, 2, 4), elements=st.sampled_from([-1, 0, 1, 26000])))
def test_blocks_come_back_as_they_were_sent(blocks):
    box = Box((0, 0, 0), (2, 1, 3))
    assert np.array_equal(snapshot_of(message(runs_of(blocks)), box).blocks, blocks)


def test_a_large_box_of_one_block_is_a_short_message():
    assert len(runs_of(np.zeros((200, 64, 200), dtype=np.int32))) == 8


def rows(*values: int) -> bytes:
    return np.array(values, dtype="<i4").tobytes()


@pytest.mark.parametrize(
    "runs", [b"", rows(1, 7), rows(1, 9), rows(1, 8, 0), rows(1, 9, 2, -1), b"\x01" * 7]
)
def test_runs_of_another_number_of_blocks_are_a_fault_of_node(runs):
    with pytest.raises(BodyError, match="for a box of 8"):
        snapshot_of(message(runs), Box((0, 0, 0), (1, 1, 1)))
