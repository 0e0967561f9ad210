"""Running a scenario in an open nest: its script, its expectations, its probes."""

import time

from beliefnest.belief.view import State
from beliefnest.llm.asking import ask_for_program
from beliefnest.llm.messages import Model
from beliefnest.nest.nest import Nest, Progress
from beliefnest.nest.paths import parse_path, path_text
from beliefnest.prompts import Template, built_in_template
from beliefnest.scenarios.judging import arrives, is_held, opened_by, opens
from beliefnest.scenarios.outcome import ExpectationOutcome, Outcome, ProbeOutcome
from beliefnest.scenarios.scenario import Arrives, Opens, Probe, Scenario
from beliefnest.world.values import Point, Position

__all__ = ["run_scenario"]


def run_scenario(
    nest: Nest, scenario: Scenario, model: Model, seed: int, started: float, on_progress: Progress
) -> Outcome:
    """Play the script, hold the expectations against the nest, and run the probes.

    Args:
        nest: Opened with the scenario, nothing played yet.
        scenario: Under the condition it is to be run under.
        model: Who answers the prompts of the probes.
        seed: What the nest was opened with, for the record.
        started: `time.perf_counter()` before the nest was opened.
        on_progress: Takes what is being done.

    Raises:
        ProgramError: A program of the script failed.
        ModelError: The model gave no usable answer.
        BodyError: The Minecraft side died.
    """
    nest.play(on_progress)
    ticks = nest.tick
    steps = len(scenario.setting.script)
    on_progress("working out beliefs (the very first time this compiles code)", steps, steps)
    reality = nest["/"].state
    beliefs = {path: nest[path].state for path in _paths(scenario)}
    expectations = tuple(
        ExpectationOutcome(each, is_held(each.content, nest[each.path].state))
        for each in scenario.expectations
    )
    probes = []
    for number, probe in enumerate(scenario.probes):
        on_progress(f"asking: {probe.task}", number, len(scenario.probes))
        probes.append(_run_probe(nest, probe, f"probe {number + 1}", model))
    return Outcome(
        scenario=scenario,
        seed=seed,
        ticks=ticks,
        seconds=time.perf_counter() - started,
        reality=reality,
        beliefs=beliefs,
        expectations=expectations,
        probes=tuple(probes),
    )


def _paths(scenario: Scenario) -> list[str]:
    """Every belief that the scenario names, normalised, in order of depth."""
    agents = scenario.setting.snapshot.agents
    named = [each.path for each in scenario.expectations]
    named += [path for probe in scenario.probes for path in (probe.path, probe.acts_in)]
    paths = {parse_path(path, agents) for path in named}
    return [path_text(path) for path in sorted(paths, key=lambda p: (len(p), p)) if path]


def _run_probe(nest: Nest, probe: Probe, branch: str, model: Model) -> ProbeOutcome:
    template = (
        built_in_template("paper")
        if probe.template is None
        else Template("template of the probe", probe.template)
    )
    believer = nest[probe.path]
    prompt = believer.render(template, task=probe.task)
    instructions = believer.render(built_in_template("instructions"))
    answer = ask_for_program(model, prompt, _accept, system=instructions)
    simulator = nest[probe.acts_in]
    before = simulator.branch
    simulator.switch(branch)
    try:
        result = simulator.run(probe.agent, answer.program, probe.timeout_ticks)
        opened = opened_by(probe.agent, result.events)
        arrived = _standing(simulator.state, probe.agent)
    finally:
        simulator.switch(before)
    return ProbeOutcome(
        probe=probe,
        prompt=prompt,
        answer=answer.attempts[-1].answer.text,
        program=answer.program,
        branch=branch,
        ok_run=result.ok,
        error=None if result.error is None else str(result.error),
        opened=opened,
        arrived=arrived,
        ok=_judge(probe.expect, opened, arrived),
    )


def _accept(program: str) -> None:
    """No program is sent back: what it does in the simulator is what is judged."""


def _standing(state: State, agent: str) -> Point | None:
    return state.agents[agent].position


def _judge(
    expect: Opens | Arrives | None, opened: tuple[Position, ...], arrived: Point | None
) -> bool | None:
    if isinstance(expect, Opens):
        return opens(expect, opened)
    if isinstance(expect, Arrives):
        return arrives(expect, arrived)
    return None
