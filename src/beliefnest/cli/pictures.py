"""From an outcome to the words and rows of a picture."""

from collections.abc import Mapping

from beliefnest.belief.entries import PerceivedEvent
from beliefnest.belief.view import State
from beliefnest.nest.face.nest import Nest
from beliefnest.scenarios.outcome import Outcome, ProbeOutcome
from beliefnest.scenarios.scenario import Arrives, Hears, Scenario, Stands
from beliefnest.timeline.journal import Journal
from beliefnest.viewer.scene import Caption, Row, Scene, decisive_tick, read_scene, read_trails
from beliefnest.world.paths import parse_path, path_text
from beliefnest.world.values import EventKind, Position

__all__ = ["container_name", "point_text", "read_outcome_scene", "state_row", "titled"]

_DEEDS: Mapping[EventKind, str] = {
    EventKind.DEPOSIT_ITEM_INTO_CHEST: "puts {items} into {place}",
    EventKind.GET_ITEM_FROM_CHEST: "takes {items} out of {place}",
    EventKind.OPEN_CONTAINER: "opens {place}",
    EventKind.MINE_BLOCK: "mines the block at {place}",
    EventKind.PLACE_BLOCK: "places a block at {place}",
    EventKind.USE_LEVER: "uses the lever at {place}",
    EventKind.PRESS_BUTTON: "presses the button at {place}",
    EventKind.GIVE_ITEM_TO_OTHER: "gives {items} to {other}",
    EventKind.RECEIVE_ITEM_FROM_OTHER: "receives {items} from {other}",
}


def read_outcome_scene(nest: Nest, journal: Journal, outcome: Outcome) -> Scene:
    """The scene of the decisive moment of a run whose nest is still open.

    Args:
        nest: After the script.
        journal: The timelines it has recorded.
        outcome: What came of it.
    """
    scenario = outcome.scenario
    tick = decisive_tick(nest)
    title = scenario.name
    if scenario.condition is not None:
        title += f", condition {scenario.condition}"
    caption = Caption(
        title=title,
        subtitle=scenario.condition_description or scenario.description,
        moment=_moment(outcome.reality, tick, scenario),
        verdicts=tuple(_verdict(probe, scenario) for probe in outcome.probes),
        story=tuple(step.label for step in scenario.setting.script),
    )
    rows = [
        state_row(state.path, state, _held(state, outcome), _notes(state, outcome))
        for state in (outcome.reality, *outcome.beliefs.values())
    ]
    trails = read_trails(journal, scenario.setting.snapshot, tick)
    return read_scene(nest, tick, caption, scenario.labels, _viewers(scenario), rows, trails)


def container_name(place: Position, scenario: Scenario) -> str:
    """What people call a container."""
    return scenario.labels.get(place, f"({', '.join(map(str, place))})")


def point_text(point: tuple[float, float, float]) -> str:
    """A place for people."""
    return f"({', '.join(f'{value:.1f}' for value in point)})"


def titled(name: str) -> str:
    """An agent's name at the start of a sentence."""
    return name[:1].upper() + name[1:]


def _viewers(scenario: Scenario) -> tuple[str, ...]:
    """The agents of the first probe's belief, or else of the deepest belief that is named."""
    agents = scenario.setting.snapshot.agents
    asked = [probe.path for probe in scenario.probes[:1]]
    expected = [each.path for each in scenario.expectations]
    paths = [parse_path(path, agents) for path in asked or expected]
    return max(paths, key=len, default=())


def _moment(state: State, tick: int, scenario: Scenario) -> str:
    deeds = [event for event in state.events if event.tick == tick and event.kind in _DEEDS]
    return f"Tick {tick}: {_deed(deeds[-1], scenario)}." if deeds else f"Tick {tick}."


def _deed(event: PerceivedEvent, scenario: Scenario) -> str:
    detail = event.detail
    place = ""
    if "position" in detail:
        x, y, z = detail["position"]
        name = container_name((x, y, z), scenario)
        place = name if name.startswith("(") else f"the {name}"
    items = ", ".join(
        f"{count} {name.replace('_', ' ')}" for name, count in detail.get("items", {}).items()
    )
    words = _DEEDS[event.kind].format(items=items, place=place, other=detail.get("other", ""))
    return f"{titled(event.actor or 'somebody')} {words}"


def state_row(
    path: tuple[str, ...], state: State, ok: bool | None, notes: tuple[str, ...] = ()
) -> Row:
    """The row of a simulator: what it holds of the containers, and other things of note."""
    return Row(
        label=" that ".join(f"{titled(name)} believes" for name in path) or "In reality",
        path=path_text(path),
        contents={place: held.items for place, held in state.containers.items()},
        complete=frozenset(place for place, held in state.containers.items() if held.complete),
        ok=ok,
        notes=notes,
    )


def _notes(state: State, outcome: Outcome) -> tuple[str, ...]:
    """What a simulator holds of the agents and words that something is expected of."""
    notes = []
    for each in outcome.expectations:
        content = each.expectation.content
        if outcome.state(each.expectation.path) is not state:
            continue
        if isinstance(content, Stands):
            place = state.agents[content.agent].position
            notes.append(f"{content.agent} {'anywhere' if place is None else point_text(place)}")
        elif isinstance(content, Hears):
            heard = any(content.text in text for _, _, text in state.chat)
            notes.append(f"{content.text}: {'' if heard else 'not '}heard")
    return tuple(notes)


def _held(state: State, outcome: Outcome) -> bool | None:
    """Whether a simulator holds all that is expected of it; None: nothing is."""
    verdicts = [
        each.ok for each in outcome.expectations if outcome.state(each.expectation.path) is state
    ]
    return all(verdicts) if verdicts else None


def _verdict(outcome: ProbeOutcome, scenario: Scenario) -> tuple[str, bool | None]:
    agent = titled(outcome.probe.agent)
    if isinstance(outcome.probe.expect, Arrives):
        where = "nowhere" if outcome.arrived is None else point_text(outcome.arrived)
        deed = f"{agent} goes to {where}"
    elif outcome.opened:
        deed = f"{agent} opens the {container_name(outcome.opened[0], scenario)}"
    else:
        deed = f"{agent} opens nothing"
    reported = f"{scenario.reported_by} reports" if scenario.reported_by else "expected"
    judged = {True: f", as {reported}", False: f", not as {reported}", None: ""}[outcome.ok]
    return f"Predicted: {deed}{judged}", outcome.ok
