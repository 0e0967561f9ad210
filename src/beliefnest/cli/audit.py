"""`beliefnest suite audit`: labels of a published set that do not follow from their stories."""

from collections.abc import Iterator, Sequence
from typing import Any

from msgspec.structs import asdict

from beliefnest.cli.console import Printed, print_report, progress_on, result_table
from beliefnest.cli.options import SuiteOptions
from beliefnest.errors import InputError
from beliefnest.suites.stories.audit import Audit, Finding, audit, read_published
from beliefnest.world.words import counted

_FOR_SUITES = {
    "rows": None,
    "limit": None,
    "claims_from": None,
    "out": None,
    "strict": False,
    "world": "scripted",
    "seed": 0,
}
"""Options that an audit does not have, with their defaults."""


def run_audit(options: SuiteOptions) -> int:
    """Audit a file; return the exit status: 0 if all of it was read and every label follows.

    Raises:
        BeliefNestError: The file cannot be read, or an option is for suites.
    """
    for name, default in _FOR_SUITES.items():
        if getattr(options, name) != default:
            raise InputError(f"--{name.replace('_', '-')} is for suites; leave it out of an audit")
    published = read_published(options.path)
    with progress_on("audit") as on_progress:
        done = audit(published, on_progress)
    if not done.items and not done.unread:
        raise InputError(f"{options.path} holds no rows; there is nothing to audit")
    print_report(_json(done), _parts(done), as_json=options.json)
    return 1 if done.wrong or done.undetermined or done.unread else 0


def _json(done: Audit) -> dict[str, Any]:
    return {
        "items": done.items,
        "wrong": [asdict(each) for each in done.wrong],
        "undetermined": [asdict(each) for each in done.undetermined],
        "unread": [
            {"where": each.where, "faults": list(each.faults), "items": each.questions}
            for each in done.unread
        ],
    }


def _parts(done: Audit) -> Iterator[Printed]:
    for title, findings in (("wrong", done.wrong), ("undetermined", done.undetermined)):
        if findings:
            yield title
            yield from _table(findings)
    yield from (line for each in done.unread for line in each.lines)
    unread = sum(each.questions for each in done.unread)
    yield (
        f"{counted(done.items, 'item')} answered: {len(done.wrong)} wrong, "
        f"{len(done.undetermined)} undetermined; {unread} could not be read"
    )


def _table(findings: Sequence[Finding]) -> Iterator[Printed]:
    table = result_table("row", "question", "label", "answer", "right if")
    for each in findings:
        answer = "unknown" if each.answer is None else each.answer
        label = "unknown" if each.label is None else each.label
        table.add_row(str(each.row), each.question, label, answer, each.assumption or "")
    yield table
    yield from (f"row {each.row}: {each.why[0]}" for each in findings if each.why)
