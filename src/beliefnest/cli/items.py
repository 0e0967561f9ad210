"""`beliefnest items`: the use of the command that options choose."""

from collections.abc import Callable

import msgspec
from msgspec.structs import fields

from beliefnest.cli.functional import run_functional
from beliefnest.cli.item_models import run_models, run_verify_results
from beliefnest.cli.item_sets import run_make, run_verify
from beliefnest.cli.options import ItemsOptions
from beliefnest.errors import InputError


class ItemsUse(msgspec.Struct, frozen=True):
    """Use of the command.

    Attributes:
        chosen_by: Option that chooses it; empty: no other use is chosen.
        line: Its command line.
        run: Function that returns the exit status.
        takes: Further options that it takes.
    """

    chosen_by: str
    line: str
    run: Callable[[ItemsOptions], int]
    takes: tuple[str, ...]


_ALWAYS = ("study", "json")
_USES = (
    ItemsUse(
        "models",
        "SET --models A,B -o DIR",
        run_models,
        ("out", "people", "gap", "max_tokens", "max_cost", "jobs"),
    ),
    ItemsUse("verify_results", "SET --verify-results FILE", run_verify_results, ()),
    ItemsUse("functional", "STUDY -o DIR --functional", run_functional, ("out", "model", "jobs")),
    ItemsUse("verify", "STUDY -o SET --verify", run_verify, ("out", "report", "check_embedded")),
    ItemsUse(
        "",
        "STUDY -o SET",
        run_make,
        ("out", "report", "parquet", "check_embedded", "held_out", "set_version", "changes"),
    ),
)


def run_items(options: ItemsOptions) -> int:
    """Run the use that the options choose; return the exit status.

    Raises:
        InputError: An option belongs to another use.
        BeliefNestError: See the functions of uses.
    """
    names = [each.name for each in fields(options) if getattr(options, each.name) != each.default]
    use = next(each for each in _USES if not each.chosen_by or each.chosen_by in names)
    for name in names:
        if name not in (*_ALWAYS, use.chosen_by, *use.takes):
            others = [each.line for each in _USES if name in (each.chosen_by, *each.takes)]
            raise InputError(
                f"{_option(name)} belongs to {' or '.join(map(_command, others))}, and this is "
                f"{_command(use.line)}; leave it out, or write the other"
            )
    if not options.study.exists():
        raise InputError(f"there is no file or folder {options.study}; check its name")
    return use.run(options)


def _command(line: str) -> str:
    return f"`beliefnest items {line}`"


def _option(name: str) -> str:
    return f"--{name.replace('_', '-')}"
