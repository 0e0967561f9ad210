"""Figures in which everything has room."""

import itertools

import pytest

from beliefnest.studies.accuracy_figure import plot_accuracy, with_short_names

pytestmark = pytest.mark.extra("matplotlib")

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


def test_long_texts_below_bars_are_broken_into_lines() -> None:
    for model, broken in ((LONG + "2", True), ("offline", False)):
        shown = [
            {"model": name, "accuracy": 0.5, "low": 0.2, "high": 0.8}
            for name in ("a" + model, model)
        ]
        figure = plot_accuracy(shown, ["model"])
        figure.draw_without_rendering()
        texts = [label.get_text() for label in figure.axes[0].get_xticklabels()]
        assert all(("\n" in text) is broken for text in texts)
        assert [text.replace("\n", "") for text in texts] == ["a" + model, model]


CONDITIONS = ["false belief", "true belief", "second-order", "control"]


@pytest.mark.parametrize("resized", [False, True])
@pytest.mark.parametrize(
    ("along", "models"),
    [
        (CONDITIONS, ["offline", "openai:gpt-5-mini", "anthropic:claude-sonnet"]),
        (["openai:gpt-5-mini-2026", "anthropic:claude-sonnet", LONG], ["offline"]),
        ([f"condition-{number}" for number in range(12)], ["offline", "openai:gpt-5-mini"]),
    ],
)
def test_texts_have_room_in_a_column_of_a_paper(
    along: list[str], models: list[str], resized: bool
) -> None:
    groups = [
        {"condition": condition, "model": model, "accuracy": 0.5, "low": 0.2, "high": 0.8}
        for condition, model in itertools.product(along, models)
    ]
    if resized:
        figure = plot_accuracy(groups, ["condition", "model"])
        figure.set_size_inches(85 / 25.4, 70 / 25.4)
    else:
        figure = plot_accuracy(groups, ["condition", "model"], (85, 70))
    assert figure.get_size_inches() * 25.4 == pytest.approx((85, 70))
    figure.draw_without_rendering()
    (axes,) = figure.axes
    texts = [label.get_window_extent() for label in axes.get_xticklabels()]
    turned = any(label.get_rotation() for label in axes.get_xticklabels())
    for one, other in itertools.pairwise(texts):
        # Of turned texts the boxes overlap, and not the parallel lines.
        assert other.x1 - one.x1 > 7 / 72 * figure.dpi if turned else one.x1 < other.x0
    heading = axes.yaxis.label.get_window_extent()
    parts = [*texts, heading, axes.xaxis.label.get_window_extent()]
    if axes.get_legend() is not None:
        parts.append(axes.get_legend().get_window_extent())
    assert not any(heading.overlaps(text) for text in texts)
    whole = figure.bbox
    for part in parts:
        assert whole.x0 <= part.x0 and part.x1 <= whole.x1
        assert whole.y0 <= part.y0 and part.y1 <= whole.y1
    assert axes.get_window_extent().height > 0.3 * whole.height


def lines_at_chance(figure):
    (axes,) = figure.axes
    drawn = [each for each in axes.collections if each.get_gid() == "chance"]
    return [float(path[0][1]) for each in drawn for path in each.get_segments()]


def test_the_chance_level_of_choices_is_a_line():
    groups = [
        {"condition": n, "accuracy": 0.5, "low": 0.2, "high": 0.8, "chance": level}
        for n, level in enumerate((0.5, 0.5, 0.25, None))
    ]
    assert lines_at_chance(plot_accuracy(groups[:2], ["condition"])) == [0.5]
    assert lines_at_chance(plot_accuracy(groups, ["condition"])) == [0.5, 0.5, 0.25]
    assert lines_at_chance(plot_accuracy(groups[3:], ["condition"])) == []
    # No line crosses a bar that has no chance level.
    between = [groups[0], groups[3], groups[1]]
    assert lines_at_chance(plot_accuracy(between, ["condition"])) == [0.5, 0.5]


def test_models_have_the_shortest_names_that_tell_them_apart():
    names = ["openai:gpt-5-mini", "a:org/mini", "b:mini", "offline", "local:/models/q4.gguf"]
    shown = with_short_names([{"model": name} for name in names])
    assert [each["model"] for each in shown] == [
        "gpt-5-mini", "a:org/mini", "b:mini", "offline", "q4.gguf",
    ]  # fmt: skip
