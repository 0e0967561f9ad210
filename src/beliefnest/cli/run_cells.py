"""Cells of a run: one for each model, repeat and condition; what came of them, told and drawn."""

import re
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from msgspec.structs import replace

from beliefnest.belief.grounds import told_text
from beliefnest.belief.view import State
from beliefnest.cli.console import progress_on
from beliefnest.cli.folder import ConditionFolder
from beliefnest.cli.gallery import Gallery
from beliefnest.cli.report import outcome_json
from beliefnest.cli.visits import visited
from beliefnest.facts.states import StateFacts
from beliefnest.nest.explain.comparison import false_things
from beliefnest.nest.face.nest import Nest
from beliefnest.pictures.overview import Card, ConditionPicture, Note
from beliefnest.pictures.palette import Mark
from beliefnest.pictures.scene import Scene, Wrong, best_height, read_stores
from beliefnest.plan.scenario_cells import Cell, CellKey, content_of
from beliefnest.plan.terms import PlayStage
from beliefnest.scenarios.expected_acts import Arrives
from beliefnest.scenarios.expected_answers import Answers
from beliefnest.scenarios.expected_kinds import Infers
from beliefnest.scenarios.inferring import means_text
from beliefnest.scenarios.naming import container_name, place_name
from beliefnest.scenarios.outcome import Outcome, ProbeOutcome
from beliefnest.scenarios.scenario import Scenario
from beliefnest.timeline.store import Journal
from beliefnest.viewer.figures.drawing import wrong_things
from beliefnest.world.event_words import happens, is_lid
from beliefnest.world.frames import Frame, Snapshot
from beliefnest.world.paths import parse_path, path_text
from beliefnest.world.values import Position
from beliefnest.world.words import listed, titled, with_the


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
            reports = _accounts(nest, outcome)
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


_MOST = 40
"""Greatest number of events listed for a probe; earlier ones are left out."""


def _accounts(nest: Nest, outcome: Outcome) -> list[dict[str, list[str]]]:
    """Return `happened`, `judged` and `why` for each probe, each as a list of lines.

    Args:
        nest: The nest after the probes, still open.
        outcome: Outcome of the condition.
    """
    return [
        {
            "happened": _happened(probe, outcome.scenario.labels),
            "judged": [
                each.expected.account(
                    each, probe, outcome.scenario.setting, titled(probe.probe.agent)
                )
                for each in probe.verdicts
            ]
            or ["Nothing was expected; it is only recorded."],
            "why": _why(nest, probe, outcome),
        }
        for probe in outcome.probes
    ]


def _happened(probe: ProbeOutcome, labels: Mapping[Position, str]) -> list[str]:
    if probe.trial is None:
        return [probe.fault] if probe.fault else []
    events = [
        f"tick {tick}: {happens(event, labels)}"
        for tick, event in probe.result.happened
        if not is_lid(event)
    ]
    lines = events[-_MOST:]
    if len(events) > _MOST:
        lines.insert(0, f"{len(events) - _MOST} earlier events are left out")
    result = probe.result
    began = probe.trial.state.tick - result.ticks
    ended = "ended well" if result.ok else f"failed: {result.error}"
    span = f"it ran from tick {began} to tick {began + result.ticks}"
    return [*lines, f"the program {ended}; {span}"]


def _why(nest: Nest, outcome: ProbeOutcome, run: Outcome) -> list[str]:
    """Explain the facts in the probed belief that the scenario states expectations about."""
    belief = nest.at(run.reality.tick)[outcome.probe.path]
    lines: list[str] = []
    about = [
        each.expectation.fact
        for each in run.expectations
        if nest[each.expectation.simulator].path == belief.path
    ]
    places = [each.store for each in about if each.store is not None]
    places += [each.explained for each in outcome.probe.expect if each.explained is not None]
    for container in dict.fromkeys(places):
        lines += belief.explain(container=container).lines
    for agent in dict.fromkeys(each.placed for each in about if each.placed is not None):
        lines += belief.explain(agent=agent).lines
    return lines


