"""Table of a study of episodes: one row for each episode in the study's folder."""

from collections.abc import Iterator, Mapping
from typing import Any

from beliefnest.episodes.measures import Measures
from beliefnest.studies.cells import variation_id
from beliefnest.studies.copies import rows_with_copies
from beliefnest.studies.episode_design import policy_named
from beliefnest.studies.rows import FAILED, plain_value, variation_columns
from beliefnest.studies.study_folder import StudyFolder
from beliefnest.studies.table import Table

__all__ = ["EPISODES"]

_COLUMNS = {
    "variation": "string",
    "player": "string",
    "order": "string",
    "policy": "string",
    "instance": "int64",
    "repeat": "int64",
    "seed": "int64",
    "needs": "int64",
    "ok": "bool",
    "outcome": "string",
    "why_not": "string",
    "ticks": "int64",
    "rounds": "int64",
    "messages": "int64",
    "claims": "int64",
    "true_claims": "int64",
    "false_claims": "int64",
    "lies": "int64",
    "taken_up": "int64",
    "not_taken_up": "int64",
    "help_needed": "int64",
    "help_given": "int64",
    "help_superfluous": "int64",
    "acted_on_false": "int64",
    "false_beliefs": "int64",
    "false_beliefs_mean": "float64",
    "false_beliefs_over_time": "string",
    "lost_rounds": "int64",
    "failed_programs": "int64",
    "failures": "string",
    "requests": "int64",
    "tokens": "int64",
    "cost": "float64",
    "policies": "string",
    "run": "string",
    "cell": "string",
    "copy_of": "string",
}
"""Columns after `task`, `condition` and those of variations, and their types. `Measures` documents
most of them. `variation` names the independent variation of a row; each instance of a built-in task
is one. `needs` is the order that the task needs, `order` the order of the player."""


_MEASURED = [
    name
    for name in _COLUMNS
    if name in Measures.__dataclass_fields__ and name not in ("order", "seed")
]


def _rows(folder: StudyFolder, plan: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    columns = variation_columns(plan)

    def rows_of(cell: Mapping[str, Any], found: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
        key = cell["key"]
        about = {
            "task": key["task"],
            "condition": key["condition"],
            **{name: plain_value(key["variation"].get(name)) for name in columns},
            # Plans of earlier versions do not have this key.
            "variation": cell.get("variation")
            or variation_id(key["task"], key["variation"], key["instance"]),
            "player": key["player"],
            "order": key["order"] or None,
            "policy": policy_named(key["player"], key["order"]),
            "instance": key["instance"],
            "repeat": key["repeat"],
            "seed": cell["seed"],
        }
        ends = {"run": found.get("run", ""), "cell": cell["name"]}
        if found["error"] is not None:
            yield {**about, "outcome": FAILED, "why_not": found["error"], **ends}
        else:
            yield {**about, **_measured(found), **ends}

    return rows_with_copies(folder, plan, rows_of)


def _measured(found: Mapping[str, Any]) -> dict[str, Any]:
    measures, ok = found["measures"], found["measures"]["success"]
    told = {name: plain_value(measures.get(name)) for name in _MEASURED}
    return {
        "needs": measures["order"],
        "ok": ok,
        "outcome": "ok" if ok else "wrong",
        "why_not": found["why_not"],
        **told,
    }


EPISODES = Table(
    rows=_rows,
    first={"task": "string", "condition": "int64"},
    columns=_COLUMNS,
    identity=("task", "condition", "player", "order", "policy", "instance", "repeat"),
    groups=("task", "policy"),
    further_groups=("condition",),
    compared=("policy",),
    apart=("player",),
    shown=(
        *(
            "variation",
            "policy",
            "instance",
            "repeat",
            "outcome",
            "why_not",
            "ticks",
            "rounds",
            "messages",
        ),
        *("lies", "acted_on_false", "false_beliefs_over_time", "tokens"),
    ),
    same={"policy": ("player", "order"), "player": ("policy",), "order": ("policy",)},
    means={
        "ticks": True,
        "messages": False,
        "acted_on_false": False,
        "false_beliefs_mean": False,
        "help_needed": False,
        "help_given": False,
        "help_superfluous": False,
    },
)
"""Table of studies of episodes."""
