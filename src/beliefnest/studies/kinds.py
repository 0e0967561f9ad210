"""Kinds of cells of studies; a study's plan names its kind, and nothing else tells it."""

from beliefnest.importing import installed, load
from beliefnest.studies.episode_rows import EPISODES
from beliefnest.studies.forms import (
    EpisodesPlan,
    PlayedCondition,
    PlayedEpisode,
    PlayedScenario,
    RunPlan,
    ScenariosPlan,
)
from beliefnest.studies.items.cells import ITEM_KIND
from beliefnest.studies.rows import PROBES
from beliefnest.studies.table import CellKind

SCENARIO_KIND = CellKind("scenarios", ScenariosPlan, PlayedScenario, PROBES, subject="scenario")
RUN_KIND = CellKind("runs", RunPlan, PlayedCondition, PROBES, subject="scenario")
EPISODE_KIND = CellKind(
    "episodes",
    EpisodesPlan,
    PlayedEpisode,
    EPISODES,
    subject="task",
    players="players",
    player=("policy", "policies"),
)
_KINDS = {each.name: each for each in (SCENARIO_KIND, RUN_KIND, EPISODE_KIND, ITEM_KIND)}
_GROUP = "beliefnest.kinds"
"""Group of entry points of kinds that stand above studies, by name: objects `CellKind`."""


def kind_named(name: str) -> CellKind | None:
    """Return the kind of a name; None: there is none."""
    entry = None if name in _KINDS else installed(_GROUP, name)
    kind: CellKind | None = _KINDS.get(name) if entry is None else load(entry, "kind of cells")
    return kind