def read_condition(nest: Nest, journal: Journal, outcome: Outcome) -> ConditionPicture:
    """Return the picture of a condition at the end of its script.

    Args:
        nest: The nest after the script, still open.
        journal: Recorded timelines of the nest.
        outcome: Outcome of the condition.
    """
    scenario = outcome.scenario
    title = scenario.name
    if scenario.condition is not None:
        title += f", condition {scenario.condition}"
    tick = outcome.reality.tick
    viewers = _viewers(scenario)
    (scene,) = nest.scenes("/", tick, sight=viewers)
    cards = [_state_card(state, outcome) for state in (outcome.reality, *outcome.beliefs.values())]
    cards += [_prediction_card(probe, scenario) for probe in outcome.probes]
    return ConditionPicture(
        title=title,
        about=scenario.condition_description or scenario.description,
        scene=_with_ghosts(scene, outcome, viewers),
        trails=_read_trails(journal, scenario.setting.snapshot, tick),
        cards=tuple(cards),
        story=tuple(step.label for step in scenario.setting.script),
    )


def _read_trails(
    journal: Journal, start: Snapshot, tick: int
) -> dict[str, tuple[tuple[float, float], ...]]:
    """Return the trails of the agents in the real world: positions (x, z), oldest first.

    Args:
        journal: Recorded timelines of the run.
        start: Snapshot of the first tick.
        tick: Last tick to read.
    """
    trails = {name: [agent.position] for name, agent in start.agents.items()}
    key = next(info.key for info in journal.timelines() if not info.key.path)
    for entry in journal.entries(key, 0, journal.entries_until(key, tick)):
        if isinstance(entry, Frame):
            for name, agent in entry.agents.items():
                if agent is not None:
                    trails.setdefault(name, []).append(agent.position)
    return {name: tuple((x, z) for x, _, z in points) for name, points in trails.items()}


def _viewers(scenario: Scenario) -> tuple[str, ...]:
    """Return the path of the first probe, or of the deepest expectation if there is no probe."""
    agents = scenario.setting.snapshot.agents
    asked = [probe.path for probe in scenario.probes[:1]]
    expected = [each.simulator for each in scenario.expectations]
    paths = [parse_path(path, agents) for path in asked or expected]
    return max(paths, key=len, default=())


def _wrong_in(state: State, outcome: Outcome) -> list[Wrong]:
    return wrong_things(false_things(outcome.reality, state)) if state.path else []


def _with_ghosts(scene: Scene, outcome: Outcome, viewers: Sequence[str]) -> Scene:
    """Return a scene with ghosts: wrong positions at which the first viewer believes the others."""
    state = outcome.beliefs.get(f"/{viewers[0]}") if viewers else None
    if state is None:
        return scene
    wrong = {each.where for each in _wrong_in(state, outcome) if not each.is_owned}
    ghosts = []
    for person in scene.people:
        believed = state.agents[person.name].position
        if person.name in viewers[1:] and person.name in wrong:
            ghosts.append(
                replace(person, position=believed, mark=Mark.FALSE, believer=viewers[0], above=0)
            )
    return replace(scene, people=(*scene.people, *ghosts))


def _state_card(state: State, outcome: Outcome) -> Card:
    """Return a card with what a simulator believes about containers and expected facts."""
    wrong = _wrong_in(state, outcome)
    by_place = {each.where: each for each in wrong if not each.is_owned}
    stores = read_stores(state, best_height([state]), outcome.scenario.labels, by_place)
    agents = _agents_told(outcome)
    heard = _heard(state, outcome)
    if not (stores or agents or heard):
        agents = tuple(state.agents)
    notes = [Note(_place_words(name, state, outcome.scenario), name in by_place) for name in agents]
    notes += [Note(f"{each.where} has {each.held}", false=True) for each in wrong if each.is_owned]
    return Card(
        title=" that ".join(f"{titled(name)} believes" for name in state.path) or "In reality",
        path=path_text(state.path),
        ok=_held(state, outcome),
        stores=stores,
        notes=(*notes, *heard),
    )


