"""Scatter plots keep their dots inside, their texts apart, and panels of a row comparable."""

from itertools import pairwise

import pytest
from tests.pictures.measuring import faults, texts

from beliefnest.pictures.marks import Circle
from beliefnest.pictures.scatter import Dot, ScatterPanel, ScatterRow, scatter_figure


def rows(count, scale=1.0):
    points = [
        Dot(scale * (number - 20), 1 + number / 8, "KLM"[number % 3], 0.2) for number in range(45)
    ]
    panels = [
        ScatterPanel(f"desires: model {n}", "r = 0.9", points[: 45 - n]) for n in range(count)
    ]
    return [ScatterRow("model: expected utility", "people: rating", panels)]


@pytest.mark.parametrize("size", [40, "one column", "two columns", 400])
@pytest.mark.parametrize("scale", [1e-6, 0.01, 1, 1e6])
def test_nothing_leaves_the_page_or_lies_on_texts(size, scale):
    drawing = scatter_figure(rows(3, scale), "Model and people").drawing(size)
    assert faults(drawing) == []
    assert {"desires: model 2", "K", "L", "M"} <= set(texts(drawing))


def test_dots_stand_where_their_values_are_and_panels_share_axes():
    drawing = scatter_figure(rows(2), "Model and people").drawing()
    dots = [mark for mark in drawing.marks if isinstance(mark, Circle)]
    first, second = dots[:45], dots[45:89]
    steps = {round(b.x - a.x, 6) for a, b in pairwise(first)}
    assert len(steps) == 1
    assert steps.pop() > 0
    assert all(b.y < a.y for a, b in pairwise(first))
    shifts = {round(b.x - a.x, 6) for a, b in zip(first, second, strict=False)}
    assert len(shifts) == 1


def test_equal_values_have_an_axis():
    panel = ScatterPanel("one", "", [Dot(0.0, 3.0, "K"), Dot(0.0, 3.0, "K")])
    assert faults(scatter_figure([ScatterRow("x", "y", [panel])], "about").drawing()) == []
