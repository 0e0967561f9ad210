"""Pictures of conditions: the values to draw, read from an outcome."""

from collections.abc import Sequence
from functools import partial

from msgspec.structs import replace

from beliefnest.belief.grounds import told_text
from beliefnest.belief.view import State
from beliefnest.facts.states import StateFacts
from beliefnest.nest.explain.comparison import false_things
from beliefnest.nest.face.nest import Nest
from beliefnest.pictures.overview import Card, ConditionPicture, Note
from beliefnest.pictures.palette import Mark
from beliefnest.pictures.scene import Scene, Wrong, best_height, read_stores
from beliefnest.scenarios.expected_acts import Arrives
from beliefnest.scenarios.expected_answers import Answers
from beliefnest.scenarios.expected_kinds import Infers
from beliefnest.scenarios.inferring import means_text
from beliefnest.scenarios.naming import container_name, place_name
from beliefnest.scenarios.outcome import Outcome, ProbeOutcome
from beliefnest.scenarios.scenario import Scenario
from beliefnest.timeline.store import Journal
from beliefnest.viewer.figures.drawing import wrong_things
from beliefnest.world.frames import Frame, Snapshot
from beliefnest.world.paths import parse_path, path_text
from beliefnest.world.words import listed, titled, with_the


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
        trails=read_trails(journal, scenario.setting.snapshot, tick),
        cards=tuple(cards),
        story=tuple(step.label for step in scenario.setting.script),
    )


def read_trails(
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
