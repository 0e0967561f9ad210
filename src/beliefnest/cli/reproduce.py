"""`beliefnest reproduce`: play the paper's experiments and compare them with its claims."""

import json
import os
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import msgspec
from msgspec.structs import asdict

from beliefnest.cli.console import print_report, result_table
from beliefnest.cli.playing import playing
from beliefnest.errors import InputError
from beliefnest.files import os_errors_of, replace_file
from beliefnest.studies.study import Study


class _Claim(msgspec.Struct, frozen=True):
    """Claim of the paper about one probe.

    Attributes:
        scenario: Name of the built-in scenario.
        condition: Number of its condition.
        probe: Label of the probe.
        section: Section of the paper.
        text: The paper's statement; for a control variant, what it changes.
        differs: How and why our expectation differs from the paper's; empty: it does not.
        is_control: True for our control variants, about which the paper reports nothing.
    """

    scenario: str
    condition: int
    probe: str
    section: str
    text: str
    differs: str = ""
    is_control: bool = False


_SALLY = ("sally-anne", "Example 1: Sally-Anne Task")
_VAN = ("ice-cream-van", "Example 2: Ice Cream Van Task")
_SEES = "control: John follows the seller and sees him tell Mary"
_STAYS = "control: Mary stays at home and is never told"
_CLAIMS = (
    _Claim(_SALLY[0], 1, "prediction", _SALLY[1], "Sally would open the left box"),
    _Claim(_SALLY[0], 2, "prediction", _SALLY[1], "Sally would open the right box"),
    _Claim(_SALLY[0], 3, "prediction", _SALLY[1], "Sally would open the left box"),
    _Claim(
        _VAN[0],
        1,
        "third order",
        _VAN[1],
        "what John thinks Mary believes: Mary goes to location B",
        "Mary goes to A: as the paper says, John does not know that she was told of B, and what "
        "she was told before is A",
    ),
    _Claim(_VAN[0], 1, "second order", _VAN[1], "what Mary believes: she was told of location B"),
    _Claim(_VAN[0], 1, "reality", _VAN[1], "Mary herself: she was told of location B"),
    *(
        _Claim(_VAN[0], condition, probe, _VAN[1], text, is_control=True)
        for condition, text in ((2, _SEES), (3, _STAYS))
        for probe in ("third order", "second order", "reality")
    ),
)


def run_reproduction(copies: int, jobs: int, page: Path | None, *, as_json: bool) -> int:
    """Play all experiments and print the table.

    Args:
        copies: Number of mirrored, turned and renamed copies of each experiment.
        jobs: Number of cells played in parallel.
        page: Markdown file to write the table to; None: none.
        as_json: Print JSON instead of a table.

    Returns:
        Exit status: 0 if all results are as expected, else 1.

    Raises:
        BeliefNestError: A number is wrong, or a world failed.
    """
    names = tuple(dict.fromkeys(claim.scenario for claim in _CLAIMS))
    studies = Study(names), Study(names, variations=copies) if copies else None
    for study in filter(None, studies):
        # Refuse a wrong path before anything is played.
        study.plan()
    if page is not None and not os.access(page if page.exists() else page.parent, os.W_OK):
        raise InputError(f"{page} cannot be written; name a file in a folder that you can write to")
    written = _played(studies[0], jobs, "as written")
    varied = _played(studies[1], jobs, "copies") if studies[1] is not None else ([], 0.0)
    lines = [_line(claim, written[0], varied[0]) for claim in _CLAIMS]
    rows = [*written[0], *varied[0]]
    right = sum(_is_right(row) for row in rows)
    seconds = written[1] + varied[1]
    about = f"{right} of {len(rows)} probes as expected, all conditions and copies"
    if page is not None:
        _write_page(page, lines, about)
    report = {"claims": lines, "rows": len(rows), "right": right, "seconds": round(seconds, 1)}
    table = result_table(*_HEADINGS)
    for line in lines:
        table.add_row(*_cells(line))
    commands = dict.fromkeys(line["command"] for line in lines)
    print_report(report, [table, *commands, f"{about}, {seconds:.0f} s"], as_json=as_json)
    return 0 if right == len(rows) else 1


def _played(study: Study, jobs: int, title: str) -> tuple[list[dict[str, Any]], float]:
    started = time.perf_counter()
    with playing(title) as (folder, on_progress):
        result = study.run(folder, jobs, on_progress=on_progress)
        took = result.folder.seconds()
        rows = [{**row, "wall_seconds": took[row["cell"]]} for row in result.rows]
    return rows, time.perf_counter() - started


def _line(
    claim: _Claim, written: Sequence[Mapping[str, Any]], varied: Sequence[Mapping[str, Any]]
) -> dict[str, Any]:
    about = (claim.scenario, claim.condition, claim.probe)
    (row,), copies = (
        [row for row in rows if (row["scenario"], row["condition"], row["probe"]) == about]
        for rows in (written, varied)
    )
    place = row["opened"] or _rounded(row["arrived"])
    verb = "opens" if row["opened"] else "arrives at"
    result = f"{row['agent']} {verb} {place}" if place else row["why_not"]
    return {
        **asdict(claim),
        "path": row["path"],
        "expected": _in_words(json.loads(row["expected"])),
        "result": result if row["ok"] else f"{result}: {row['why_not']}",
        "ok": _is_right(row),
        "as_the_paper": None if claim.is_control else _is_right(row) and not claim.differs,
        "copies": len(copies),
        "copies_ok": sum(_is_right(each) for each in copies),
        "seconds": row["wall_seconds"],
        "command": f"beliefnest run {claim.scenario} --condition {claim.condition}",
    }


def _is_right(row: Mapping[str, Any]) -> bool:
    """Return True if a probe and all beliefs of its cell are as expected."""
    return row["ok"] is True and row["beliefs_ok"] is not False


def _in_words(expected: Mapping[str, Any]) -> str:
    """Return the expectations of a probe as text for a table, with places in blocks."""
    return ", ".join(
        f"{part} {','.join(f'{n:g}' for n in value) if isinstance(value, list) else f'{value:g}'}"
        for part, value in expected.items()
    )


def _rounded(place: str) -> str:
    """Return the position of an agent as text, rounded to half a block."""
    return ",".join(f"{round(2 * float(part)) / 2:g}" for part in place.split(",") if part)


_HEADINGS = (
    *("section of the paper", "belief asked", "the paper's claim, or what a control changes"),
    *("expected", "our result", "copies as expected", "run time", "where we differ"),
)


def _cells(line: Mapping[str, Any]) -> tuple[str, ...]:
    return (
        f"{line['section']}, condition {line['condition']}",
        line["path"],
        line["text"],
        line["expected"],
        line["result"] if line["ok"] else f"NO: {line['result']}",
        f"{line['copies_ok']} of {line['copies']}",
        f"{line['seconds']:.1f} s",
        line["differs"],
    )


def _write_page(page: Path, lines: Sequence[Mapping[str, Any]], about: str) -> None:
    headings = (*_HEADINGS, "command")
    rows = [(*_cells(line), f"`{line['command']}`") for line in lines]
    table = [headings, tuple("---" for _ in headings), *rows]
    text = "\n".join(f"| {' | '.join(row)} |" for row in table)
    content = (
        "# Reproduction\n\nWritten by `beliefnest reproduce --page docs/reproduction.md`, with the "
        "offline model. Copies are mirrored, turned and renamed.\n\n"
        f"{text}\n\n{about}.\n"
    )
    with os_errors_of(page, "written"):
        replace_file(page, content)
