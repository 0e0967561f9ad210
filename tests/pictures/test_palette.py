"""Agents look the same throughout a run, and never by colour alone."""

import string

from hypothesis import given
from hypothesis import strategies as st

from beliefnest.pictures.palette import AGENT_COLOURS, MARKS, Mark, agent_looks

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
