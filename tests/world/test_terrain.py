"""Terrains and drafts against dense arrays, for boxes of one chunk and of several."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from beliefnest.world import terrain
from beliefnest.world.terrain import VOLUME, Draft, Terrain

SMALL, LARGE = (20, 4, 20), (41, 50, 45)
LONG = (400, 8, 400)


@given(st.sampled_from([SMALL, LARGE]), st.integers(0, 2**32), st.integers(1, 12))
def test_a_terrain_is_what_a_dense_array_is(shape, seed, edits):
    chance = np.random.default_rng(seed)
    grid = chance.integers(-1, 5, shape).astype(np.int32)
    first = Terrain.of(grid)
    draft, wanted = first.draft(), grid.copy()
    for _ in range(edits):
        low = [int(chance.integers(0, size)) for size in shape]
        high = [int(chance.integers(a, size + 1)) for a, size in zip(low, shape, strict=True)]
        draft.fill(tuple(low), tuple(high), 7)
        wanted[tuple(slice(a, b) for a, b in zip(low, high, strict=True))] = 7
        cell = tuple(int(chance.integers(0, size)) for size in shape)
        draft[cell] = 9
        wanted[cell] = 9
        assert draft[cell] == 9
        assert np.array_equal(draft.terrain().dense(), wanted)
    made = draft.terrain()
    assert np.array_equal(first.dense(), grid)
    assert np.array_equal(made.cut(tuple(low), tuple(high)), wanted[cut(low, high)])
    assert made.states == tuple(np.unique(wanted).tolist())
    assert made.span == (wanted.min(), wanted.max())
    assert np.array_equal(made.find([7, -1]), np.argwhere((wanted == 7) | (wanted == -1)))
    assert np.array_equal(made.differing(first), np.argwhere(wanted != grid))
    both = (wanted != grid) & (wanted >= 0) & (grid >= 0)
    known = made.differing(first, lambda a, b: (a >= 0) & (b >= 0))
    assert np.array_equal(known, np.argwhere(both))
    plain = made.mapped(lambda part: np.maximum(part, 0))
    assert np.array_equal(plain.dense(), np.maximum(wanted, 0))
    assert made == Terrain.of(wanted)
    assert made.key == Terrain.of(wanted).key
    assert (made.key == first.key) is np.array_equal(wanted, grid)
    numbers = chance.integers(0, wanted.size, 50)
    assert np.array_equal(made.at(numbers), wanted.reshape(-1)[numbers])
    assert made.at(numbers[:0]).tolist() == []
    parts = list(made.slabs())
    assert [start for start, _ in parts] == [
        sum(len(part) for _, part in parts[:number]) for number in range(len(parts))
    ]
    assert np.array_equal(np.concatenate([part for _, part in parts]), wanted)
    both = made.joined(first, lambda a, b: np.where(a == 7, b, a + 1))
    assert np.array_equal(both.dense(), np.where(wanted == 7, grid, wanted + 1))
    plain = made.canonical()
    assert plain == made
    assert plain.canonical().rows.tolist() == plain.rows.tolist()
    assert (made == first) is np.array_equal(wanted, grid)


def test_keys_do_not_depend_on_what_lies_outside_the_box(monkeypatch):
    monkeypatch.setattr(terrain, "DENSE", 0)
    # Chunks of `full` are full of the state in the margin, too; those of `of` have zeros there.
    for shape in ((4, 3, 5), (8, 8, 8), (7, 20, 14)):
        filled, cut_up = Terrain.full(shape, 5), Terrain.of(np.full(shape, 5))
        assert not filled.is_dense
        assert filled.key == cut_up.key
        assert filled.key != Terrain.full(shape, 6).key
        assert filled == cut_up


def cut(low, high):
    return tuple(slice(a, b) for a, b in zip(low, high, strict=True))


def test_what_was_handed_out_cannot_be_changed():
    before = Terrain.full(SMALL, 1)
    draft = before.draft()
    draft[0, 0, 0] = 2
    made = draft.terrain()
    for each in (before, made):
        with pytest.raises(ValueError, match="read-only"):
            each.dense()[0, 0, 0] = 3


def set_one(draft: Draft, number: int) -> None:
    draft[3, 4, 5] = number


def set_one_and_show(draft: Draft, number: int) -> None:
    draft[3, 4, 5] = number
    draft.terrain()


def fill_one(draft: Draft, number: int) -> None:
    draft.fill((3, 4, 5), (4, 5, 6), number)


@pytest.mark.parametrize("edit", [set_one, set_one_and_show, fill_one])
def test_chunks_of_many_edits_are_dropped(edit):
    draft = Terrain.full(LONG, 0).draft()
    for number in range(2000):
        edit(draft, number)
    made = draft.terrain()
    assert made[3, 4, 5] == 1999
    assert len(made.chunks) < 600


@pytest.mark.parametrize("dense", [terrain.DENSE, 0], ids=["dense", "chunks"])
@pytest.mark.parametrize("seed", range(5))
def test_borders_are_where_layers_differ(seed, dense, monkeypatch):
    monkeypatch.setattr(terrain, "DENSE", dense)
    generator = np.random.default_rng(seed)
    grid = generator.integers(0, 2, size=(4, 3, 5)).astype(np.int32)
    for axis in range(3):
        grid = grid.repeat(generator.integers(1, 9, size=grid.shape[axis]), axis=axis)
    blocks = Terrain.of(grid)
    for axis, layers in enumerate(blocks.borders):
        along = np.moveaxis(grid, axis, 0)
        differ = [i for i in range(len(along)) if i == 0 or (along[i] != along[i - 1]).any()]
        assert layers.tolist() == differ
    assert np.array_equal(blocks.sampled(blocks.borders), grid[np.ix_(*blocks.borders)])


def test_cubes_that_do_not_fill_a_box_are_refused():
    rows, states = np.zeros(8, dtype=np.int32), np.zeros(VOLUME, dtype=np.int32)
    assert Terrain.of_cubes((9, 9, 9), rows, states) == Terrain.full((9, 9, 9), 0)
    with pytest.raises(ValueError, match="do not fill"):
        Terrain.of_cubes((9, 9, 9), rows[:7], states)
    with pytest.raises(ValueError, match="not there"):
        Terrain.of_cubes((9, 9, 9), rows + 1, states)
