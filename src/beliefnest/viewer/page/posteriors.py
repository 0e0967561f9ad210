"""Posteriors over time as plain values for the page."""

from typing import Any

from beliefnest.minds.charts import heat_of, panels_of
from beliefnest.minds.findings import EvidenceEffect
from beliefnest.minds.inference import Inference
from beliefnest.pictures.plan import LEAST_HEAT
from beliefnest.pictures.posterior import PosteriorPanel

_MOST_PREDICTIONS = 60
"""Ticks with a prediction; each follows the course once more from its beginning."""

_LEAST_BITS = 0.005


def told_inference(inference: Inference, steps: int) -> dict[str, Any]:
    """Return a posterior for the page.

    Args:
        inference: The posterior.
        steps: After how many actions places are predicted.

    Returns:
        `agent`, `steps`, `ticks`, `panels` (each with `title`, `low`, `high`, `stacked` and
        `series`: name, colour and values by tick), `changes` (tick, text, factors with bits) and
        `heats` (tick, rows of x, z and probability); a tick without one shows the one before.

    Raises:
        InputError: steps is below 1.
    """
    return {
        "agent": inference.model.agent,
        "steps": steps,
        "ticks": inference.ticks,
        "panels": [_told_panel(panel) for panel in panels_of(inference)],
        "changes": [_told_change(change) for change in inference.explain()],
        "heats": _heats(inference, steps),
    }


def _told_panel(panel: PosteriorPanel) -> dict[str, Any]:
    return {
        "title": panel.title,
        "low": panel.low,
        "high": panel.high,
        "stacked": panel.stacked,
        "series": [
            [name, panel.colours[name], [round(value, 4) for value in values]]
            for name, values in panel.series.items()
        ],
    }


def _told_change(change: EvidenceEffect) -> list[Any]:
    factors = [[name, round(b, 2)] for name, b in change.bits.items() if b >= _LEAST_BITS]
    return [change.tick, change.text, sorted(factors, key=lambda pair: -pair[1])]


def _heats(inference: Inference, steps: int) -> list[list[Any]]:
    gap = -(-len(inference.ticks) // _MOST_PREDICTIONS)
    return [
        [
            tick,
            [
                [x, z, round(share, 3)]
                for (x, z), share in sorted(heat_of(inference, steps, tick).items())
                if share >= LEAST_HEAT
            ],
        ]
        for tick in inference.ticks[::gap]
    ]
