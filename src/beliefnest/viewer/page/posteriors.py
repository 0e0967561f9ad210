"""Posteriors over time as plain values for the page."""

from typing import Any

from beliefnest.minds.charts import heat_of, panels_of
from beliefnest.minds.inference import Inference
from beliefnest.pictures.plan import LEAST_HEAT

__all__ = ["told_inference"]

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
    panels = panels_of(inference)
    ticks = inference.ticks
    gap = -(-len(ticks) // _MOST_PREDICTIONS)
    return {
        "agent": inference.model.agent,
        "steps": steps,
        "ticks": ticks,
        "panels": [
            {
                "title": panel.title,
                "low": panel.low,
                "high": panel.high,
                "stacked": panel.stacked,
                "series": [
                    [name, panel.colours[name], [round(value, 4) for value in values]]
                    for name, values in panel.series.items()
                ],
            }
            for panel in panels
        ],
        "changes": [
            [
                change.tick,
                change.text,
                sorted(
                    (
                        [name, round(bits, 2)]
                        for name, bits in change.bits.items()
                        if bits >= _LEAST_BITS
                    ),
                    key=lambda pair: -pair[1],
                ),
            ]
            for change in inference.explain()
        ],
        "heats": [
            [
                tick,
                [
                    [x, z, round(share, 3)]
                    for (x, z), share in sorted(heat_of(inference, steps, tick).items())
                    if share >= LEAST_HEAT
                ],
            ]
            for tick in ticks[::gap]
        ],
    }
