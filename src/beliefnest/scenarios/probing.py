"""Probing of a model: ask for a program, run and judge it, and ask questions."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

import msgspec

from beliefnest.belief.view import State
from beliefnest.errors import ModelError, TemplateError
from beliefnest.llm.asking import NoUsableProgramError, Prompt, Round, ask_for_program, asked_again
from beliefnest.llm.failures import UnusableAnswerError
from beliefnest.llm.messages import Model, Sampling, Usage
from beliefnest.llm.model_settings import ModelSettings
from beliefnest.nest.face.nest import Nest
from beliefnest.nest.face.simulator import Simulator
from beliefnest.prompts import instructions
from beliefnest.prompts.rendering import LAST_ERROR
from beliefnest.scenarios.content import Probe
from beliefnest.scenarios.expected import Deed, Judgement
from beliefnest.scenarios.expected_answers import Answers
from beliefnest.scenarios.expected_kinds import Infers
from beliefnest.scenarios.inferring import Inferred, Inferring
from beliefnest.scenarios.judging import outcome_of
from beliefnest.scenarios.naming import Naming
from beliefnest.scenarios.outcome import ProbeOutcome, Reply
from beliefnest.scenarios.questioning import ask_question
from beliefnest.scenarios.trial import Trial
from beliefnest.skills import SkillDetail, skills_at


class Asking(msgspec.Struct, frozen=True):
    """Options of requests to a model.

    Attributes:
        attempts: Greatest number of requests for one probe; failed programs are sent back.
        sampling: Sampling options of answers.
        settings: Settings of requests that the user chose; `sampling` contains their limit on the
            length of an answer.
    """

    attempts: int = 3
    sampling: Sampling = msgspec.field(default_factory=Sampling)
    settings: ModelSettings = msgspec.field(default_factory=ModelSettings)


class _Programs(msgspec.Struct, frozen=True):
    """Result of asking for a program.

    Attributes:
        attempts: All rounds with an answer.
        trial: Run of the program; None: there is none.
        verdicts: Judgements of the run.
        fault: Why there is no program; empty: there is one.
        outcome: Outcome of a probe without a program; empty: there is one.
        usage: Usage of a request without an answer.
    """

    attempts: tuple[Round, ...]
    trial: Trial | None
    verdicts: tuple[Judgement, ...]
    fault: str = ""
    outcome: str = ""
    usage: Usage = msgspec.field(default_factory=Usage)

    @property
    def last(self) -> Round | None:
        """Return the last round with a program, or else the last one; None: there is none."""
        with_program = [each for each in self.attempts if each.program is not None]
        return (with_program or self.attempts)[-1] if self.attempts else None


def run_probe(
    nest: Nest, number: int, probe: Probe, model: Model, seed: int, asking: Asking
) -> ProbeOutcome:
    """Ask a model for a probe; run its program and judge the results.

    Args:
        nest: The nest after the script.
        number: Number of the probe, from 1; names of branches contain it.
        probe: The probe.
        model: The model.
        seed: Seed of the order of options.
        asking: Options of requests.

    Raises:
        ModelError: The model cannot be asked. An answer that is missing or cannot be used is no
            error, but an outcome.
        BodyError: The Minecraft side died.
        ScenarioError: The inference does not fit the events, or a belief gives no right answer.
    """
    if probe.infer is not None:
        return _infer(nest, probe, probe.infer)
    probe = resolved(nest, probe)
    believer, name = nest[probe.path], f"probe {number}"
    programs = _Programs((), None, ())
    if probe.asks_for_program:
        noting = asking.settings.around(believer.noting(model, probe=name, task=probe.task))
        with _naming(probe):
            programs = _ask_for_program(nest, number, probe, noting, asking)
    replies: dict[Answers, Reply] = {}
    usage = sum((each.answer.usage for each in programs.attempts), programs.usage)
    for question in probe.questions:
        noting = asking.settings.around(believer.noting(model, probe=name, task=question.question))
        with _naming(probe):
            replies[question], used = ask_question(
                nest, probe, question, noting, seed, asking.sampling, asking.settings
            )
        usage += used
    judged = iter(programs.verdicts)
    verdicts = tuple(
        each.judge(replies[each]) if isinstance(each, Answers) else next(judged)
        for each in probe.expect
    )
    trial = programs.trial
    result = None if trial is None else trial.result
    last = programs.last
    return ProbeOutcome(
        probe=probe,
        verdicts=verdicts,
        outcome=programs.outcome or outcome_of(verdicts, result),
        usage=usage,
        prompt="" if last is None else last.messages[-1].text,
        answer="" if last is None else last.answer.text,
        program="" if trial is None else trial.program,
        attempts=len(programs.attempts),
        asked_again=asked_again(programs.attempts)
        + sum(each.asked_again for each in replies.values()),
        trial=trial,
        replies=tuple(replies.values()),
        fault=programs.fault,
    )


@contextmanager
def _naming(probe: Probe) -> Iterator[None]:
    """Name file, line and probe in errors of its template."""
    try:
        yield
    except TemplateError as error:
        raise TemplateError(f"{probe.where}{error}") from error


def resolved(nest: Nest, probe: Probe) -> Probe:
    """Return a probe with the right answers that the nest computes.

    Raises:
        ScenarioError: A belief gives no right answer; the message names file, line and key.
    """
    in_words = any(not question.options for question in probe.questions)
    if not in_words and all(each.paths == () for each in probe.expect):
        return probe
    naming = naming_for(nest, probe)
    expect = tuple(each.resolved(lambda path: nest[path].state, naming) for each in probe.expect)
    return replace(probe, expect=expect)


def naming_for(nest: Nest, probe: Probe) -> Naming:
    """Return the names by which the answers to a probe are given."""
    return Naming.of(nest[probe.path].view, nest.setting)


def _infer(nest: Nest, probe: Probe, infer: Inferring) -> ProbeOutcome:
    """Infer what an agent wants and believes, and hold that against what was expected."""
    inferred = Inferred.of(infer.inference(nest[probe.path]))
    verdicts = tuple(
        each.judge(inferred.means, inferred.impossible)
        for each in probe.expect
        if isinstance(each, Infers)
    )
    return ProbeOutcome(
        probe=probe,
        verdicts=verdicts,
        outcome=outcome_of(verdicts, None),
        usage=Usage(),
        fault=inferred.impossible or "",
        inferred=inferred,
    )


def _ask_for_program(
    nest: Nest, number: int, probe: Probe, model: Model, asking: Asking
) -> _Programs:
    trials = _Trials(nest, probe, f"probe {number}")
    prompts = _Prompts(nest[probe.path], probe, asking.settings.skills)
    rounds: list[Round] = []
    try:
        attempts = ask_for_program(
            model,
            prompts.prompt,
            trials.complaint,
            asking.attempts,
            system=prompts.system,
            sampling=asking.sampling,
            retry_unread=asking.settings.retry_unread,
            on_round=rounds.append,
        ).attempts
    except NoUsableProgramError as error:
        # If there were programs, the run of the last one is the result.
        attempts = error.attempts
        if not trials.done:
            return _without_program(probe, attempts, error, error.outcome, Usage())
    except UnusableAnswerError as error:
        attempts = tuple(rounds)
        if not trials.done:
            return _without_program(probe, attempts, error, "no_answer", error.usage)
    return _Programs(attempts, *trials.done[-1])


def _without_program(
    probe: Probe, attempts: tuple[Round, ...], error: ModelError, outcome: str, usage: Usage
) -> _Programs:
    replies = tuple(
        Judgement(each, ok=False, why_not="there is no program", outcome=outcome)
        for each in probe.expect
        if isinstance(each, Deed)
    )
    return _Programs(attempts, None, replies, str(error), outcome, usage)


class _Prompts:
    """Prompts of a probe: instructions, and the content of the belief."""

    def __init__(self, believer: Simulator, probe: Probe, detail: SkillDetail) -> None:
        self._believer = believer
        self._task = probe.task
        self._template = probe.template_or("paper")
        self.system = instructions(skills_at(detail))

    @property
    def prompt(self) -> Prompt:
        """Return the prompt; a template that shows the last error is rendered for each request."""
        return self._render if LAST_ERROR in self._template.text else self._render(None, None)

    def _render(self, code: str | None, error: str | None) -> str:
        return self._believer.render(
            self._template, task=self._task, last_code=code, last_error=error, instructed=True
        )


class _Trials:
    """Runner of a probe's programs, each from the same tick on its own branch."""

    def __init__(self, nest: Nest, probe: Probe, name: str) -> None:
        self._nest = nest
        self._simulator = nest[probe.acts_in]
        self._probe = probe
        self._name = name
        self.done: list[tuple[Trial, tuple[Judgement, ...]]] = []

    def complaint(self, program: str) -> str | None:
        """Run a program; return an error for the model to read, or None.

        A program that has acted is never sent back, even if it failed: its acts are the answer,
        and its error may reveal a world that the believer does not know.
        """
        probe, simulator = self._probe, self._simulator
        branch = self._name if not self.done else f"{self._name} attempt {len(self.done) + 1}"
        before = simulator.branch
        simulator.switch(branch)
        try:
            result = simulator.run(probe.agent, program, probe.timeout_ticks, probe.senses)
            if result.killed:
                # The world died and nothing was recorded. Try again: the program may be innocent.
                result = simulator.run(probe.agent, program, probe.timeout_ticks, probe.senses)
            trial = Trial(
                agent=probe.agent,
                program=program,
                branch=branch,
                result=result,
                state=simulator.state,
                belief=self._belief,
            )
            verdicts = tuple(each.judge(trial) for each in probe.expect if isinstance(each, Deed))
        finally:
            simulator.switch(before)
        self.done.append((trial, verdicts))
        error = result.error
        acted = any(event.actor == probe.agent for event in result.events)
        return None if error is None or error.skill is not None or acted else str(error)

    def _belief(self, path: str) -> State:
        return self._nest[path].state
