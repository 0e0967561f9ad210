"""`beliefnest items --functional`: certificates of episodes that need an order of beliefs."""

import json
from collections.abc import Sequence

from rich.table import Table

from beliefnest.cli.console import print_report, result_table
from beliefnest.cli.options import ItemsOptions
from beliefnest.cli.playing import playing
from beliefnest.errors import InputError
from beliefnest.files import replace_file
from beliefnest.studies.items.functional.certifying import (
    Certificate,
    certified,
    chance_of,
    check_functional,
    families_of,
)
from beliefnest.studies.study import Study


def run_functional(options: ItemsOptions) -> int:
    """Certify the families of a study of episodes; return the exit status.

    Returns:
        0 if every family needs the order that it states, else 1.

    Raises:
        BeliefNestError: The study or a task is wrong, or an episode has no result.
    """
    for option in ("report", "verify", "held_out", "set_version", "changes"):
        if getattr(options, option):
            raise InputError(
                f"--{option.replace('_', '-')} is for sets of items; leave out --functional"
            )
    design = check_functional(Study.load(options.study).design, str(options.study))
    with playing(options.study.stem, options.out) as (folder, on_progress):
        done = [
            certified(each, design.seeds, folder / each.folder, options.jobs, on_progress)
            for each in families_of(design)
        ]
    content = {"certificates": [each.plain() for each in done]}
    replace_file(options.out / "certificates.json", json.dumps(content, indent=2) + "\n")
    faults = [
        f"{each.family}, order {each.order}: {fault}" for each in done for fault in each.faults
    ]
    print_report(content, [_table(done), *faults], as_json=options.json)
    return int(bool(faults))


def _table(done: Sequence[Certificate]) -> Table:
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
            "" if best is None else _rate(chance_of(each.rules)),
            "" if best is None else f"{best[0].removeprefix('rule:')} {_rate(best[1])}",
            "NO" if each.faults else "yes",
        )
    return table


def _rate(tally: tuple[int, int]) -> str:
    return f"{tally[0]}/{tally[1]}"
