"""`beliefnest bench`: run benchmarks and print their figures."""

import json
import sys
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from rich import box
from rich.table import Table

from beliefnest.cli.console import folded, progress_on, stdout
from beliefnest.cli.terminal_text import printable
from beliefnest.errors import InputError
from beliefnest_benchmarks.figures import Metric
from beliefnest_benchmarks.registry import checked, measure

__all__ = ["draw_curves", "run_benches"]

_CURVED = "growth"
"""Benchmark that has curves."""


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
        content = {
            name: [{**asdict(each), "ok": each.ok} for each in found]
            for name, found in figures.items()
        }
        sys.stdout.write(json.dumps(content, indent=2) + "\n")
    else:
        stdout().print(folded(_table(figures)))
    return 1 if any(figure.ok is False for found in figures.values() for figure in found) else 0


def draw_curves(names: Sequence[str], folder: Path, *, as_json: bool) -> int:
    """Measure the curves of growth, write each as CSV and SVG, and print the names of the files.

    Args:
        names: Names of benchmarks, as given: `growth` alone.
        folder: Folder for the files; it is made if it does not exist.
        as_json: Print the points as JSON instead.

    Returns:
        Exit status 0.

    Raises:
        InputError: Other benchmarks are named, or the folder or a file cannot be written.
        MissingExtraError: matplotlib is not installed.
        BodyError: A process that measures failed.
    """
    from beliefnest_benchmarks.curve_files import checked_folder, save_curve
    from beliefnest_benchmarks.curves import CURVES, measured_points

    if tuple(checked(names)) != (_CURVED,):
        named = f"not of {', '.join(names)}" if names else "and no bench is named"
        raise InputError(
            f"--curves draws curves of the bench {_CURVED} only, {named}; "
            f"write `beliefnest bench {_CURVED} --curves FOLDER`"
        )
    checked_folder(folder)
    done, total = 0, sum(len(series.calls) for curve in CURVES for series in curve.series)
    found = {}
    with progress_on("bench") as on_progress:

        def say(what: str) -> None:
            nonlocal done
            on_progress(what, done, total)
            done += 1

        for curve in CURVES:
            found[curve.name] = measured_points(curve, say)
            for file in save_curve(curve, found[curve.name], folder):
                if not as_json:
                    stdout().print(printable(str(file)), highlight=False, soft_wrap=True)
    if as_json:
        plain = {name: [point._asdict() for point in points] for name, points in found.items()}
        sys.stdout.write(json.dumps(plain, indent=2) + "\n")
    return 0


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
