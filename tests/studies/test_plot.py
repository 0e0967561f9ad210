"""Figures in which everything has room."""

import itertools

import pytest

from beliefnest.studies.plot import plot_accuracy

LONG = "compatible:a-model-with-a-long-name"
MANY = [f"openai:gpt-{number}" for number in range(14)]


@pytest.mark.parametrize(
    ("conditions", "models"),
    [(["1", "2"], ["offline", LONG, "scripted:answers.json"]), (["2,1,2", "4,1,6"], MANY)],
)
def test_bars_texts_and_the_legend_have_room(conditions: list[str], models: list[str]) -> None:
    groups = [
        {"condition": condition, "model": model, "accuracy": 0.5, "low": 0.2, "high": 0.8}
        for condition, model in itertools.product(conditions, models)
    ]
    figure = plot_accuracy(groups, ["condition", "model"])
    figure.draw_without_rendering()
    (axes,) = figure.axes
    bars, legend = axes.get_window_extent(), axes.get_legend().get_window_extent()
    whole = figure.bbox
    assert bars.width > 2 * figure.dpi
    assert bars.height > 1.5 * figure.dpi
    assert bars.x1 <= legend.x0
    assert legend.x1 <= whole.x1 and legend.y0 >= whole.y0
    texts = [label.get_window_extent() for label in axes.get_xticklabels()]
    assert all(one.x1 < other.x0 for one, other in itertools.pairwise(texts))


def test_long_texts_below_bars_are_turned() -> None:
    groups = [
        {"model": model, "accuracy": 0.5, "low": 0.2, "high": 0.8} for model in (LONG, LONG + "2")
    ]
    (axes,) = plot_accuracy(groups, ["model"]).axes
    assert {label.get_rotation() for label in axes.get_xticklabels()} == {20.0}
    (axes,) = plot_accuracy([{**groups[0], "model": "offline"}], ["model"]).axes
    assert {label.get_rotation() for label in axes.get_xticklabels()} == {0.0}
