"""Outcomes as plain values, for `--json` and for the files of runs and studies."""

import math
from dataclasses import asdict
from pathlib import Path

import msgspec

from beliefnest.scenarios.expected import expected_json
from beliefnest.scenarios.outcome import ExpectationOutcome, ProbeOutcome, Reply
from beliefnest.world.values import Placements, Point


def expectation_json(outcome: ExpectationOutcome) -> dict[str, object]:
    """Return the outcome of an expectation as plain values."""
    return {**outcome.expectation.written(), "ok": outcome.ok, "why_not": outcome.why_not or ""}


def placed_json(placed: Placements) -> dict[str, object]:
    """Return what a body had to place otherwise than believed; positions are texts `x,y,z`."""
    return {
        key if isinstance(key, str) else ",".join(map(str, key)): [_plain(start), _plain(end)]
        for key, (start, end) in placed.items()
    }


def _plain(place: Point | str | None) -> object:
    return list(place) if isinstance(place, tuple) else place


def probe_json(outcome: ProbeOutcome, run_dir: Path | str) -> dict[str, object]:
    """Return the outcome of a probe as plain values.

    Args:
        outcome: Outcome of the probe.
        run_dir: Folder of the recorded run.
    """
    probe, trial = outcome.probe, outcome.trial
    result = None if trial is None else trial.result
    inferred = outcome.inferred
    evidence = -math.inf if inferred is None else inferred.log_evidence
    return {
        "label": probe.label,
        "path": probe.path,
        "acts_in": probe.acts_in,
        "agent": probe.agent,
        "task": probe.task,
        "program": outcome.program,
        "attempts": outcome.attempts,
        "asked_again": outcome.asked_again,
        "usage": asdict(outcome.usage),
        "error": None if outcome.error is None else str(outcome.error),
        "said": [] if result is None else [list(line) for line in result.said],
        "lines": [] if result is None else list(result.lines),
        "log": [] if result is None else list(result.log),
        "unfinished": [] if result is None else [str(each) for each in result.unfinished],
        "aims": [] if result is None else msgspec.to_builtins(result.aims),
        "branch": outcome.branch,
        "placed": {} if result is None else placed_json(result.placed),
        "intended": _list(outcome.intended),
        "opened": [list(place) for place in outcome.opened],
        "arrived": _list(outcome.arrived),
        "replies": [_reply_json(each) for each in outcome.replies],
        "inferred": None if inferred is None else dict(inferred.means),
        "log_evidence": evidence if math.isfinite(evidence) else None,
        "expected": expected_json(probe.expect),
        "checks": [
            {"expected": each.expected.written(), "ok": each.ok, "why_not": each.why_not}
            for each in outcome.verdicts
        ],
        "ok": outcome.ok,
        "outcome": outcome.outcome,
        "why_not": outcome.why_not,
        "ticks": outcome.ticks,
        "tokens": outcome.usage.tokens,
        "cost": outcome.usage.cost,
        "run_dir": str(run_dir),
    }


def _reply_json(reply: Reply) -> dict[str, object]:
    entry: dict[str, object] = msgspec.to_builtins(reply)
    return {key: value for key, value in entry.items() if key not in ("prompt", "text")}


def _list(point: Point | None) -> list[float] | None:
    return None if point is None else list(point)
