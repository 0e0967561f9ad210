"""Outcomes of probes."""

from collections.abc import Mapping, Sequence

from beliefnest.scenarios.expected import Judgement
from beliefnest.worlds.protocol import NO_WAY, ProgramResult

NOT_ANSWERED = ("ambiguous", "unread", "cut", "refused", "no_answer")
"""Outcomes without an answer to judge. Each counts as not right, and reports show how many."""

LOST = (*NOT_ANSWERED, "error")
"""Outcomes without an answer or without a result; reports show each that occurs beside the rate."""

OUTCOMES = ("ok", "wrong", *NOT_ANSWERED, "no_way", "program_failed", "error")
"""Possible outcomes of a probe, a row and a sample, the same everywhere. No rate leaves one out.

`ok`: all expectations hold. `wrong`: the program did or said something else, or the model answered
something else. `ambiguous`: the answer names several options. `unread`: it names none, or has no
program. `cut`: a limit cut it off. `refused`: the model or its provider refused. `no_answer`: no
answer came. `no_way`: the program did none of it, because it could not walk to its target.
`program_failed`: the program did none of it, because it failed for another reason. `error`: the
world or the judging function failed.
"""


def outcome_of(verdicts: Sequence[Judgement], result: ProgramResult | None) -> str:
    """Return the overall outcome of a probe, one of `OUTCOMES`.

    Args:
        verdicts: Judgements of all expectations.
        result: Result of the program; None: there is no program.
    """
    failed = [each for each in verdicts if not each.ok]
    outcomes = [each.outcome for each in failed]
    if result is not None and result.killed:
        return "error"
    for outcome in ("error", *reversed(NOT_ANSWERED), "wrong"):
        if outcome in outcomes:
            return outcome
    if result is not None and result.error is not None and (failed or not verdicts):
        return "no_way" if result.error.reason == NO_WAY else "program_failed"
    return "wrong" if failed else "ok"


def unanswered_words(counts: Mapping[str, int]) -> str:
    """Return the number of results without an answer, such as `2 unread, 1 cut`; empty: none."""
    return ", ".join(
        f"{counts[name]} {name.replace('_', ' ')}" for name in LOST if counts.get(name)
    )


def without_result_words(count: int, total: int, counting: int) -> str:
    """Return how many of all cells have no answer, and how many of these count in rates.

    Args:
        count: Number of cells without an answer.
        total: Number of all cells.
        counting: Number of those that count as not right.
    """
    those = f"{counting} of them " if 0 < counting < count else ""
    how_counted = f"{those}counted as not right" if counting else "counted in no rate"
    return f"{count} of {total} cells have no answer, {how_counted}"