def _agents_told(outcome: Outcome) -> tuple[str, ...]:
    """Return the agents about whose positions the scenario states expectations."""
    placed = [each.expectation.fact.placed for each in outcome.expectations]
    return tuple(dict.fromkeys(agent for agent in placed if agent is not None))


def _heard(state: State, outcome: Outcome) -> list[Note]:
    """Return a note for each utterance that the scenario states expectations about."""
    facts, named = StateFacts(state), partial(container_name, setting=outcome.scenario.setting)
    expected = [each.expectation.fact for each in outcome.expectations]
    notes = [each.found(facts, named) for each in expected if each.noted]
    return [Note(f"{what}: {there}") for what, there in dict.fromkeys(notes)]


def _place_words(name: str, state: State, scenario: Scenario) -> str:
    agent = state.agents[name]
    if agent.position is None:
        return f"{name}: place not known"
    where = f"at {place_name(agent.position, scenario.setting)}"
    if agent.current or agent.basis is None:
        return f"{name}: {where}"
    basis = agent.basis
    source = told_text(basis.source, basis.speaker or "a sign", state.tick - basis.observed_at)
    return f"{name}: {where}, {source}"


def _held(state: State, outcome: Outcome) -> bool | None:
    """Return True if a simulator meets all expectations about it; None: there are none."""
    expectations = outcome.expectations
    own = [each for each in expectations if outcome.state(each.expectation.simulator) is state]
    verdicts = [each.ok for each in own]
    return all(verdicts) if verdicts else None


def _right(outcome: ProbeOutcome) -> str:
    """Return the right answers to questions with other answers, in words."""
    wrong = [each.expected for each in outcome.verdicts if not each.ok]
    right = [
        listed([repr(text) for text in each.right], "or")
        for each in wrong
        if isinstance(each, Answers)
    ]
    return f" (right: {' and '.join(right)})" if right else ""


def _prediction_card(outcome: ProbeOutcome, scenario: Scenario) -> Card:
    """Return a card with the prediction of a probe, and if it is as expected."""
    probe = outcome.probe
    agent = titled(probe.agent or "reality")
    if outcome.inferred is not None:
        factors = [each.factor for each in probe.expect if isinstance(each, Infers)]
        deed = means_text(outcome.inferred.means, factors)
    elif outcome.trial is None:
        answers = [repr(reply.answer) for reply in outcome.replies if reply.answer]
        deed = f"The model answers {' and '.join(answers) or 'nothing'}{_right(outcome)}"
    elif any(isinstance(each, Arrives) for each in probe.expect):
        deed = f"{agent} ends nowhere"
        if outcome.arrived is not None:
            deed = f"{agent} ends at {place_name(outcome.arrived, scenario.setting)}"
    elif outcome.opened:
        deed = f"{agent} opens {with_the(container_name(outcome.opened[0], scenario.setting))}"
    else:
        deed = f"{agent} opens nothing"
    reported = f"{scenario.reported_by} reports" if scenario.reported_by else "expected"
    judged = {True: f", as {reported}", False: f", not as {reported}", None: ""}[outcome.ok]
    label = f"Probe: {probe.label}" if probe.label else "Probe"
    task = " ".join(probe.asked.split())
    return Card(
        title=label,
        path=f"{'asked of' if probe.asks_model else 'inferred from'} {probe.path}"
        + (f", acted out in {probe.acts_in}" if probe.asks_for_program else ""),
        ok=outcome.ok,
        notes=(Note(f"\u201c{task}\u201d" if probe.asks_model else task), Note(f"{deed}{judged}")),
        prediction=True,
    )
