"""`beliefnest run`: every condition in a world of its own, recorded, judged and pictured."""

import json
import os
import sys
import time
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from beliefnest.bodies.worlds import check_world
from beliefnest.cli.console import progress_on, stdout
from beliefnest.cli.folder import ConditionFolder, RunFolder
from beliefnest.cli.pictures import read_outcome_scene
from beliefnest.cli.report import outcome_json, outcome_table, report_json
from beliefnest.llm.messages import Model
from beliefnest.llm.resolve import Connection, open_model
from beliefnest.nest.nest import Nest
from beliefnest.scenarios.outcome import Outcome
from beliefnest.scenarios.running import run_scenario
from beliefnest.scenarios.scenario import Scenario
from beliefnest.timeline.store import SqliteJournal
from beliefnest.viewer.picture import draw_overview, draw_scene, save
from beliefnest.viewer.scene import Scene

__all__ = ["RunOptions", "run_scenarios"]


@dataclass(frozen=True, slots=True)
class RunOptions:
    """What was asked for on the command line.

    Attributes:
        scenario: Name or path.
        conditions: Numbers of the conditions to run; empty: all.
        world: Name of the world.
        model: Name of the model.
        out: Run folder; None: a new one in `runs`.
        seed: Drives every random number.
        as_json: Whether to print the report as JSON instead of a table.
    """

    scenario: str
    conditions: tuple[int, ...]
    world: str
    model: str
    out: Path | None
    seed: int
    as_json: bool


def run_scenarios(options: RunOptions) -> int:
    """Run, record, and print; the exit status says whether all was as expected.

    Raises:
        BeliefNestError: The input is wrong, or a world or model failed.
    """
    scenarios = _scenarios(options)
    check_world(options.world)
    model = open_model(options.model, os.environ, Connection())
    folder = RunFolder.create(options.out, scenarios[0].name, datetime.now())
    folder.write_scenario(scenarios[0].text)
    outcomes: list[Outcome] = []
    scenes: list[Scene] = []
    runs: list[dict[str, object]] = []
    status = "failed"
    try:
        for scenario in scenarios:
            place = folder.condition(scenario.condition)
            outcome, scene = _run(scenario, place, model, options)
            outcomes.append(outcome)
            scenes.append(scene)
            runs.append(outcome_json(outcome, place.path))
            place.write_result(runs[-1])
        if len(scenes) > 1:
            title = scenarios[0].description or scenarios[0].name
            save(draw_overview(scenes, title), folder.picture)
        status = "done"
    except KeyboardInterrupt:
        status = "interrupted"
        raise
    finally:
        report = report_json(scenarios[0].name, options.world, options.model, status, runs)
        folder.write_report(report)
    _print(outcomes, folder, report, as_json=options.as_json)
    return 0 if all(outcome.ok for outcome in outcomes) else 1


def _scenarios(options: RunOptions) -> tuple[Scenario, ...]:
    if not options.conditions:
        return Scenario.load_all(options.scenario)
    numbers = dict.fromkeys(options.conditions)
    return tuple(Scenario.load(options.scenario, number) for number in numbers)


def _run(
    scenario: Scenario, place: ConditionFolder, model: Model, options: RunOptions
) -> tuple[Outcome, Scene]:
    title = scenario.name
    if scenario.condition is not None:
        title += f", condition {scenario.condition}"
    started = time.perf_counter()
    with (
        progress_on(title) as on_progress,
        Nest.open(scenario, world=options.world, store=place.store, seed=options.seed) as nest,
    ):
        outcome = run_scenario(nest, scenario, model, options.seed, started, on_progress)
        for probe in outcome.probes:
            place.write_probe(probe)
        with SqliteJournal.read(place.store) as journal:
            scene = read_outcome_scene(nest, journal, outcome)
        save(draw_scene(scene), place.picture)
    return outcome, scene


def _print(
    outcomes: list[Outcome], folder: RunFolder, report: dict[str, object], *, as_json: bool
) -> None:
    console = stdout()
    table = outcome_table(outcomes)
    with console.capture() as captured:
        for outcome in outcomes:
            if outcome.scenario.condition is not None:
                number, about = outcome.scenario.condition, outcome.scenario.condition_description
                console.print(f"condition {number}: {about}", highlight=False)
        console.print(table)
        console.print(f"recorded in {folder.path}", highlight=False, soft_wrap=True)
    text = captured.get()
    folder.write_summary(text)
    sys.stdout.write(json.dumps(report, indent=2) + "\n" if as_json else text)
