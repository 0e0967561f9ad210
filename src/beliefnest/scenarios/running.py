"""Running a scenario in an open nest: its script, its expectations, its probes."""

import time
from dataclasses import dataclass, field

from beliefnest.belief.view import State
from beliefnest.bodies.protocol import ProgramResult
from beliefnest.llm.asking import NoUsableProgramError, Prompt, ask_for_program
from beliefnest.llm.messages import Model, Sampling, Usage
from beliefnest.nest.face.nest import Nest, Progress
from beliefnest.nest.face.simulator import Simulator
from beliefnest.programs import skills
from beliefnest.prompts import Template, built_in_template
from beliefnest.prompts.rendering import LAST_ERROR
from beliefnest.scenarios.content import Arrives, Opens, Probe
from beliefnest.scenarios.judging import arrives, is_held, opened_by, opens
from beliefnest.scenarios.outcome import ExpectationOutcome, Outcome, ProbeOutcome
from beliefnest.scenarios.scenario import Scenario
from beliefnest.world.paths import parse_path, path_text
from beliefnest.world.values import Point, Position

__all__ = ["Asking", "run_scenario"]


@dataclass(frozen=True, slots=True)
class Asking:
    """How a model is asked.

    Attributes:
        attempts: How often at most, for one probe: a program that does not work is sent back.
        sampling: How answers are drawn.
    """

    attempts: int = 3
    sampling: Sampling = field(default_factory=Sampling)


def run_scenario(
    nest: Nest,
    scenario: Scenario,
    model: Model,
    seed: int,
    started: float,
    on_progress: Progress,
    asking: Asking | None = None,
) -> Outcome:
    """Play the script, hold the expectations against the nest, and run the probes.

    Args:
        nest: Opened with the scenario, nothing played yet.
        scenario: Under the condition it is to be run under.
        model: Who answers the prompts of the probes.
        seed: What the nest was opened with, for the record.
        started: `time.perf_counter()` before the nest was opened.
        on_progress: Takes what is being done.
        asking: How the model is asked; None: as `Asking()` says.

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
        probes.append(_run_probe(nest, number + 1, probe, model, asking or Asking()))
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


def _run_probe(nest: Nest, number: int, probe: Probe, model: Model, asking: Asking) -> ProbeOutcome:
    name = f"probe {number}"
    trials = _Trials(nest, probe, name)
    believer = nest[probe.path]
    prompts = _Prompts(believer, probe)
    try:
        attempts = ask_for_program(
            believer.noting(model, probe=name, task=probe.task),
            prompts.prompt,
            trials.complaint,
            asking.attempts,
            system=prompts.system,
            sampling=asking.sampling,
        ).attempts
    except NoUsableProgramError as error:
        if not trials.done:
            raise
        # It did give programs: what the last of them did is the result.
        attempts = error.attempts
    last = trials.done[-1]
    answer = next(each for each in reversed(attempts) if each.program is not None)
    return ProbeOutcome(
        probe=probe,
        prompt=answer.messages[-1].text,
        answer=answer.answer.text,
        program=last.program,
        branch=last.branch,
        attempts=len(attempts),
        usage=sum((each.answer.usage for each in attempts), Usage()),
        result=last.result,
        opened=last.opened,
        arrived=last.arrived,
        ok=_judge(probe.expect, last.opened, last.arrived),
    )


class _Prompts:
    """What a model is told: how to answer, and what the belief holds."""

    def __init__(self, believer: Simulator, probe: Probe) -> None:
        self._believer = believer
        self._task = probe.task
        if probe.template is None:
            self._template = built_in_template("paper")
        else:
            self._template = Template("template of the probe", probe.template)
        self.system = believer.render(built_in_template("instructions"), skills=skills())

    @property
    def prompt(self) -> Prompt:
        """Rendered anew in each round if the template shows the last error, else one text."""
        return self._render if LAST_ERROR in self._template.text else self._render(None, None)

    def _render(self, code: str | None, error: str | None) -> str:
        return self._believer.render(
            self._template, task=self._task, last_code=code, last_error=error
        )


@dataclass(frozen=True, slots=True)
class _Trial:
    """A program that was run, and what it did."""

    program: str
    branch: str
    result: ProgramResult
    opened: tuple[Position, ...]
    arrived: Point | None


class _Trials:
    """Runs programs of a probe, each from the same moment, on a branch of its own."""

    def __init__(self, nest: Nest, probe: Probe, name: str) -> None:
        self._simulator = nest[probe.acts_in]
        self._probe = probe
        self._name = name
        self.done: list[_Trial] = []

    def complaint(self, program: str) -> str | None:
        """Run a program; why it does not work, for the model to read.

        A program that has acted is never sent back, however it ended: what it did is the
        answer, and its error tells of a world that the believer may not know.
        """
        probe, simulator = self._probe, self._simulator
        branch = self._name if not self.done else f"{self._name} attempt {len(self.done) + 1}"
        before = simulator.branch
        simulator.switch(branch)
        try:
            result = simulator.run(probe.agent, program, probe.timeout_ticks)
            if result.killed:
                # Nothing of it was kept; once more, as it need not have been the program's fault.
                result = simulator.run(probe.agent, program, probe.timeout_ticks)
            opened = opened_by(probe.agent, result.events)
            arrived = _standing(simulator.state, probe.agent)
        finally:
            simulator.switch(before)
        self.done.append(_Trial(program, branch, result, opened, arrived))
        error = result.error
        acted = any(event.actor == probe.agent for event in result.events)
        return None if error is None or error.skill is not None or acted else str(error)


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
