"""Rows that are copies: the same once more, with another seed on which nothing depends.

Intervals and tests take results for independent. Who plays the very same again has learnt nothing
new; so one of such rows is counted, and the others are told apart from it by `copy_of`.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any

from beliefnest.studies.plan import digest
from beliefnest.studies.store import StudyFolder

__all__ = ["rows_with_copies", "text_of_copies"]

_OWN = ("key", "seed", "run")
"""What a cell's file says of which cell it is, and not of what came of it."""


def rows_with_copies(
    folder: StudyFolder,
    plan: Mapping[str, Any],
    rows_of: Callable[[Mapping[str, Any], Mapping[str, Any]], Iterable[dict[str, Any]]],
) -> Iterator[dict[str, Any]]:
    """Yield the rows of all planned cells that have been tried, in the order of the plan.

    The `copy_of` of a row names the first of the cells that are `alike`; None: it is no copy. All
    of them have to have come to the same in everything: where they have not, the world drew.

    Args:
        folder: Of the study.
        plan: What was planned last.
        rows_of: The rows of a cell, by what the plan says of it and what came of it.
    """
    rows: list[dict[str, Any]] = []
    alike: dict[str, dict[str, str]] = {}
    for cell in plan["cells"]:
        found = folder.cell(cell["name"])
        if found is None:
            continue
        # The plan of an earlier version says nothing of it.
        if cell.get("alike") is not None and found["error"] is None:
            alike.setdefault(cell["alike"], {})[cell["name"]] = _what_came(found)
        rows += rows_of(cell, found)
    first_of = {
        name: next(iter(results))
        for results in alike.values()
        if len(set(results.values())) == 1
        for name in list(results)[1:]
    }
    for row in rows:
        yield {**row, "copy_of": first_of.get(row["cell"])}


def text_of_copies(count: int) -> str:
    """What people are told of so many copies."""
    return (
        f"{count} rows are copies (column copy_of): nothing in them depends on the seed by which "
        "they differ from another row; of each row and its copies one is counted"
    )


def _what_came(found: Mapping[str, Any]) -> str:
    told = {name: value for name, value in found.items() if name not in _OWN}
    if "measures" in told:
        seeds = ("seed", "task_seed")
        told["measures"] = {k: v for k, v in told["measures"].items() if k not in seeds}
    return digest(told)
