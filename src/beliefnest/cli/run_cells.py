"""Cells of a run: one for each model, repeat and condition."""

import re
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from beliefnest.cli.accounts import accounts
from beliefnest.cli.console import progress_on
from beliefnest.cli.folder import ConditionFolder
from beliefnest.cli.gallery import Gallery
from beliefnest.cli.pictures import read_condition
from beliefnest.cli.report import outcome_json
from beliefnest.cli.visits import visited
from beliefnest.nest.face.nest import Nest
from beliefnest.plan.scenario_cells import Cell, CellKey, content_of
from beliefnest.plan.terms import PlayStage
from beliefnest.scenarios.scenario import Scenario
from beliefnest.timeline.store import Journal


@dataclass(frozen=True, slots=True)
class RunKey(CellKey):
    """Identity of a cell of a run."""

    @property
    def seed(self) -> int:
        """Return the seed of all random numbers of the cell: each repeat adds 1."""
        return int(self.setting["seed"]) + self.repeat - 1


class RunCell(Cell, frozen=True, kw_only=True):
    """One scenario under one condition with one model, once, with a folder and pictures.

    Attributes:
        folder: Folder of the run.
        place: Folder of the cell.
        is_flat: True if the run has one model and one repeat: no title names them.
        embody: Paths of beliefs that people visit while it is played.
        gallery: Pictures of the run, which draws that of the cell.
    """

    folder: Path
    place: ConditionFolder
    is_flat: bool
    embody: Sequence[str]
    gallery: Gallery

    @property
    def title(self) -> str:
        """Title of the cell in progress lines and messages."""
        parts = [self.scenario.name]
        if self.scenario.condition is not None:
            parts.append(f"condition {self.scenario.condition}")
        if not self.is_flat:
            parts += [self.key.model, f"seed {self.key.seed}"]
        return ", ".join(parts)

    def play(self, stage: PlayStage) -> dict[str, Any]:
        """Play the scenario, have all of it written into its folder, and return the result.

        Raises:
            BeliefNestError: The scenario, the world or the model failed.
        """
        place = self.place
        place.begin()
        model = stage.terms.model(self.key.model, self.settings)
        started = time.perf_counter()
        with progress_on(self.title) as on_progress, self.opened(stage, place.store) as nest:
            with visited(nest, self.embody):
                outcome = self.run_in(nest, model, started, on_progress)
            for number, probe in enumerate(outcome.probes, start=1):
                place.write_probe(number, probe)
            with Journal.read(place.store) as journal:
                picture = read_condition(nest, journal, outcome)
            reports = accounts(nest, outcome)
            readings = {"readings": _readings(nest)} if "claims_from" in self.key.setting else {}
            stopped = _stopped(nest)
        result = {**outcome_json(outcome, self.key.model, place.path, reports), **readings}
        result["stopped"] = stopped
        self.gallery.add(picture, place)
        run = place.store.relative_to(self.folder).as_posix()
        return {"error": None, **result, "run": run}


def _stopped(nest: Nest) -> list[str]:
    """Return what programs of reality left unfinished, such as calls without `await`."""
    return [f"{each.agent}: {what}" for each in nest.programs("/") for what in each.unfinished]


def _readings(nest: Nest) -> dict[str, object]:
    """Return how often a model was asked for claims of an utterance, and how often it failed."""
    asked = [each for each in nest.prompts() if "claims_from" in each.detail]
    failed = [each.error for each in asked if each.answer is None]
    return {"asked": len(asked), "failed": len(failed), "first": next(iter(failed), None)}


def plan_run_cells(
    scenarios: Sequence[Scenario],
    setting: dict[str, Any],
    folder: Path,
    embody: Sequence[str],
    gallery: Gallery,
) -> list[RunCell]:
    """Return all cells in the order of play.

    With one model and one repeat, the folders of conditions are directly in the run folder.

    Args:
        scenarios: The scenario, under each condition.
        setting: Settings of the run, with `models` and `repeat`.
        folder: Folder of the run.
        embody: Paths of beliefs that people visit.
        gallery: Pictures of the run.
    """
    models, repeats = setting["models"], setting["repeat"]
    flat = len(models) == 1 and repeats == 1
    planned = []
    for repeat in range(1, repeats + 1):
        for number, model in enumerate(models, start=1):
            # The number separates models whose names differ only in special characters.
            name = re.sub(r"[^A-Za-z0-9.]+", "-", model)
            above = "" if flat else f"model-{number}-{name}/repeat-{repeat}"
            for scenario in scenarios:
                key = RunKey(
                    scenario=scenario.name,
                    content=content_of(scenario.text, scenario, None),
                    condition=scenario.condition,
                    variation={},
                    model=model,
                    template="",
                    repeat=repeat,
                    setting=setting,
                )
                condition = "run" if key.condition is None else f"condition-{key.condition}"
                place = ConditionFolder(folder / above / condition)
                planned.append(
                    RunCell(
                        key=key,
                        scenario=scenario,
                        folder=folder,
                        place=place,
                        is_flat=flat,
                        embody=embody,
                        gallery=gallery,
                    )
                )
    return planned
