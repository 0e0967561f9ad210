"""Figures of posteriors: over time, as bars, and as a tint of the cells of a plan."""

import pytest
from tests.minds.lanes import lane, walk
from tests.minds.test_infer import chests
from tests.pictures.measuring import faults, texts

import beliefnest as bn
from beliefnest.minds.charts import bars_of
from beliefnest.pictures.marks import Polygon, Rectangle
from beliefnest.pictures.palette import AGENT_COLOURS, hypothesis_colours
from beliefnest.pictures.plan import heat_colour
from beliefnest.pictures.posterior import PosteriorPanel, posterior_plot
from beliefnest.pictures.time_axis import NotedAct
from beliefnest.viewer.page.posteriors import told_inference

CURRY, SOUP, PASTA = "gold_block", "emerald_block", "diamond_block"


@pytest.fixture(scope="module")
def court() -> tuple[bn.Nest, bn.MindModel]:
    """Bob passes a truck, looks round a wall, and comes back."""
    world = lane(
        5, 3, [(x, 1) for x in range(1, 5)], {(4, 0): CURRY, (4, 2): SOUP}, {"bob": (2, 0)}
    )
    nest = bn.Nest(world)
    walk(world, (1, 0), (0, 0), (0, 1), (0, 2), (0, 1))
    model = bn.MindModel(
        "bob",
        {"curry": {"block": CURRY}, "soup": {"block": SOUP}, "pasta": {"block": PASTA}},
        {"curry": [10], "soup": [0, 20], "pasta": [-20, 0, 20]},
        {"pasta": {"blocks": {(4, 0, 2): PASTA}}, "soup": {"blocks": {(4, 0, 2): SOUP}}},
        bn.simplex_grid(2, 3, 0.1),
        rationality=[0.5, 2],
    )
    return nest, model


@pytest.fixture(scope="module")
def inference(court):
    nest, model = court
    return nest["/"].infer(model)


@pytest.mark.parametrize("size", [None, 85, 50])
def test_nothing_collides_over_time(inference, size) -> None:
    for factors in ((), ("utility.pasta", "credence.soup", "actual")):
        drawing = inference.plot(*factors).drawing(size)
        assert faults(drawing) == []
    words = texts(inference.plot().drawing())
    assert "believed at first: mean credence" in words
    assert f"pasta: {inference.mean('utility.pasta'):.1f}".removesuffix(".0") in words
    assert any(word.startswith("5: moves from (0, 1, 2)") for word in words)
    assert "is the case: probability" not in words, "the observer knows what is the case"


def test_an_observer_in_doubt_is_shown_what_is_probably_the_case(court) -> None:
    nest, model = court
    doubting = bn.MindModel(
        model.agent, model.goals, model.utilities, model.doubt, actual="unknown"
    )
    words = texts(nest["/"].infer(doubting).plot().drawing())
    assert "is the case: probability" in words
    assert "believed at first: mean credence" not in words, "there is one credence"


def test_many_values_and_long_names_keep_apart() -> None:
    ticks = tuple(range(0, 600, 7))
    names = [f"a very long name of an alternative {n}" for n in range(12)]
    shares = {name: tuple(1 / 12 for _ in ticks) for name in names}
    colours = hypothesis_colours(names, ())
    curves = {name: shares[name] for name in names[:8]}
    panels = [
        PosteriorPanel("shares " * 30, 0, 1, ticks, shares, colours, stacked=True),
        PosteriorPanel("curves", -20, 100, ticks, curves, colours),
    ]
    notes = [NotedAct(t, f"moves {t} " * 4) for t in (3, 4, 500)]
    for size in (50, 85, 174):
        assert faults(posterior_plot(panels, 600, notes, "title " * 20).drawing(size)) == []


def test_figures_are_written_and_shown_by_notebooks(inference, tmp_path) -> None:
    figure = inference.plot()
    for ending in ("svg", "png", "pdf"):
        figure.save(tmp_path / f"f.{ending}", size="one column")
        assert (tmp_path / f"f.{ending}").stat().st_size > 1000
    assert figure._repr_html_().startswith("<svg")


@pytest.mark.parametrize("size", [None, 85, 60])
def test_a_figure_has_bars_and_a_tint_of_probable_cells(court, inference, size) -> None:
    nest, _ = court
    figure = nest.figure(tick=3, inference=inference, steps=1)
    drawing = figure.drawing(size)
    assert faults(drawing) == []
    words = texts(drawing)
    assert f"{inference.mean('utility.pasta', 3):.0f}" in words
    assert "inferred from ticks to 3" in words
    assert "where bob will be after 1 action: 1, 10, 50, 100 %" in words
    tints = [mark.fill for mark in drawing.marks if isinstance(mark, Rectangle)]
    for share in inference.predict(1, tick=3)[0].values():
        assert (heat_colour(share) in tints) == (share >= 0.005)


def test_goals_have_the_same_colours_everywhere_and_none_of_an_agent(inference) -> None:
    colours = hypothesis_colours(inference.model.goals, inference.model.alternative_names)
    assert not set(colours.values()) & set(AGENT_COLOURS)
    panels = told_inference(inference, 1)["panels"]
    told = {name: colour for panel in panels for name, colour, _ in panel["series"]}
    groups = bars_of(inference, 3).groups
    bars = {name: group.colours[name] for group in groups for name in group.bars}
    marks = inference.plot("utility").drawing().marks
    lines = {mark.stroke for mark in marks if isinstance(mark, Polygon)}
    for name in ("curry", "soup", "pasta"):
        assert told[name] == bars[name] == colours[name]
        assert colours[name] in lines


def test_the_axis_ends_with_the_last_tick(inference) -> None:
    numbers = [word for word in texts(inference.plot("actual").drawing()) if word.isdigit()]
    assert inference.until == 5
    assert max(map(int, numbers)) == 5


def test_a_later_figure_shows_the_last_posterior(court, inference) -> None:
    nest, _ = court
    early = inference.at(3)
    assert bars_of(early, None) == bars_of(inference, 3)
    words = texts(nest.figure(inference=early).drawing())
    assert "inferred from ticks to 3" in words
    assert texts(nest["/"].figure(inference=early).drawing()) == words


def test_what_cannot_be_plotted_is_named(inference) -> None:
    for name in ("cell", "utility.salad", "wishes"):
        with pytest.raises(bn.InputError, match=f"{name!r} cannot be plotted; there are actual"):
            inference.plot(name)


def test_a_course_that_nothing_explains_is_plotted_up_to_there() -> None:
    world, nest, model = chests()
    walk(world, (1, 0), (0, 0))
    world.withdraw("bob", (0, 1, 1), {"diamond": 1})
    inference = nest["/"].infer(model)
    assert inference.impossible is not None
    for figure in (inference.plot(), nest.figure(inference=inference)):
        assert faults(figure.drawing()) == []
    told = next(word for word in texts(inference.plot().drawing()) if word.startswith("3: "))
    assert told.endswith("which no hypothesis explains")
