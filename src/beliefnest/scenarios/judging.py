"""Outcomes of probes."""

from collections.abc import Sequence

from beliefnest.scenarios.expected import Judgement
from beliefnest.worlds.protocol import NO_WAY, ProgramResult

__all__ = ["OUTCOMES", "outcome_of"]

OUTCOMES = ("ok", "wrong", "no_way", "program_failed", "no_answer", "error")
"""Possible outcomes of a probe.

`ok`: all expectations hold. `wrong`: the program did or said something else, or the model answered
something else. `no_way`: the program did none of it, because it could not walk to its target.
`program_failed`: the program did none of it, because it failed for another reason. `no_answer`: the
model gave no program or no answer. `error`: the world or the judging function failed.
"""


def outcome_of(verdicts: Sequence[Judgement], result: ProgramResult | None) -> str:
    """Return the overall outcome of a probe, one of `OUTCOMES`.

    Args:
        verdicts: Judgements of all expectations.
        result: Result of the program; None: there is no program.
    """
    failed = [each for each in verdicts if not each.ok]
    told = [each.outcome for each in failed]
    if result is not None and result.killed:
        return "error"
    for outcome in ("error", "no_answer", "wrong"):
        if outcome in told:
            return outcome
    if result is not None and result.error is not None and (failed or not verdicts):
        return "no_way" if result.error.reason == NO_WAY else "program_failed"
    return "wrong" if failed else "ok"
