"""`beliefnest bench`: run benchmarks and print their figures."""

import json
import sys
from collections.abc import Sequence

from rich import box
from rich.table import Table

from beliefnest.cli.console import folded, progress_on, stdout
from beliefnest_benchmarks.figures import Metric
from beliefnest_benchmarks.registry import checked, measure

__all__ = ["run_benches"]


def run_benches(names: Sequence[str], *, as_json: bool) -> int:
    """Run benchmarks and print their figures.

    Args:
        names: Names of benchmarks; empty: all that need no further installation.
        as_json: Print JSON.

    Returns:
        Exit status: 1 if a target is missed, else 0.

    Raises:
        UnknownNameError: A benchmark does not exist.
    """
    figures: dict[str, Sequence[Metric]] = {}
    chosen = checked(names)
    with progress_on("bench") as on_progress:
        for number, name in enumerate(chosen):
            on_progress(name, number, len(chosen))
            figures[name] = measure(name)
    if as_json:
        content = {name: [_json(figure) for figure in found] for name, found in figures.items()}
        sys.stdout.write(json.dumps(content, indent=2) + "\n")
    else:
        stdout().print(folded(_table(figures)))
    return 1 if any(figure.ok is False for found in figures.values() for figure in found) else 0


def _json(figure: Metric) -> dict[str, object]:
    return {
        "name": figure.name,
        "value": figure.value,
        "unit": figure.unit,
        "target": figure.target,
        "at_least": figure.at_least,
        "ok": figure.ok,
    }


def _table(figures: dict[str, Sequence[Metric]]) -> Table:
    table = Table(box=box.SIMPLE_HEAVY)
    for heading in ("bench", "figure"):
        table.add_column(heading)
    for heading in ("median", "to reach", ""):
        table.add_column(heading, justify="right")
    for name, found in figures.items():
        for figure in found:
            sign = "at least" if figure.at_least else "at most"
            target = "" if figure.target is None else f"{sign} {figure.target:g} {figure.unit}"
            verdict = {True: "ok", False: "MISSED", None: ""}[figure.ok]
            table.add_row(name, figure.name, f"{figure.value:.3g} {figure.unit}", target, verdict)
    return table
