"""The table of a run with several models or repeats: scores by condition and model."""

import statistics
from collections.abc import Mapping, Sequence
from typing import Any

from rich.table import Table

from beliefnest.cli.console import result_table
from beliefnest.cli.report import cost_text, count_outcomes
from beliefnest.scenarios.judging import unanswered_words
from beliefnest.studies.counting import count_rows
from beliefnest.studies.table import lost

_BY = ("condition", "model")


def score_runs(
    runs: Sequence[Mapping[str, Any]], failures: Sequence[Mapping[str, Any]]
) -> list[dict[str, Any]]:
    """Return the scores of reported runs, ordered by condition, then by first appearance.

    Returns:
        For each condition and model: `passed`, the number of repeats in which all expectations
        held; `total`, the number of those in which the model was asked; `failed`, the number of
        those without a result; `outcomes`, the number of probes by outcome, where a repeat without
        a result counts as one; `rate` and its 95 % `interval`, None if the model was never asked;
        `tokens`; `cost` in US dollars, None if not known; `seconds`, the mean wall time.
    """
    rows = []
    for group in count_rows([*map(_ended, runs), *map(_failed, failures)], _BY):
        own, without = (
            [each for each in some if all(each[name] == group[name] for name in _BY)]
            for some in (runs, failures)
        )
        seconds = statistics.mean(run["seconds"] for run in own) if own else 0.0
        rows.append(
            {
                **{name: group[name] for name in _BY},
                "passed": group["right"],
                "total": group["judged"],
                "failed": len(without),
                "outcomes": count_outcomes(own, without),
                "rate": group["accuracy"],
                "interval": (group["low"], group["high"]) if group["judged"] else None,
                "tokens": group["tokens"],
                "cost": group["cost"],
                "seconds": round(seconds, 3),
            }
        )
    return sorted(rows, key=lambda score: -1 if score["condition"] is None else score["condition"])


def _ended(run: Mapping[str, Any]) -> dict[str, Any]:
    """Return the row of a repeat with a result."""
    usage = run["usage"]
    tokens = usage["input_tokens"] + usage["output_tokens"]
    return {**run, "outcome": "ok", "tokens": tokens, "cost": usage["cost"]}


def _failed(failure: Mapping[str, Any]) -> dict[str, Any]:
    """Return the row of a repeat without a result."""
    return {**failure, **lost(failure, is_judged=True)}


def score_table(name: str, scores: Sequence[Mapping[str, Any]]) -> Table:
    """Return a table with one row for each condition and model."""
    words = [unanswered_words(score["outcomes"]) for score in scores]
    unanswered = ["not answered"] if any(words) else []
    numbers = ("condition", "passed", "rate", "95 % interval", "tokens", "cost", "seconds")
    headings = (*numbers[:1], "model", *numbers[1:4], *unanswered, *numbers[4:])
    table = result_table(*headings, title=name, right=numbers)
    for score, word in zip(scores, words, strict=True):
        low, high = score["interval"] or (0.0, 1.0)
        table.add_row(
            "-" if score["condition"] is None else str(score["condition"]),
            score["model"],
            f"{score['passed']} of {score['total']}",
            "-" if score["rate"] is None else f"{score['rate']:.0%}",
            f"{low:.0%} to {high:.0%}",
            *([word] if any(words) else []),
            f"{score['tokens']:,}",
            cost_text(score["cost"]),
            f"{score['seconds']:.2f}",
        )
    return table
