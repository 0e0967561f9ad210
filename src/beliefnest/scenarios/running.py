"""Running of a scenario in an open nest: script, expectations, and probes."""

import time

from beliefnest.facts.states import StateFacts
from beliefnest.llm.messages import Model, Usage
from beliefnest.nest.acting.script import OnProgress
from beliefnest.nest.face.nest import Nest
from beliefnest.scenarios.expected import Deed
from beliefnest.scenarios.outcome import ExpectationOutcome, Outcome
from beliefnest.scenarios.probing import Asking, resolved, run_probe
from beliefnest.scenarios.right_answers_check import warn_of_answers, warn_of_scene
from beliefnest.scenarios.scenario import Scenario
from beliefnest.world.paths import parse_path, path_text


def run_scenario(
    nest: Nest,
    scenario: Scenario,
    model: Model,
    seed: int,
    started: float,
    on_progress: OnProgress,
    asking: Asking | None = None,
) -> Outcome:
    """Play the script, check the expectations against the nest, and run the probes.

    Args:
        nest: Nest opened with the scenario, before the script.
        scenario: Scenario with its condition applied.
        model: Model that answers the probes.
        seed: Seed of the nest, for the record.
        started: `time.perf_counter()` before the nest was opened.
        on_progress: Function that receives the progress.
        asking: Options of requests to the model; None: `Asking()`.

    Raises:
        ProgramError: A program of the script failed.
        InputError: A judging function does not exist; nothing was played.
        ModelError: The model gave no usable answer.
        BodyError: The Minecraft side died.
        ScenarioError: A belief gives no right answer; no model was asked.
    """
    for expected in (each for probe in scenario.probes for each in probe.expect):
        if isinstance(expected, Deed):
            expected.check()
    warn_of_scene(scenario)
    nest.play(on_progress)
    ticks = nest.tick
    steps = len(scenario.setting.script)
    on_progress(_wait_words(), steps, steps)
    paths = _paths(scenario)
    states = nest.states(["/", *paths])
    expectations = tuple(
        ExpectationOutcome(each, each.fact.instead(StateFacts(nest[each.simulator].state)))
        for each in scenario.expectations
    )
    probes = []
    # Compute right answers before any model is asked: errors in them then cost nothing.
    asked = [resolved(nest, probe) for probe in scenario.probes]
    warn_of_answers(nest, scenario, asked)
    for number, probe in enumerate(asked):
        verb = "asking" if probe.asks_model else "inferring"
        on_progress(f"{verb}: {probe.asked}", number, len(asked))
        probes.append(run_probe(nest, number + 1, probe, model, seed, asking or Asking()))
    return Outcome(
        scenario=scenario,
        seed=seed,
        ticks=ticks,
        seconds=time.perf_counter() - started,
        reality=states["/"],
        beliefs={path: states[path] for path in paths},
        expectations=expectations,
        probes=tuple(probes),
        reading=_reading(nest),
    )


def _wait_words() -> str:
    """Return what to say while beliefs are computed."""
    from beliefnest.belief import kernel
    from beliefnest.perception.compiling import is_compiled

    compiling = "" if is_compiled(kernel.fold) else " (this very first time code is compiled)"
    return f"working out beliefs{compiling}"


def _paths(scenario: Scenario) -> list[str]:
    """Return the paths of all beliefs that the scenario names, normalized, shallow ones first."""
    agents = scenario.setting.snapshot.agents
    named = [each.simulator for each in scenario.expectations]
    named += [path for probe in scenario.probes for path in (probe.path, probe.acts_in)]
    named += [path for probe in scenario.probes for each in probe.expect for path in each.paths]
    paths = {parse_path(path, agents) for path in named}
    return [path_text(path) for path in sorted(paths, key=lambda p: (len(p), p)) if path]


def _reading(nest: Nest) -> Usage:
    """Return the tokens and cost of extracting claims from utterances."""
    asked = [each for each in nest.prompts() if "claims_from" in each.detail]
    took = [Usage(a.requests, a.input_tokens, a.output_tokens, a.cost) for a in asked]
    return sum(took, Usage())
