"""`beliefnest stats` and `beliefnest power`: statistics of a study, and of studies to come."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from rich.markup import escape
from rich.table import Table

from beliefnest.cli.console import Printed, print_report, progress_on, result_table
from beliefnest.cli.options import PowerOptions, StatsOptions
from beliefnest.cli.terminal_text import printable
from beliefnest.errors import InputError
from beliefnest.files import os_errors_of, replacing
from beliefnest.scenarios.judging import LOST
from beliefnest.studies.power import power_rows
from beliefnest.studies.power_sources import SIZES
from beliefnest.studies.regression import Effect
from beliefnest.studies.result import StudyResult
from beliefnest.studies.study import Study
from beliefnest.world.words import counted

_Rows = Sequence[Mapping[str, Any]]


def run_stats(options: StatsOptions) -> int:
    """Print the accuracies of a study, and the wanted comparisons, regressions and positions.

    Returns:
        Exit status 0.

    Raises:
        InputError: A column does not exist, or the rows do not allow a statistic.
    """
    result = StudyResult.read(options.study)
    if options.where is not None:
        result = result.where(options.where)
    by = options.by or None
    report: dict[str, Any] = {"summary": result.counted(result.checked(by or result.groups))}
    if options.between:
        report["differences"] = {name: result.compared(name, by) for name in options.between}
    if result.plan.get("unread"):
        report["unread"] = result.plan["unread"]
    fits = _fits(result, options)
    if options.by and fits:
        report["regressions"] = fits
    elif fits:
        (report["regression"],) = fits
    if options.positions:
        report["positions"] = result.counted_positions(result.checked(by or result.position_groups))
    if options.figure is not None:
        _draw(result, options.figure, by)
    parts = [*_parts(report, options.by or list(result.groups))]
    if "unread" in report:
        count = counted(report["unread"], "question")
        parts.append(f"{count} of the data could not be read, and are not counted")
    if options.figure is not None:
        parts.append(f"figure: {options.figure}")
    print_report(report, parts, as_json=options.json)
    return 0


def _draw(result: StudyResult, file: Path, by: list[str] | None) -> None:
    kinds = (".svg", ".pdf", ".png")
    if file.suffix not in kinds:
        raise InputError(f"{file} is no picture; give a name that ends with {', '.join(kinds)}")
    figure = result.plot(by)
    with os_errors_of(file, "written"), replacing(file) as out:
        figure.savefig(out, format=file.suffix[1:])


def _fits(result: StudyResult, options: StatsOptions) -> list[dict[str, Any]]:
    """Return the regression of each group of `--by`, with the group's values."""
    effects: list[Effect] = [
        tuple(each.split(":")) if ":" in each else each for each in options.effect or ()
    ]
    if not effects:
        return []
    fits = result.fits(effects, options.kind, options.family, options.by or ())
    return [{**values, **fitted.plain()} for values, fitted in fits]


def _parts(report: Mapping[str, Any], by: Sequence[str]) -> Iterator[Printed]:
    shown = ["variations", "judged", "right", "accuracy", "low", "high", "interval"]
    if any(group["chance"] is not None for group in report["summary"]):
        shown.append("chance")
    shown += [name for name in LOST if any(group[name] for group in report["summary"])]
    yield from _shown("accuracy, with 95 % intervals", report["summary"], (*by, *shown))
    for column, pairs in report.get("differences", {}).items():
        yield from _shown(f"paired differences of accuracy: {column}", pairs)
    alone = [report["regression"]] if "regression" in report else []
    for regression in report.get("regressions", alone):
        yield from _regression_parts(
            regression, [f"{name} {regression[name]}" for name in by] if not alone else []
        )
    if "positions" in report:
        yield from _shown("options chosen, by position of the right one", report["positions"])


