"""Tasks of scenarios: their samples, prompts and scores."""

import json
from typing import Any

from anyio.to_thread import run_sync
from inspect_ai import Task
from inspect_ai.dataset import Sample
from inspect_ai.scorer import Score, Scorer, scorer
from inspect_ai.solver import Generate, Solver, TaskState, solver

from beliefnest.errors import InputError
from beliefnest.inspect.metrics import CLUSTER, metrics_by
from beliefnest.inspect.samples import ScenarioStage, requests_of
from beliefnest.inspect.task_parts import (
    answer_scorer,
    messages_of,
    score_of,
    several_files,
    task_of,
)
from beliefnest.llm.messages import Finish
from beliefnest.plan.cells import variation_id
from beliefnest.plan.scenario_cells import Cell
from beliefnest.scenarios.expected import expected_json
from beliefnest.scenarios.records import probe_json
from beliefnest.scenarios.sources import read_document
from beliefnest.studies.cells import plan_cells
from beliefnest.studies.design import Design
from beliefnest.studies.guessing import chance_of
from beliefnest.studies.probe_orders import order_of

_KEPT = ("intended", "opened", "arrived", "program", "ticks", "error", "log", "replies", "checks")


def scenario_task(
    scenarios: str | list[str],
    *,
    conditions: int | list[int] | None,
    variations: int | None,
    world: str,
    seed: int,
) -> Task:
    """Return the task of scenarios; each request of each probe of each cell is a sample.

    Args:
        scenarios: Names of built-in scenarios, or paths of files.
        conditions: Numbers of conditions; None for all.
        variations: Number of variations to draw; None for the scenario as written.
        world: Name of the world.
        seed: Seed from which the variations are drawn and the seed of each cell is derived.

    Raises:
        BeliefNestError: There is no such scenario, or an argument is invalid.
    """
    names = several_files(scenarios)
    design = Design(
        scenarios=tuple(names),
        variations={} if variations is None else variations,
        conditions=(conditions,) if isinstance(conditions, int) else _several(conditions),
        world=world,
        seed=seed,
    )
    documents = {name: read_document(name) for name in names}
    plan = plan_cells(design, documents)
    by_name = {document.root.value["name"].value: name for name, document in documents.items()}
    samples = [s for cell in plan.cells for s in _samples(cell, by_name[cell.key.scenario])]
    if not samples:
        why = plan.invalid[0].why if plan.invalid else "it has no probes with expectations"
        raise InputError(f"{', '.join(names)} gives no samples: {why}")
    return task_of(",".join(names), samples, in_the_belief(), belief_prompt())


def _several(numbers: list[int] | None) -> tuple[int, ...] | None:
    return None if numbers is None else tuple(numbers)


def _samples(cell: Cell, scenario: str) -> list[Sample]:
    key = cell.key
    samples = []
    for number, probe in enumerate(requests_of(cell.scenario), start=1):
        expected = expected_json(probe.expect)
        asks = probe.task if probe.asks_for_program else probe.questions[0].question
        about: dict[str, Any] = {
            "scenario": scenario,
            "condition": key.condition,
            "case": "as written" if key.condition is None else f"condition {key.condition}",
            "variation": dict(key.variation),
            "world": key.setting["world"],
            "seed": key.seed,
            "request": number,
            "label": probe.label,
            "path": probe.path,
            "acts_in": probe.acts_in,
            "agent": probe.agent,
            "expected": expected,
            "order": order_of(probe.path, expected),
            "chance": chance_of(expected),
            CLUSTER: variation_id(key.scenario, dict(key.variation)),
        }
        target = json.dumps(expected, sort_keys=True)
        name = f"{key.name}-{number}"
        samples.append(Sample(input=asks, target=target, id=name, metadata=about))
    return samples


@solver
def belief_prompt() -> Solver:
    """Replace the messages by the prompt that is rendered from the probe's belief."""
    stage = ScenarioStage()

    async def solve(state: TaskState, generate: Generate) -> TaskState:
        messages = await run_sync(stage.prompt, state.metadata)
        state.messages = messages_of(messages)
        return state

    return solve


@scorer(metrics=metrics_by("case"))
def in_the_belief() -> Scorer:
    """Score an answer: run its program in the belief it is meant for, or judge its words."""
    stage = ScenarioStage()

    async def score(state: TaskState, answer: str, finish: Finish) -> Score:
        judged = await run_sync(stage.judged, state.metadata, answer, finish)
        outcome = judged.outcome
        probe_report = probe_json(outcome, "")
        lines = [f"{outcome.outcome}: {outcome.why_not}" if outcome.why_not else outcome.outcome]
        if judged.grounds:
            lines += ["", f"What {outcome.probe.path} holds, and why:", *judged.grounds]
        return score_of(
            ok=outcome.ok,
            answer=outcome.program or answer,
            lines=lines,
            metadata={"outcome": outcome.outcome, **{key: probe_report[key] for key in _KEPT}},
        )

    return answer_scorer(score)
