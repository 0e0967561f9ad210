"""Table of a study of scenarios: one row for each probe of each cell in the study's folder."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from beliefnest.plan.scenario_cells import LIST
from beliefnest.studies.guessing import chance_of
from beliefnest.studies.probe_orders import order_of
from beliefnest.studies.table import (
    Column,
    RowSource,
    Table,
    lost,
    of_key,
    of_result,
    place_text,
    plain_value,
)


def _results(cell: Mapping[str, Any], content: Mapping[str, Any]) -> Iterator[Mapping[str, Any]]:
    """Yield the result of each probe.

    A failed cell has a result for each of its probes, with the reason (see `lost`). A cell
    without probes has a single result about its expectations.
    """
    if content["error"] is not None:
        for probe in cell["probes"] or [{}]:
            yield {**probe, **lost(content, is_judged=bool(probe.get("expected")))}
    elif content["probes"]:
        yield from content["probes"]
    else:
        yield _beliefs(content["expectations"])


def _beliefs(expectations: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    wrong = [
        f"{each['label'] or each['path']}: {each['why_not']}"
        for each in expectations
        if not each["ok"]
    ]
    return {
        "ok": not wrong if expectations else None,
        "outcome": "wrong" if wrong else "ok",
        "why_not": "; ".join(wrong),
    }


def _order(source: RowSource) -> int | None:
    path = source.result.get("path")
    return None if path is None else order_of(path, source.result.get("expected"))


def _opened(places: list[list[float]] | None) -> str | None:
    return None if places is None else " ".join(place_text(place) or "" for place in places)


def _answered(replies: list[Mapping[str, Any]] | None) -> str | None:
    return None if replies is None else "; ".join(str(reply["answer"]) for reply in replies)


def _form(replies: list[Mapping[str, Any]] | None) -> str | None:
    """Return the form that was asked for in questions; those of a probe have one form."""
    forms = dict.fromkeys(str(reply.get("form", "text")) for reply in replies or ())
    return "; ".join(forms) or None


def _tokens(usage: Mapping[str, Any] | None) -> int | None:
    return None if usage is None else usage["input_tokens"] + usage["output_tokens"]


def _cost(usage: Mapping[str, Any] | None) -> float | None:
    return None if usage is None else usage["cost"]


def _beliefs_ok(source: RowSource) -> bool | None:
    expectations = source.found.get("expectations")
    return all(each["ok"] for each in expectations) if expectations else None


PROBES = Table(
    results=_results,
    first=(
        Column("scenario", "string", of_key("scenario"), identifies=True),
        Column("condition", "int64", of_key("condition"), identifies=True),
    ),
    columns=(
        # The independent variation of a row.
        Column("variation", "string", lambda source: source.cell["variation"], shown=True),
        Column("model", "string", of_key("model"), shown=True, identifies=True),
        Column("template", "string", of_key("template"), shown=True, identifies=True),
        Column("repeat", "int64", of_key("repeat"), shown=True, identifies=True),
        Column("seed", "int64", lambda source: source.cell["seed"]),
        Column(
            "probe",
            "string",
            of_result("label", lambda label: label or ""),
            shown=True,
            identifies=True,
        ),
        Column("path", "string", of_result("path"), shown=True, identifies=True),
        # The order of the probed belief, or of the one that gives the right answer.
        Column("order", "int64", _order, shown=True),
        Column("acts_in", "string", of_result("acts_in"), identifies=True),
        Column("agent", "string", of_result("agent"), identifies=True),
        Column("task", "string", of_result("task"), identifies=True),
        # Places are texts such as `-2,-51,-4`.
        Column("expected", "string", of_result("expected", plain_value), shown=True),
        # Probability that a blind guess is right.
        Column("chance", "float64", of_result("expected", chance_of)),
        Column("intended", "string", of_result("intended", place_text), shown=True),
        Column("opened", "string", of_result("opened", _opened), shown=True),
        Column("arrived", "string", of_result("arrived", place_text), shown=True),
        Column("answered", "string", of_result("replies", _answered), shown=True),
        Column("inferred", "string", of_result("inferred", plain_value), shown=True),
        Column("ok", "bool", of_result("ok")),
        Column("outcome", "string", of_result("outcome"), shown=True),
        Column("why_not", "string", of_result("why_not"), shown=True),
        Column("beliefs_ok", "bool", _beliefs_ok),
        Column("script_ticks", "int64", lambda source: source.found.get("ticks")),
        Column("ticks", "int64", of_result("ticks"), shown=True),
        # Minecraft time of the probe's program.
        Column("seconds", "float64", of_result("seconds")),
        Column("attempts", "int64", of_result("attempts")),
        Column("asked_again", "int64", of_result("asked_again")),
        Column("form", "string", of_result("replies", _form)),
        Column("tokens", "int64", of_result("usage", _tokens), shown=True),
        Column("cost", "float64", of_result("usage", _cost)),
        Column("program", "string", of_result("program")),
        Column("run", "string", lambda source: source.found.get("run", "")),
        Column("cell", "string", lambda source: source.cell["name"]),
        # Filled in when all rows are known.
        Column("copy_of", "string", of_result("copy_of")),
    ),
    groups=("scenario", "condition", "model"),
    further_groups=("template", "order"),
    compared=("condition", "model", "template"),
    apart=("model", "template", "order"),
    same={
        "probe": ("path", "order", "acts_in", "agent", "task"),
        # In each list, a variation has another condition.
        "condition": (LIST,),
    },
)
"""Table of studies of scenarios."""
