"""Table of a study of episodes: one row for each episode in the study's folder."""

from collections.abc import Iterator, Mapping
from typing import Any

from beliefnest.studies.table import Column, ColumnType, Table, lost, of_key, of_result, plain_value


def policy_named(player: str, order: str) -> str:
    """Return a player's policy as the command line takes it; an empty order adds nothing."""
    if (player, order) == ("search", "omniscient"):
        return "omniscient:search"
    return f"{player}:{order}" if order else player


def _results(cell: Mapping[str, Any], content: Mapping[str, Any]) -> Iterator[Mapping[str, Any]]:
    """Yield the measures of the episode, or the reason why there are none."""
    if content["error"] is not None:
        failed = lost(content, is_judged=True)
        yield {**failed, "success": failed["ok"]}
        return
    ok = content["measures"]["success"]
    judged = {"outcome": "ok" if ok else "wrong", "why_not": content["why_not"]}
    yield {**content["measures"], **judged}


def _measure(name: str, kind: ColumnType = "int64", *, shown: bool = False) -> Column:
    """Return the column of a measure, see `Measures`."""
    return Column(name, kind, of_result(name, plain_value), shown)


EPISODES = Table(
    results=_results,
    first=(
        Column("task", "string", of_key("task"), identifies=True),
        Column("condition", "int64", of_key("condition"), identifies=True),
    ),
    columns=(
        # The independent variation of a row; each instance of a built-in task is one.
        Column("variation", "string", lambda source: source.cell["variation"], shown=True),
        Column("player", "string", of_key("player"), identifies=True),
        # The order of the player.
        Column(
            "order", "string", lambda source: source.cell["key"]["order"] or None, identifies=True
        ),
        Column(
            "policy",
            "string",
            lambda source: policy_named(source.cell["key"]["player"], source.cell["key"]["order"]),
            shown=True,
            identifies=True,
        ),
        Column("instance", "int64", of_key("instance"), shown=True, identifies=True),
        Column("repeat", "int64", of_key("repeat"), shown=True, identifies=True),
        Column("seed", "int64", lambda source: source.cell["seed"]),
        # The order that the task needs.
        Column("needs", "int64", of_result("order")),
        Column("ok", "bool", of_result("success")),
        Column("outcome", "string", of_result("outcome"), shown=True),
        Column("why_not", "string", of_result("why_not"), shown=True),
        _measure("ticks", shown=True),
        _measure("rounds", shown=True),
        _measure("messages", shown=True),
        _measure("claims"),
        _measure("true_claims"),
        _measure("false_claims"),
        _measure("lies", shown=True),
        _measure("taken_up"),
        _measure("not_taken_up"),
        _measure("help_needed"),
        _measure("help_given"),
        _measure("help_superfluous"),
        _measure("acted_on_false", shown=True),
        _measure("false_beliefs"),
        _measure("false_beliefs_mean", "float64"),
        _measure("false_beliefs_over_time", "string", shown=True),
        _measure("lost_rounds"),
        _measure("not_answered", "string"),
        _measure("asked_again"),
        _measure("failed_programs"),
        _measure("failures", "string"),
        _measure("requests"),
        _measure("tokens", shown=True),
        _measure("cost", "float64"),
        _measure("policies", "string"),
        Column("run", "string", lambda source: source.found.get("run", "")),
        Column("cell", "string", lambda source: source.cell["name"]),
        # Filled in when all rows are known.
        Column("copy_of", "string", of_result("copy_of")),
    ),
    groups=("task", "policy"),
    further_groups=("condition",),
    compared=("policy",),
    apart=("player",),
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
