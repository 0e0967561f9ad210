"""Cells of a run: one for each model, repeat and condition."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from beliefnest.scenarios.scenario import Scenario


@dataclass(frozen=True, slots=True)
class RunCell:
    """One scenario under one condition with one model, once.

    Attributes:
        scenario: Scenario with its condition applied.
        model: Name of the model.
        seed: Seed of every random number; each repeat has another one.
        folder: Folder of the cell, relative to the run folder.
    """

    scenario: Scenario
    model: str
    seed: int
    folder: Path

    @property
    def title(self) -> str:
        """Title of the cell in progress lines and messages."""
        parts = [self.scenario.name]
        if self.scenario.condition is not None:
            parts.append(f"condition {self.scenario.condition}")
        if len(self.folder.parts) > 1:
            parts += [self.model, f"seed {self.seed}"]
        return ", ".join(parts)


def plan_run_cells(
    scenarios: Sequence[Scenario], models: Sequence[str], repeat: int, seed: int
) -> list[RunCell]:
    """Return all cells in the order of play.

    With one model and one repeat, the folders of conditions are directly in the run folder.
    """
    flat = len(models) == 1 and repeat == 1
    return [
        RunCell(
            scenario=scenario,
            model=model,
            seed=seed + number,
            folder=_folder(number, model, models) / condition if not flat else Path(condition),
        )
        for number in range(repeat)
        for model in models
        for scenario in scenarios
        for condition in [
            "run" if scenario.condition is None else f"condition-{scenario.condition}"
        ]
    ]


def _folder(number: int, model: str, models: Sequence[str]) -> Path:
    """Return the folder name of a model.

    The number in front separates models whose names differ only in special characters.
    """
    name = re.sub(r"[^A-Za-z0-9.]+", "-", model)
    return Path(f"model-{models.index(model) + 1}-{name}", f"repeat-{number + 1}")
