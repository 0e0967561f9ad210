"""`beliefnest search-items`: what makes items of a study hard for a model."""

from collections.abc import Iterator, Sequence

from rich.table import Table

from beliefnest.cli.console import Printed, print_report, progress_on, result_table
from beliefnest.cli.options import SearchItemsOptions
from beliefnest.cli.playing import write_tables
from beliefnest.plan.jobs import StudyProgress
from beliefnest.studies.items.search_folder import SearchReport, search_items
from beliefnest.studies.items.searching import JudgedContrast
from beliefnest.studies.result import StudyResult
from beliefnest.studies.study import Study
from beliefnest.world.words import counted


def run_search(options: SearchItemsOptions) -> None:
    """Search, and print what was found.

    Raises:
        BeliefNestError: The study or the folder is wrong, or a model cannot be asked.
    """
    with progress_on(options.study.stem) as on_progress:

        def show(progress: StudyProgress) -> None:
            cost = f"asking, {progress.spent.cost or 0.0:.2f} US dollars"
            on_progress(cost, progress.done, max(options.budget, progress.total))

        report = search_items(
            Study.load(options.study).item_space(),
            options.out,
            options.model,
            options.budget,
            seed=options.seed,
            transfer=options.transfer,
            max_cost=options.max_cost,
            jobs=options.jobs,
            on_progress=show,
        )
    write_tables(StudyResult.read(options.out))
    summary = {"folder": str(options.out), **report.plain()}
    print_report(summary, _parts(options, report), as_json=options.json)


def _parts(options: SearchItemsOptions, report: SearchReport) -> Iterator[Printed]:
    for model, tests in report.tests.items():
        if tests:
            yield _table(model, tests)
        weak = [each.contrast.text for each in tests if each.is_weakness]
        yield f"{model}: {'; '.join(weak) or 'no weakness found'}"
    size = f"{counted(len(report.tests[report.model]), 'contrast')} of {report.contrasts} tested"
    cost = f"{report.usage.tokens:,} tokens, {report.usage.cost or 0.0:.2f} US dollars"
    yield f"{options.out}: {counted(report.asked, 'question')}, {size}; whole folder: {cost}"


def _table(model: str, tests: Sequence[JudgedContrast]) -> Table:
    table = result_table(
        *("hard", "pairs", "right", "twins right", "difference", "95 %", "p (Holm)", "weakness"),
        title=f"{model}, fresh items",
    )
    for row in (each.plain() | {"text": each.contrast.text} for each in tests):
        table.add_row(
            row["text"],
            str(row["pairs"]),
            str(row["right_hard"]),
            str(row["right_easy"]),
            f"{row['difference']:+.0%}",
            f"{row['low']:+.0%} to {row['high']:+.0%}",
            f"{row['p_corrected']:.3g}",
            "YES" if row["weakness"] else "no",
        )
    return table
