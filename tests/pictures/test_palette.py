"""Agents look the same throughout a run, and never by colour alone."""

import itertools
import math
import string

import pytest
from hypothesis import given
from hypothesis import strategies as st

from beliefnest.pictures.palette import (
    AGENT_COLOURS,
    MARKS,
    PAPER,
    Mark,
    agent_looks,
    colours_of,
    mix,
)

NAMES = st.text(string.ascii_letters + string.digits + "_", min_size=1, max_size=16)


@given(st.lists(NAMES, min_size=1, max_size=30, unique=True))
def test_every_agent_has_a_badge_or_a_look_of_its_own(names: list[str]) -> None:
    looks = agent_looks(names)
    assert len({(look.colour, look.rings) for look in looks.values()}) == len(names)
    assert all(1 <= len(look.badge) <= 3 for look in looks.values())
    assert agent_looks(reversed(names)) == looks


def test_badges_are_no_longer_than_they_must_be() -> None:
    looks = agent_looks(["sally", "seller", "anne", "a_very_long_name", "a_very_long_naim"])
    badges = {name: look.badge for name, look in looks.items()}
    assert badges["sally"] == "Sa"
    assert badges["seller"] == "Se"
    assert badges["anne"] == "An"
    assert badges["a_very_long_name"] == "A2"
    assert badges["a_very_long_naim"] == "A1"


def test_falsehood_has_a_colour_that_no_agent_has_and_every_mark_a_sign() -> None:
    assert MARKS[Mark.FALSE].colour not in AGENT_COLOURS
    signs = [look.sign for look in MARKS.values()]
    assert len(set(signs)) == len(signs)
    assert len({look.words for look in MARKS.values()}) == len(MARKS)


def test_colours_do_not_contradict_colour_words() -> None:
    boxes = ["in the chest", "in the blue box", "in the green box", "red_wool", "Red"]
    colours = colours_of([*boxes, "1 red_wool, 1 blue_wool", "Greene"])
    assert colours["in the blue box"] == "#0072B2"
    assert colours["in the green box"] == "#009E73"
    assert colours["red_wool"] == colours["Red"]
    others = [colours["in the chest"], colours["1 red_wool, 1 blue_wool"], colours["Greene"]]
    assert len({*others, *colours.values()}) == 6
    looks = agent_looks(["blue", "green", "yellow"])
    assert [look.colour for look in looks.values()] == ["#0072B2", "#009E73", "#F0E442"]


# Severity 1.0, of Machado, Oliveira and Fernandes (2009), on linear light.
DICHROMACIES = {
    "protanopia": ((0.152, 1.053, -0.205), (0.115, 0.786, 0.099), (-0.004, -0.048, 1.052)),
    "deuteranopia": ((0.367, 0.861, -0.228), (0.280, 0.673, 0.047), (-0.012, 0.043, 0.969)),
    "tritanopia": ((1.256, -0.077, -0.179), (-0.078, 0.931, 0.148), (0.005, 0.691, 0.304)),
}


@pytest.mark.parametrize("eyes", DICHROMACIES)
def test_fills_of_colour_words_are_told_apart_by_eyes_of_every_kind(eyes: str) -> None:
    named = ("blue", "orange", "green", "purple", "light blue", "yellow", "gray", "red", "brown")
    fills = [mix(PAPER, colour, 0.45) for colour in colours_of(named).values()]
    seen = [_seen(fill, DICHROMACIES[eyes]) for fill in fills]
    assert min(math.dist(a, b) for a, b in itertools.combinations(seen, 2)) > 0.02


def _seen(colour: str, matrix: tuple[tuple[float, ...], ...]) -> tuple[float, ...]:
    light = [(part / 255) ** 2.2 for part in bytes.fromhex(colour[1:])]
    return tuple(
        max(0.0, sum(a * b for a, b in zip(row, light, strict=True))) ** (1 / 2.2) for row in matrix
    )
