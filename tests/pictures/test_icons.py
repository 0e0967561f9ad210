"""Icons of items."""

import pytest

from beliefnest.pictures.icons import item
from beliefnest.pictures.marks import Polygon, Rectangle, Text


@pytest.mark.parametrize("gem", ["diamond", "emerald"])
def test_gems_are_cut_stones(gem: str) -> None:
    assert all(isinstance(mark, Polygon) for mark in item((0.0, 0.0), 10.0, gem))


@pytest.mark.parametrize("name", ["bone", "apple", "gold_ingot", "diamond_sword", "diamond_block"])
def test_other_items_are_tiles_with_an_initial(name: str) -> None:
    tile, initial = item((0.0, 0.0), 10.0, name)
    assert isinstance(tile, Rectangle)
    assert isinstance(initial, Text)
    assert initial.text == name[0].upper()


def test_any_item_is_a_tile() -> None:
    (tile,) = item((0.0, 0.0), 10.0, "")
    assert isinstance(tile, Rectangle)
