"""`beliefnest items --functional`: certificates of episodes, and questions beside them."""

import json
from collections.abc import Mapping, Sequence
from typing import Any

from rich.table import Table

from beliefnest.cli.console import Printed, print_report, progress_on, result_table
from beliefnest.cli.options import ItemsOptions
from beliefnest.errors import InputError
from beliefnest.files import replace_file, replacing
from beliefnest.plan.jobs import OnStudyProgress
from beliefnest.studies.items.functional.certifying import Certificate, certified
from beliefnest.studies.items.functional.pairing import (
    FUNCTIONAL,
    by_order,
    check_answerer,
    paired,
    plot_pairs,
)
from beliefnest.studies.items.functional.siblings import check_functional, families_of
from beliefnest.studies.study import Study

_RATES = {"rate": "", "pass_at_k": "pass@k", "pass_hat_k": "pass^k"}
"""Headings of rates: of all repeats, of instances with any right, of those with all right."""


def run_functional(options: ItemsOptions) -> int:
    """Certify the families of a study of episodes; return the exit status.

    Returns:
        0 if every family needs the order that it states, else 1.

    Raises:
        BeliefNestError: The study or a task is wrong, or an episode has no result.
    """
    design = check_functional(Study.load(options.study).design, str(options.study))
    families, seeds, jobs = families_of(design), design.seeds, options.jobs
    model, repeats = options.model, design.repeats
    own = {FUNCTIONAL, "functional.png", *(each.folder for each in families)}
    there = {each.name for each in options.folder.glob("*")}
    if others := there - own:
        raise InputError(f"{options.folder} holds other files ({min(others)}); name another folder")
    folder = options.folder
    check_answerer(folder, model)
    with progress_on(options.study.stem) as say:

        def phase(what: str) -> OnStudyProgress:
            return lambda progress: say(what, progress.done, progress.total)

        done, pairs = [], []
        for each in families:
            place, title = folder / each.folder, each.folder
            done.append(certified(each, seeds, place, jobs, phase(f"certificate of {title}")))
            if model is not None:
                asked = phase(f"{model} in {title}")
                pairs.append(paired(each, model, seeds, repeats, place / "model", jobs, asked))
    content: dict[str, Any] = {"certificates": [each.plain() for each in done]}
    report: list[Printed] = [_certificates(done)]
    if pairs:
        rows = [each.plain() for each in (*pairs, *by_order(pairs))]
        content |= {"model": model, "pairs": rows}
        report.append(_pairs(rows))
        with replacing(options.folder / "functional.png") as out:
            plot_pairs(pairs, done).savefig(out, format="png", dpi=150)
    replace_file(options.folder / FUNCTIONAL, json.dumps(content, indent=2) + "\n")
    faults = [
        f"{each.family}, order {each.order}: {fault}" for each in done for fault in each.faults
    ]
    print_report(content, [*report, *faults], as_json=options.json)
    return int(bool(faults))


def _certificates(done: Sequence[Certificate]) -> Table:
    table = result_table(
        "family", "order", "search", "one order less", "bound", "chance rule", "best rule", "ok"
    )
    for each in done:
        best = max(each.rules.items(), key=lambda rule: rule[1][0], default=None)
        table.add_row(
            each.family,
            str(each.order),
            _rate(each.solved),
            "" if each.lower is None else _rate(each.lower),
            "" if each.bound is None else f"{each.bound:.0%}",
            "" if each.chance is None else _rate(each.chance),
            "" if best is None else f"{best[0]} {_rate(best[1])}",
            "NO" if each.faults else "yes",
        )
    return table


def _pairs(rows: Sequence[Mapping[str, Any]]) -> Table:
    kinds = [f"{kind} {of}" for kind in ("literal", "functional") for of in _RATES.values()]
    table = result_table("family", "order", *kinds, "difference", "p")
    for row in rows:
        rates = [f"{row[kind][of]:.0%}" for kind in ("literal", "functional") for of in _RATES]
        name = row["family"] or "all"
        table.add_row(
            name, str(row["order"]), *rates, f"{row['difference']:+.0%}", f"{row['p']:.3f}"
        )
    return table


def _rate(tally: tuple[int, int]) -> str:
    return f"{tally[0]}/{tally[1]}"
