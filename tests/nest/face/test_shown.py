"""Nests, simulators, states, reasons and differences as a terminal and a notebook show them."""

from collections.abc import Iterator

import pytest

import beliefnest as bn

CHEST = (3, 1, 3)


@pytest.fixture
def nest() -> Iterator[bn.Nest]:
    """Sally puts a diamond away and goes behind a wall; Anne takes it out."""
    blocks = {(x, 0, z): "stone" for x in range(10) for z in range(10)}
    blocks |= {(x, y, 5): "bricks" for x in range(10) for y in (1, 2, 3)}
    world = bn.ScriptedWorld(
        ((0, 0, 0), (9, 4, 9)),
        blocks,
        {"sally": (2.5, 1, 2.5), "anne": (4.5, 1, 2.5)},
        inventories={"sally": {"diamond": 1}},
        containers={CHEST: {}},
    )
    with bn.Nest(world, static_blocks=["stone", "bricks"]) as nest:
        world.deposit("sally", CHEST, {"diamond": 1})
        world.place_agent("sally", (2.5, 1, 7.5))
        world.withdraw("anne", CHEST, {"diamond": 1})
        yield nest


def test_a_simulator_says_where_it_is_who_is_where_and_what_is_false(nest: bn.Nest) -> None:
    belief = nest["/sally"]
    assert repr(belief) == (
        "<simulator /sally, follow mode, tick 3: anne at (4.5, 1, 2.5), 2 ticks ago; "
        "sally at (2.5, 1, 7.5); (3, 1, 3) 1 diamond; false: (3, 1, 3)>"
    )
    belief.switch("try")
    assert "branch try" in repr(belief)
    assert repr(nest).startswith("<nest of scripted at tick 3, 2 timelines: anne at (4.5, 1, 2.5)")
    assert repr(belief.state).startswith("<state of /sally at tick 3: ")
    assert repr(nest.at(1)["/sally"]).startswith("<simulator /sally, branch try")


def test_a_closed_nest_can_be_printed(nest: bn.Nest) -> None:
    nest.close()
    assert repr(nest).startswith("<nest of scripted")


def test_notebooks_get_drawings_of_what_has_a_place(nest: bn.Nest) -> None:
    past = nest.at(2)
    for shown in (nest, past, nest["/sally"], past["/sally"], nest["/sally"].state):
        assert shown._repr_html_().startswith("<svg")  # type: ignore[attr-defined]


def test_notebooks_get_escaped_text_of_reasons_and_differences(nest: bn.Nest) -> None:
    reasons = nest["/sally"].explain(container=CHEST)
    assert "sally believes that" in reasons._repr_html_()
    assert repr(reasons).startswith("<explanation at tick 3:\nIn reality, the chest")
    found = nest.false_beliefs("/sally")
    assert repr(found) == (
        "<1 difference of / and /sally:\n  container (3, 1, 3): empty in /, 1 diamond in /sally>"
    )
    assert "<td>1 diamond</td>" in found._repr_html_()  # type: ignore[attr-defined]
    assert found == list(found)
    assert repr(nest.compare("/", "/")) == "<0 differences of / and />"
    assert "No differences of / and /." in nest.compare("/", "/")._repr_html_()  # type: ignore[attr-defined]


def test_names_of_others_are_escaped(nest: bn.Nest) -> None:
    nest["/"].switch("<b>&")
    assert "<b>" not in nest.figure("/")._repr_html_()
