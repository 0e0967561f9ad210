"""Cells in which a scenario is played once: the kind of `beliefnest run` and of studies."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec

from beliefnest.llm.claim_reader import claims_from_model
from beliefnest.llm.messages import Model, Sampling
from beliefnest.llm.model_settings import ModelSettings
from beliefnest.llm.resolve import can_vary
from beliefnest.nest.acting.script import OnProgress
from beliefnest.nest.face.nest import Nest
from beliefnest.plan.cells import Key, alike, cell_seed, digest, variation_id
from beliefnest.plan.draws import scenario_draws
from beliefnest.plan.terms import PlayStage
from beliefnest.prompts.templates import Template
from beliefnest.scenarios.expected import expected_json
from beliefnest.scenarios.outcome import Outcome
from beliefnest.scenarios.probing import Asking
from beliefnest.scenarios.records import expectation_json, probe_json
from beliefnest.scenarios.running import run_scenario
from beliefnest.scenarios.scenario import Scenario

LIST = "list"
"""Column of the lists of a Latin square, and its key in the plan."""

LABEL = "label"
"""Column of the labels of groups of scenarios, and its key in the plan."""


@dataclass(frozen=True, slots=True)
class CellKey(Key):
    """Identity of a cell in a study of scenarios.

    Attributes:
        scenario: Name of the scenario.
        content: Hash of the scenario's file and of the template.
        condition: Number of the condition; None: the scenario has no conditions.
        variation: Values of parameters and of further changes.
        model: Name of the model.
        template: Name of the prompt template; empty: that of the scenario.
        repeat: Number of the repeat, from 1.
        setting: Further settings that affect results: seed, world, attempts, temperature, and so
            on.
    """

    scenario: str
    content: str
    condition: int | None
    variation: Mapping[str, Any]
    model: str
    template: str
    repeat: int
    setting: Mapping[str, Any]

    @property
    def seed(self) -> int:
        """Return the seed of all random numbers of the cell.

        The seed depends on variation and repeat, but not on condition, model and template, so that
        comparisons between these have the same random numbers.
        """
        return cell_seed(self.scenario, dict(self.variation), self.repeat, self.setting["seed"])


class Cell(msgspec.Struct, frozen=True):
    """Variation of a scenario under one condition, to be played once with one model.

    Attributes:
        key: Identity of the cell.
        scenario: The scenario.
        list_number: Number of the cell's list, from 1; None: the design has no lists.
        label: Label of the scenario's group; empty: it has none.
    """

    key: CellKey
    scenario: Scenario
    list_number: int | None = None
    label: str = ""

    @property
    def world(self) -> str:
        """Name of its world."""
        return str(self.key.setting["world"])

    @property
    def is_quick(self) -> bool:
        """True if it asks nobody far away."""
        return not any(map(can_vary, self._models))

    @property
    def _models(self) -> list[str]:
        """Names of the models that it asks."""
        return [self.key.model, *filter(None, [self.key.setting.get("claims_from")])]

    def plain(self) -> dict[str, Any]:
        """Return the cell as plain values for the study's plan."""
        key = self.key
        draws = scenario_draws(self.scenario, self._models)
        return {
            "name": key.name,
            "key": key.content_json(),
            "seed": key.seed,
            "variation": variation_id(key.scenario, dict(key.variation)),
            "alike": None if draws else alike(key, ("repeat",)),
            **({} if self.list_number is None else {LIST: self.list_number}),
            **({LABEL: self.label} if self.label else {}),
            "probes": [
                {
                    "label": probe.label,
                    "path": probe.path,
                    "acts_in": probe.acts_in,
                    "agent": probe.agent,
                    "task": probe.task,
                    "expected": expected_json(probe.expect),
                }
                for probe in self.scenario.probes
            ],
        }

    def play(self, stage: PlayStage) -> dict[str, Any]:
        """Play the scenario, and return its result as plain values.

        Raises:
            BeliefNestError: The scenario, the world or the model failed.
        """
        terms = stage.terms
        model = terms.model(self.key.model, self.settings)
        store = terms.store(self.key.name)
        with self.opened(stage, store) as nest:
            outcome = self.run_in(nest, model)
        return {
            "error": None,
            "ticks": outcome.ticks,
            "run": "" if store is None else f"runs/{store.name}",
            "expectations": [expectation_json(each) for each in outcome.expectations],
            "probes": [
                {**probe_json(each, ""), "answer": each.answer, "seconds": each.ticks / 20}
                for each in outcome.probes
            ],
        }

    @contextmanager
    def opened(self, stage: PlayStage, store: Path | None) -> Iterator[Nest]:
        """Open a nest with the scenario, before its script.

        Args:
            stage: Where it is played.
            store: Run file to record to; None: no recording.
        """
        key = self.key
        reader = key.setting.get("claims_from")
        claims_from = None
        if reader is not None:
            claims_from = claims_from_model(
                stage.terms.reader(reader, self.settings), self._sampling
            )
        with Nest.open(
            self.scenario,
            self.world,
            store,
            key.seed,
            stage.worlds,
            claims_from=claims_from,
            renderer=stage.renderer,
        ) as nest:
            yield nest

    def run_in(
        self,
        nest: Nest,
        model: Model,
        started: float = 0.0,
        on_progress: OnProgress = lambda what, done, total: None,
    ) -> Outcome:
        """Play the script in an open nest, check the expectations, and ask the model.

        Args:
            nest: Nest that `opened` gave.
            model: Model that answers.
            started: `time.perf_counter()` before the nest was opened; 0: nobody reads the seconds.
            on_progress: Function that receives the progress.
        """
        key = self.key
        asking = Asking(key.setting["attempts"], self._sampling, self.settings)
        return run_scenario(nest, self.scenario, model, key.seed, started, on_progress, asking)

    @property
    def settings(self) -> ModelSettings:
        """Settings of its requests to models."""
        return ModelSettings.of_chosen(self.key.setting)

    @property
    def _sampling(self) -> Sampling:
        return self.settings.sampling(Sampling(self.key.setting["temperature"], self.key.seed))


def content_of(text: str, scenario: Scenario, template: Template | None) -> str:
    """Return the hash of a scenario's file with this text, and of its templates."""
    return digest([text, dict(scenario.templates), template and template.text])[:16]
