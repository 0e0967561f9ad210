"""The table of a run with several models or repeats: scores by condition and model."""

import statistics
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from rich.table import Table

from beliefnest.cli.console import result_table
from beliefnest.cli.report import cost_text, count_outcomes
from beliefnest.scenarios.judging import unanswered_words
from beliefnest.scenarios.scoring import wilson_interval


@dataclass(frozen=True, slots=True)
class ConditionScore:
    """Score of all repeats of one condition with one model, as reports have it.

    Attributes:
        condition: Number of the condition; None: the scenario has no conditions.
        model: Name of the model.
        passed: Number of repeats in which all expectations held.
        total: Number of repeats in which the model was asked.
        failed: Number of repeats without a result: the model gave no answer, which counts as not
            passed, or was not there.
        outcomes: Number of probes by outcome; a repeat without a result counts as one.
        rate: Share of the repeats that passed; None: the model was never asked.
        interval: 95 % interval of the rate; None: the model was never asked.
        tokens: Tokens sent and received in all repeats.
        cost: US dollars of all repeats; None: not known.
        seconds: Mean wall time of a repeat, in seconds.
    """

    condition: int | None
    model: str
    passed: int
    total: int
    failed: int
    outcomes: Mapping[str, int]
    rate: float | None
    interval: tuple[float, float] | None
    tokens: int
    cost: float | None
    seconds: float


def score_runs(
    runs: Sequence[Mapping[str, Any]], failures: Sequence[Mapping[str, Any]]
) -> list[ConditionScore]:
    """Return the scores of reported runs, ordered by condition, then by first appearance."""
    keys = list(dict.fromkeys((each["condition"], each["model"]) for each in (*runs, *failures)))
    keys.sort(key=lambda key: -1 if key[0] is None else key[0])
    return [
        _score(
            condition,
            model,
            [run for run in runs if (run["condition"], run["model"]) == (condition, model)],
            [f for f in failures if (f["condition"], f["model"]) == (condition, model)],
        )
        for condition, model in keys
    ]


def _score(
    condition: int | None,
    model: str,
    runs: Sequence[Mapping[str, Any]],
    failures: Sequence[Mapping[str, Any]],
) -> ConditionScore:
    used = [run["usage"] for run in runs]
    costs = [usage["cost"] for usage in used]
    unanswered = sum(failure["outcome"] == "no_answer" for failure in failures)
    passed, total = sum(run["ok"] for run in runs), len(runs) + unanswered
    return ConditionScore(
        condition=condition,
        model=model,
        passed=passed,
        total=total,
        failed=len(failures),
        outcomes=count_outcomes(runs, failures),
        rate=passed / total if total else None,
        interval=wilson_interval(passed, total) if total else None,
        tokens=sum(usage["input_tokens"] + usage["output_tokens"] for usage in used),
        cost=None if None in costs else sum(costs),
        seconds=statistics.mean(run["seconds"] for run in runs) if runs else 0.0,
    )


def scores_json(scores: Sequence[ConditionScore]) -> list[dict[str, object]]:
    """Return scores as plain data for the report."""
    return [{**asdict(score), "seconds": round(score.seconds, 3)} for score in scores]


def score_table(name: str, scores: Sequence[ConditionScore]) -> Table:
    """Return a table with one row for each condition and model."""
    words = [unanswered_words(score.outcomes) for score in scores]
    unanswered = ["not answered"] if any(words) else []
    numbers = ("condition", "passed", "rate", "95 % interval", "tokens", "cost", "seconds")
    headings = (*numbers[:1], "model", *numbers[1:4], *unanswered, *numbers[4:])
    table = result_table(*headings, title=name, right=numbers)
    for score, told in zip(scores, words, strict=True):
        low, high = score.interval or (0.0, 1.0)
        table.add_row(
            "-" if score.condition is None else str(score.condition),
            score.model,
            f"{score.passed} of {score.total}",
            "-" if score.rate is None else f"{score.rate:.0%}",
            f"{low:.0%} to {high:.0%}",
            *([told] if any(words) else []),
            f"{score.tokens:,}",
            cost_text(score.cost),
            f"{score.seconds:.2f}",
        )
    return table
