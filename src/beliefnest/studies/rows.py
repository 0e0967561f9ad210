"""Table of a study of scenarios: one row for each probe of each cell in the study's folder."""

import json
from collections.abc import Iterator, Mapping
from typing import Any

from beliefnest.scenarios.judging import OUTCOMES
from beliefnest.studies.cells import variation_id
from beliefnest.studies.copies import rows_with_copies
from beliefnest.studies.study_folder import StudyFolder
from beliefnest.studies.table import Table
from beliefnest.world.paths import normalised

__all__ = ["FAILED", "PROBES", "plain_value", "variation_columns"]

FAILED = "error"
"""Outcome of rows without a result."""
assert FAILED in OUTCOMES

_COLUMNS = {
    "variation": "string",
    "model": "string",
    "template": "string",
    "repeat": "int64",
    "seed": "int64",
    "probe": "string",
    "path": "string",
    "order": "int64",
    "acts_in": "string",
    "agent": "string",
    "task": "string",
    "expected": "string",
    "intended": "string",
    "opened": "string",
    "arrived": "string",
    "answered": "string",
    "inferred": "string",
    "ok": "bool",
    "outcome": "string",
    "why_not": "string",
    "beliefs_ok": "bool",
    "script_ticks": "int64",
    "ticks": "int64",
    "seconds": "float64",
    "attempts": "int64",
    "tokens": "int64",
    "cost": "float64",
    "program": "string",
    "run": "string",
    "cell": "string",
    "copy_of": "string",
}
"""Columns after `scenario`, `condition` and those of variations, and their types. Places are texts
such as `-2,-51,-4`. `variation` names the independent variation of a row. `order` is the order of
the probed belief, 0 for the real world. `seconds` is Minecraft time of the probe's program."""


def variation_columns(plan: Mapping[str, Any]) -> list[str]:
    """Return the names of the columns of variations, in the order of the plan."""
    names = (name for cell in plan["cells"] for name in cell["key"]["variation"])
    return list(dict.fromkeys(names))


def _probe_rows(folder: StudyFolder, plan: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    """Yield the rows of a plan, see `rows_with_copies`.

    A failed cell has a row for each of its probes, with the outcome `error` and the reason. A cell
    without probes has a single row about its expectations.
    """
    columns = variation_columns(plan)

    def rows_of(cell: Mapping[str, Any], found: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
        key = cell["key"]
        about = {
            "scenario": key["scenario"],
            "condition": key["condition"],
            **{name: plain_value(key["variation"].get(name)) for name in columns},
            # Plans of earlier versions do not have this key.
            "variation": cell.get("variation") or variation_id(key["scenario"], key["variation"]),
            "model": key["model"],
            "template": key["template"],
            "repeat": key["repeat"],
            "seed": cell["seed"],
        }
        ends = {"cell": cell["name"], "run": found.get("run", "")}
        if found["error"] is not None:
            for probe in cell["probes"] or [{}]:
                yield {**about, **_failed(probe, found["error"]), **ends}
            return
        held = [each["ok"] for each in found["expectations"]]
        common = {
            "beliefs_ok": all(held) if held else None,
            "script_ticks": found["ticks"],
        }
        for probe in found["probes"]:
            yield {**about, **_probe(probe), **common, **ends}
        if not found["probes"]:
            yield {**about, **_beliefs(found["expectations"]), **common, **ends}

    return rows_with_copies(folder, plan, rows_of)


def _probe(probe: Mapping[str, Any]) -> dict[str, Any]:
    usage = probe["usage"]
    return {
        "probe": probe["label"],
        "path": probe["path"],
        "order": _order(probe["path"]),
        "acts_in": probe["acts_in"],
        "agent": probe["agent"],
        "task": probe["task"],
        "expected": plain_value(probe["expected"]),
        "intended": _place(probe["intended"]),
        "opened": " ".join(_place(place) or "" for place in probe["opened"]),
        "arrived": _place(probe["arrived"]),
        "answered": "; ".join(str(reply["answer"]) for reply in probe["replies"]),
        # Cells of an earlier version have none.
        "inferred": plain_value(probe.get("inferred")),
        "ok": probe["ok"],
        "outcome": probe["outcome"],
        "why_not": probe["why_not"],
        "ticks": probe["ticks"],
        "seconds": probe["seconds"],
        "attempts": probe["attempts"],
        "tokens": usage["input_tokens"] + usage["output_tokens"],
        "cost": usage["cost"],
        "program": probe["program"],
    }


def _failed(probe: Mapping[str, Any], why: str) -> dict[str, Any]:
    return {
        **{name: probe.get(name) for name in ("path", "acts_in", "agent", "task")},
        "probe": probe.get("label", ""),
        "order": _order(probe["path"]) if "path" in probe else None,
        "expected": plain_value(probe.get("expected")),
        "outcome": FAILED,
        "why_not": why,
    }


def _beliefs(expectations: list[Mapping[str, Any]]) -> dict[str, Any]:
    wrong = [f"{each['label'] or each['path']}: {each['why_not']}" for each in expectations]
    wrong = [told for told, each in zip(wrong, expectations, strict=True) if not each["ok"]]
    ok = not wrong if expectations else None
    return {
        "probe": "",
        "ok": ok,
        "outcome": "wrong" if wrong else "ok",
        "why_not": "; ".join(wrong),
    }


def plain_value(value: Any) -> Any:
    """Return a value as one cell of a table: places as `x,y,z`, other structures as JSON."""
    if isinstance(value, list) and value and all(isinstance(n, int | float) for n in value):
        return _place(value)
    return json.dumps(value, sort_keys=True) if isinstance(value, list | dict) else value


def _order(path: str) -> int:
    """Return the number of agents in a belief path: 0 for the real world."""
    return len(normalised(filter(None, path.split("/"))))


def _place(place: list[float] | None) -> str | None:
    return None if place is None else ",".join(f"{part:g}" for part in place)


PROBES = Table(
    rows=_probe_rows,
    first={"scenario": "string", "condition": "int64"},
    columns=_COLUMNS,
    identity=(
        *("scenario", "condition", "model", "template", "repeat"),
        *("probe", "path", "acts_in", "agent", "task"),
    ),
    groups=("scenario", "condition", "model"),
    further_groups=("template", "order"),
    compared=("condition", "model", "template"),
    apart=("model", "template", "order"),
    shown=(
        *("variation", "model", "template", "repeat", "probe", "path", "order", "expected"),
        *(
            "intended",
            "opened",
            "arrived",
            "answered",
            "inferred",
            "outcome",
            "why_not",
            "ticks",
            "tokens",
        ),
    ),
    same={"probe": ("path", "order", "acts_in", "agent", "task")},
)
"""Table of studies of scenarios."""
