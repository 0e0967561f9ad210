"""`beliefnest items`: the questions of a study as a set of benchmark items."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

from rich.table import Table

from beliefnest.cli.console import Printed, print_report, progress_on, result_table
from beliefnest.cli.options import ItemsOptions
from beliefnest.errors import InputError
from beliefnest.studies.items.item_set import ItemSet, check_folder, read_description
from beliefnest.studies.items.parquet import parquet_differences, write_parquet_of
from beliefnest.studies.items.report import report_of
from beliefnest.studies.study import Study
from beliefnest.world.words import counted, listed

_MOST_DROPPED = 5


def run_items(options: ItemsOptions) -> int:
    """Make a set of items, and write it or compare it with its folder; return the exit status.

    Raises:
        BeliefNestError: The study or the folder is wrong, or a script failed.
    """
    if options.models is not None or options.verify_results:
        from beliefnest.cli.item_models import run_models, run_verify_results

        if options.verify_results:
            return run_verify_results(options)
        return run_models(options)
    if options.functional:
        from beliefnest.cli.functional import run_functional

        return run_functional(options)
    if options.model is not None:
        raise InputError("--model answers and plays with --functional; give both, or none")
    if options.study.is_dir():
        raise InputError(f"{options.study} is a folder; add --models to ask models its items")
    set_options = _set_options(options)
    study = Study.load(options.study)
    with progress_on(options.study.stem) as on_progress:
        made = study.items(**set_options, on_item=on_progress)
        compared, differing = study.check_items(made, options.check_embedded, on_progress)
    if options.verify:
        there = read_description(options.folder)
        differing += replace(made, made_with=there.made_with).differences(options.folder)
        differing += parquet_differences(made, options.folder)
        if differing and there.made_with != made.made_with:
            of_set, here = (_versions(each) for each in (there.made_with, made.made_with))
            differing.append(f"made with {of_set}, and again with {here}: that may be the cause")
    else:
        made.write(options.folder)
        if options.parquet:
            write_parquet_of(made, options.folder)
    unanswerable = sum(each.is_unanswerable for each in made.dropped)
    report = report_of(made.items) if options.report else {}
    summary = {
        "folder": str(options.folder),
        "items": len(made.items),
        "dropped": len(made.dropped),
        "compared": compared,
        "differences": differing,
        **({"report": report} if report else {}),
    }
    print_report(summary, _parts(options, made, summary), as_json=options.json)
    return int(bool(differing or unanswerable))


def _versions(made_with: Mapping[str, str]) -> str:
    return listed([f"{name} {version}" for name, version in made_with.items()])


def _set_options(options: ItemsOptions) -> dict[str, Any]:
    """Return name, share, version and changes of the set; with --verify those of the folder."""
    options_of_set = {
        "held_out": options.held_out,
        "version": options.set_version,
        "changes": options.changes,
    }
    if not options.verify:
        own = {name: value for name, value in options_of_set.items() if value is not None}
        check_folder(options.folder, options.held_out or 0.0)
        return {"name": options.study.stem, **own}
    for name, value in options_of_set.items():
        if value is not None:
            option = "set-version" if name == "version" else name.replace("_", "-")
            raise InputError(f"--{option} is for writing a set; --verify reads it from the folder")
    there = read_description(options.folder)
    return {name: getattr(there, name) for name in ("name", *options_of_set)}


def _parts(options: ItemsOptions, made: ItemSet, summary: Mapping[str, Any]) -> Iterator[Printed]:
    differing = summary["differences"]
    if report := summary.get("report"):
        yield from (_counts(report), _positions(report), _shortcuts(report))
    for each in made.dropped[:_MOST_DROPPED]:
        yield f"dropped: {each.scenario}, probe {each.probe}: {each.why}"
    if len(made.dropped) > _MOST_DROPPED:
        yield f"and {len(made.dropped) - _MOST_DROPPED} more; all of them are in dropped.jsonl"
    unanswerable = sum(each.is_unanswerable for each in made.dropped)
    if unanswerable:
        yield (
            f"{counted(unanswerable, 'question')} of {len(made.dropped) + len(made.items)} dropped "
            "for their options; mend these in the scenario"
        )
    yield from differing
    if options.check_embedded:
        yield f"compared with the embedded world: {counted(summary['compared'], 'item')}"
    size = ", ".join(f"{counted(len(each), part)}" for part, each in _sizes(made))
    if not options.verify:
        yield f"{options.folder}: {size}"
    elif not differing:
        public = read_description(options.folder).public_only(options.folder)
        part = "; the held-out part is not there, and the rest" if public else ";"
        yield f"{options.folder}: {size}{part} made again with the same bytes"


def _sizes(made: ItemSet) -> Iterator[tuple[str, tuple[object, ...]]]:
    for part, items in made.parts.items():
        yield "item" if part == "public" else f"{part} item", items
    yield "dropped question", made.dropped


def _counts(report: Mapping[str, Any]) -> Table:
    table = result_table("items by", "", right=["items"])
    for name, counts in report["by"].items():
        table.add_row(name, ", ".join(f"{value}: {n}" for value, n in counts.items()))
    return table


def _positions(report: Mapping[str, Any]) -> Table:
    table = result_table("options", "right at 1, 2, ...", "same text", "skeletons")
    same = counted(len(report["same_text"]), "group")
    skeletons = sum(report["skeletons"].values())
    for options, places in report["positions"].items():
        table.add_row(str(options), " ".join(map(str, places)), same, str(skeletons))
    return table


def _shortcuts(report: Mapping[str, Any]) -> Table:
    table = result_table("shortcut", "items", "answered", "accuracy", "95 %", "chance", "at chance")
    for row in report["shortcuts"]:
        table.add_row(
            row["shortcut"],
            str(row["items"]),
            str(row["answered"]),
            f"{row['accuracy']:.0%}",
            f"{row['low']:.0%} to {row['high']:.0%}",
            f"{row['chance']:.0%}",
            "yes" if row["at_chance"] else "NO",
        )
    return table
