"""Rows that are copies of others: they differ only by a seed on which nothing depends.

Intervals and tests assume independent results. A copy adds no evidence, so that only one of such
rows is counted. The column `copy_of` marks the others.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Any

from beliefnest.plan.cells import digest

if TYPE_CHECKING:
    from beliefnest.studies.study_folder import StudyFolder

_OWN = ("key", "seed", "run")
"""Keys of a cell's file that identify the cell and are no part of its result."""


def rows_with_copies(
    folder: "StudyFolder",
    plan: Mapping[str, Any],
    rows_of: Callable[[Mapping[str, Any], Mapping[str, Any]], Iterable[dict[str, Any]]],
) -> Iterator[dict[str, Any]]:
    """Yield the rows of all planned cells that have been tried, in the order of the plan.

    The `copy_of` of a row names the first of the cells that are `alike`; None: the row is no
    copy. Cells count as copies only if all their results are the same. If results differ, the
    world itself drew random numbers.

    Args:
        folder: Folder of the study.
        plan: Latest plan of the study.
        rows_of: Function that returns the rows of a cell, from its entry in the plan and its file.
    """
    rows: list[dict[str, Any]] = []
    alike: dict[str, dict[str, str]] = {}
    for cell in plan["cells"]:
        content = folder.cell(cell["name"])
        if content is None:
            continue
        if cell["alike"] is not None and content["error"] is None:
            alike.setdefault(cell["alike"], {})[cell["name"]] = _what_came(content)
        rows += rows_of(cell, content)
    first_of = {
        name: next(iter(results))
        for results in alike.values()
        if len(set(results.values())) == 1
        for name in list(results)[1:]
    }
    for row in rows:
        yield {**row, "copy_of": first_of.get(row["cell"])}


def text_of_copies(count: int) -> str:
    """Return the note for readers about the number of copies."""
    return (
        f"{count} rows are copies (column copy_of): they differ from another row only by a seed on "
        "which nothing depends; each row is counted once, without its copies"
    )


def _what_came(content: Mapping[str, Any]) -> str:
    compared = {name: value for name, value in content.items() if name not in _OWN}
    if "measures" in compared:
        seeds = ("seed", "task_seed")
        compared["measures"] = {k: v for k, v in compared["measures"].items() if k not in seeds}
    return digest(compared)