def _regression_parts(fit: Mapping[str, Any], group: Sequence[str]) -> Iterator[Printed]:
    counts = f"{fit['rows']} rows, {counted(fit['variations'], 'variation')}"
    references = ", ".join(f"{name} {level}" for name, level in fit["references"].items())
    within = f" with {', '.join(group)}" if group else ""
    title = f"regression of right answers{within}: {counts}; reference {references}"
    yield from _shown(title, fit["terms"])
    for name in ("correlation", "intercept_sd"):
        if fit.get(name) is not None:
            yield f"{name.replace('_', ' ')}: {fit[name]:.3g}"
    if fit["sound"]:
        yield fit["method"]
        return
    yield from (title, f"not sound, so without coefficients: {fit['note']}")
    other = fit["substitute"]
    if other is not None:
        yield from _shown("in its place", other["terms"])
        yield other["method"]
    yield from _shown("accuracy at each combination of levels, with 95 % intervals", fit["counts"])


def _shown(title: str, rows: _Rows, columns: Sequence[str] | None = None) -> Iterator[Table]:
    """Yield a table of rows; nothing if there are none."""
    if not rows:
        return
    names = {name: name.replace("_", " ") for name in columns or rows[0]}
    numbers = [
        heading
        for name, heading in names.items()
        if all(isinstance(row[name], int | float | None) for row in rows)
    ]
    table = result_table(*names.values(), title=escape(title), right=numbers)
    for row in rows:
        table.add_row(*(_cell(name, row[name]) for name in names))
    yield table


_SHARES = (
    *("accuracy", "low", "high", "difference", "width", "width_90", "coverage"),
    *("difference_width", "power", "chance", "chance_one", "chance_other"),
)


def _cell(name: str, value: object) -> str:
    if value is None:
        return "-"
    if isinstance(value, float):
        return f"{value:.3f}" if name in _SHARES else f"{value:.3g}"
    return escape(printable(str(value)))


def run_power(options: PowerOptions) -> int:
    """Simulate studies of different sizes and print widths of intervals and power.

    Returns:
        Exit status 0.

    Raises:
        BeliefNestError: The study or a number is wrong.
    """
    assumed = {
        "accuracy": options.accuracy,
        "difference": options.difference,
        "correlation": options.correlation,
    }
    values = {name: value for name, value in assumed.items() if value is not None}
    with progress_on("power") as on_progress:
        on_progress("reading the study", 0, 0)
        sources = _sources(options, values)

        def told(done: int, total: int) -> None:
            on_progress("simulating", done, total)

        rows = power_rows(sources, options.size or SIZES, options.simulations, options.seed, told)
    print_report(rows, _power_parts(rows, options.simulations), as_json=options.json)
    return 0


def _power_parts(rows: _Rows, simulations: int) -> Iterator[Printed]:
    for title, measure in (("accuracies", "width"), ("paired differences", "difference_width")):
        own = [row for row in rows if row[measure] is not None]
        yield from _shown(f"{title}, {simulations} simulated studies each", own, _POWER[measure])
    yield from dict.fromkeys(f"{row['of']}: {row['note']}" for row in rows if row["note"])
    yield from _NOTES


_POWER = {
    "width": ("of", "variations", "width", "width_90", "coverage"),
    "difference_width": ("of", "variations", "difference_width", "power"),
}
_NOTES = (
    "width: mean width of the 95 % interval of the accuracy; width 90: nine of ten studies have no "
    "wider one; coverage: share of intervals that contain the true accuracy",
    "difference width: mean width of the 95 % interval of the paired difference; power: share of "
    "studies with p < 0.05",
)


def _sources(options: PowerOptions, values: Mapping[str, float]) -> list[Any]:
    if options.study.is_dir():
        if values:
            name = next(iter(values))
            raise InputError(
                f"--{name} is an assumption, and {options.study} has results to draw from; leave "
                "it out, or give the study's file"
            )
        return StudyResult.read(options.study).power_sources(options.between)
    return Study.load(options.study).power_sources(**values, between=options.between)
