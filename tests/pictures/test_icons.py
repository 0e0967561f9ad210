"""Icons of items and agents."""

from pathlib import Path

import pytest

import beliefnest as bn
from beliefnest.pictures.icons import agent, item
from beliefnest.pictures.marks import Circle, Polygon, Rectangle, Text
from beliefnest.pictures.palette import Mark, agent_looks


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


def test_two_hundred_agents_have_readable_letters_and_looks_of_their_own() -> None:
    looks = agent_looks(f"a{number:03}" for number in range(200))
    seen = set()
    for look in looks.values():
        marks = agent((0.0, 0.0), 4.0, look, None, Mark.CURRENT)
        disc, *rings = [mark for mark in marks if isinstance(mark, Circle)]
        said = [mark.text for mark in marks if isinstance(mark, Text)]
        assert said[0] == look.badge
        assert len(rings) <= 2
        assert all(ring.radius > disc.radius / 2 for ring in rings)
        seen.add((look.colour, len(rings), *said[1:]))
    assert len(seen) == 200


def test_sixteen_agents_have_no_numbers() -> None:
    for look in agent_looks(f"a{number:02}" for number in range(16)).values():
        marks = agent((0.0, 0.0), 4.0, look, None, Mark.CURRENT)
        assert len([mark for mark in marks if isinstance(mark, Text)]) == 1


@pytest.mark.parametrize("ending", ["png", "svg", "pdf"])
def test_a_crowd_is_drawn(ending: str, tmp_path: Path) -> None:
    places = {f"a{n:03}": (1.5 + 2 * (n % 15), 1.0, 1.5 + 2 * (n // 15)) for n in range(60)}
    with bn.Nest(bn.ScriptedWorld(box=((0, 0, 0), (31, 3, 31)), agents=places)) as nest:
        nest.figure("/").save(tmp_path / f"crowd.{ending}")
    assert (tmp_path / f"crowd.{ending}").stat().st_size > 0
