"""`beliefnest items`: sets of items, made and made again."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from rich.table import Table

from beliefnest.cli.console import Printed, print_report, progress_on, result_table
from beliefnest.cli.options import ItemsOptions
from beliefnest.errors import InputError
from beliefnest.studies.items.item_set import (
    FIRST_VERSION,
    ItemSet,
    check_folder,
    read_description,
)
from beliefnest.studies.items.parquet import parquet_differences, write_parquet_of
from beliefnest.studies.items.report import report_of
from beliefnest.studies.study import Study
from beliefnest.world.words import counted, listed

_MOST_REASONS = 5


def run_make(options: ItemsOptions) -> int:
    """Make a set of items, and write it; return the exit status.

    Raises:
        BeliefNestError: The study or the folder is wrong, or a script failed.
    """
    names = {"held_out": options.held_out, "version": options.set_version}
    names |= {"changes": options.changes}
    own = {name: value for name, value in names.items() if value is not None}
    version = FIRST_VERSION if options.set_version is None else options.set_version
    check_folder(options.folder, options.held_out or 0.0, version)
    made, scenes, compared, differing = _made(options, {"name": options.study.stem, **own})
    made.write(options.folder)
    if options.parquet:
        write_parquet_of(made, options.folder)
    return _print(options, made, (scenes, compared), differing, "")


def run_verify(options: ItemsOptions) -> int:
    """Make the set of a folder again, and compare it; return the exit status.

    Raises:
        BeliefNestError: The study or the folder is wrong, or a script failed.
    """
    there = read_description(options.folder)
    names = ("name", "held_out", "version", "changes")
    made, scenes, compared, differing = _made(
        options, {name: getattr(there, name) for name in names}
    )
    differing += replace(made, made_with=there.made_with).differences(options.folder)
    differing += parquet_differences(made, options.folder)
    if differing and there.made_with != made.made_with:
        of_set, here = (_versions(each) for each in (there.made_with, made.made_with))
        differing.append(f"made with {of_set}, and again with {here}: that may be the cause")
    public = there.public_only(options.folder)
    part = "; the held-out part is not there, and the rest" if public else ";"
    same = f"{part} made again with the same bytes"
    return _print(options, made, (scenes, compared), differing, same)


def _made(options: ItemsOptions, names: Mapping[str, Any]) -> tuple[ItemSet, int, int, list[str]]:
    """Make a set; return it with what the embedded world says of it."""
    if options.study.is_dir():
        raise InputError(f"{options.study} is a folder; add --models to ask models its items")
    study = Study.load(options.study)
    with progress_on(options.study.stem) as on_progress:
        made = study.items(**names, on_item=on_progress)
        if not options.check_embedded:
            return made, 0, 0, []
        return made, *study.check_items(made, options.check_embedded, on_progress)


def _print(
    options: ItemsOptions,
    made: ItemSet,
    compared: tuple[int, int],
    differing: Sequence[str],
    same: str,
) -> int:
    """Print a set and its differences; return the exit status.

    Args:
        options: Options of the command.
        made: The set.
        compared: Numbers of scenes and of items that were compared with the embedded world.
        differing: Differences.
        same: What to say after its size if there are none; empty: it was not compared.
    """
    unanswerable = sum(each.is_unanswerable for each in made.dropped)
    report = report_of(made.items) if options.report else {}
    summary = {
        "folder": str(options.folder),
        "items": len(made.items),
        "dropped": len(made.dropped),
        "scenes": compared[0],
        "compared": compared[1],
        "differences": differing,
        **({"report": report} if report else {}),
    }
    parts = [*_parts(options, made, summary)]
    if not same or not differing:
        size = ", ".join(f"{counted(len(each), part)}" for part, each in _sizes(made))
        parts.append(f"{options.folder}: {size}{same}")
    print_report(summary, parts, as_json=options.json)
    return int(bool(differing or unanswerable))


def _versions(made_with: Mapping[str, str]) -> str:
    return listed([f"{name} {version}" for name, version in made_with.items()])


def _parts(options: ItemsOptions, made: ItemSet, summary: Mapping[str, Any]) -> Iterator[Printed]:
    differing = summary["differences"]
    if report := summary.get("report"):
        yield from (_counts(report), _positions(report), _shortcuts(report))
    # Those to be mended first, then the most frequent.
    by_reason = Counter(
        (not each.is_unanswerable, f"{each.scenario}, probe {each.probe}: {each.why}")
        for each in made.dropped
    )
    reasons = sorted(by_reason.items(), key=lambda each: (each[0][0], -each[1]))
    for (_, reason), count in reasons[:_MOST_REASONS]:
        yield f"dropped: {counted(count, 'question')} of {reason}"
    if len(reasons) > _MOST_REASONS:
        more = counted(len(reasons) - _MOST_REASONS, "more reason")
        yield f"and {more}; all of them are in dropped.jsonl"
    unanswerable = sum(each.is_unanswerable for each in made.dropped)
    if unanswerable:
        yield (
            f"{counted(unanswerable, 'question')} of {len(made.dropped) + len(made.items)} dropped "
            "for their options; mend these in the scenario"
        )
    yield from differing
    if options.check_embedded:
        items, scenes = counted(summary["compared"], "item"), counted(summary["scenes"], "scene")
        if summary["scenes"] < options.check_embedded:
            scenes = f"all {scenes} of the set ({options.check_embedded} asked for)"
        yield f"compared with the embedded world: {items} of {scenes}"


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
