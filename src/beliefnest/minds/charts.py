"""Posteriors as values that `pictures` draws."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from beliefnest.errors import InputError
from beliefnest.pictures.bars import BarChart, BarGroup
from beliefnest.pictures.figure import Figure
from beliefnest.pictures.palette import hypothesis_colours, shades
from beliefnest.pictures.posterior import PosteriorPanel, posterior_plot
from beliefnest.pictures.time_axis import NotedAct

if TYPE_CHECKING:
    from beliefnest.minds.inference import Inference

_MOST_NOTES = 3
_LEAST_BITS = 0.3
_TITLES: Mapping[str, str] = {
    "utility": "wants: mean utility, in steps",
    "credence": "believed at first: mean credence",
    "credence_now": "believes now: mean credence",
    "actual": "is the case: probability",
    "rationality": "rationality: probability",
}


def titles(inference: "Inference") -> dict[str, str]:
    """Return headings by kind of factor, of those kinds that a model leaves open."""
    model = inference.model
    weights = model.actual_weights
    is_open = {
        "utility": True,
        "credence": len(model.credence_rows) > 1,
        "credence_now": model.doubt is not None,
        "actual": model.doubt is not None and weights is not None and 1 not in weights.values(),
        "rationality": len(model.rationalities) > 1,
    }
    return {kind: title for kind, title in _TITLES.items() if is_open[kind]}


def plot_of(inference: "Inference", factors: Sequence[str]) -> Figure:
    """Return the figure of a posterior over time.

    Args:
        inference: The posterior.
        factors: Kinds of factors, or single factors; none: all kinds that the model leaves open.

    Raises:
        InputError: There is no such factor, or it is `cell`.
    """
    panels = panels_of(inference, factors)
    title = f"{inference.model.agent}: inferred goals and beliefs"
    return posterior_plot(panels, inference.until + 1, _notes(inference), title)


def panels_of(inference: "Inference", factors: Sequence[str] = ()) -> list[PosteriorPanel]:
    """Return the panels of `plot_of`; arguments and errors are the same."""
    return [_panel(inference, name) for name in factors or titles(inference)]


def bars_of(inference: "Inference", tick: int | None) -> BarChart:
    """Return the posterior at a tick as bars; None: at the last one."""
    groups = []
    for kind, title in titles(inference).items():
        if kind == "rationality":
            shares = inference.marginal(kind, tick).items()
            bars = {f"{value:g}": share for value, share in shares}
            colours = shades(list(bars))
        else:
            colours = _colours(inference)
            bars = {
                name: inference.mean(factor, tick)
                for factor, (own, name) in inference.parts.items()
                if own == kind
            }
        low, high = _utility_scale(inference) if kind == "utility" else (0.0, 1.0)
        groups.append(BarGroup(title, low, high, bars, colours, is_share=kind != "utility"))
    last = inference.until if tick is None else tick
    return BarChart(inference.model.agent, f"inferred from ticks to {last}", tuple(groups))


def heat_of(inference: "Inference", steps: int, tick: int | None) -> dict[tuple[int, int], float]:
    """Return the probability of each column after some actions, by the posterior at a tick."""
    heat: dict[tuple[int, int], float] = {}
    for (x, _, z), share in inference.predict(steps, tick)[-1].items():
        heat[x, z] = heat.get((x, z), 0.0) + share
    return heat


def _colours(inference: "Inference") -> dict[str, str]:
    """Return the colours of the goals and alternatives of a model."""
    return hypothesis_colours(inference.model.goals, inference.model.alternative_names)


def _utility_scale(inference: "Inference") -> tuple[float, float]:
    """Return the ends of the scale of utilities; 0 is on it."""
    rows = inference.model.utility_rows
    low, high = min(0.0, float(rows.min())), max(0.0, float(rows.max()))
    return low, high if high > low else low + 1


def _panel(inference: "Inference", name: str) -> PosteriorPanel:
    kinds = {kind for kind, _ in inference.parts.values()} - {"cell"}
    if name not in kinds and (name not in inference.factors or name == "cell"):
        plottable = ", ".join([*sorted(kinds), *inference.factors[:-1]])
        raise InputError(f"{name!r} cannot be plotted; there are {plottable}")
    ticks = inference.ticks
    if name not in kinds or name == "rationality":
        shares = [inference.marginal(name, tick) for tick in ticks]
        values = sorted({value for share in shares for value in share})
        series = {f"{v:.3g}": tuple(share.get(v, 0.0) for share in shares) for v in values}
        title = f"{name}: probability of its values"
        return PosteriorPanel(title, 0, 1, ticks, series, shades(list(series)), True, True)
    series = {
        of: tuple(inference.mean(factor, tick) for tick in ticks)
        for factor, (kind, of) in inference.parts.items()
        if kind == name
    }
    is_share = name != "utility"
    low, high = (0.0, 1.0) if is_share else _utility_scale(inference)
    return PosteriorPanel(
        _TITLES[name], low, high, ticks, series, _colours(inference), stacked=is_share
    )


def _notes(inference: "Inference") -> list[NotedAct]:
    """Return the most informative actions, and the impossible one, if any."""
    acts = [
        (max(bits.values()), change)
        for change in inference.explain()
        if change.is_action
        and (bits := {k: v for k, v in change.bits.items() if inference.parts[k][0] != "actual"})
    ]
    most = sorted((each for each in acts if each[0] >= _LEAST_BITS), key=lambda each: -each[0])
    changes = sorted((change for _, change in most[:_MOST_NOTES]), key=lambda each: each.tick)
    notes = [NotedAct(change.tick, f"{change.tick}: {change.text}") for change in changes]
    if (failed := inference.impossible) is not None:
        words = f"{failed.tick}: {failed.text}, which no hypothesis explains"
        notes.append(NotedAct(failed.tick, words))
    return notes
