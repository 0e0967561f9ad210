"""Doors of pages: what the page of a run shows of a simulator, and the page of a participant.

Blocks and poses are on the page of a run as differences from the world; they are those of the
state, which has a door of its own.
"""

from tests.noninterference.doors import door
from tests.noninterference.pairs import AGENTS, Played

from beliefnest.plan.scenario_cells import Cell, CellKey
from beliefnest.scenarios.content import Probe
from beliefnest.scenarios.expected_answers import Answers
from beliefnest.scenarios.scenario import Scenario
from beliefnest.studies.participants.items import Item, ItemQuestion
from beliefnest.studies.participants.playing import view_of
from beliefnest.studies.participants.running import experiment
from beliefnest.timeline.journal import TimelineKey
from beliefnest.viewer.page.reasons import look_of, sight_of
from beliefnest.viewer.page.run import About, RunData
from beliefnest.world.paths import parse_path

_KEY = TimelineKey((), "main")
_OWN = ("contents", "owns", "items")
"""Rows of a track that are not told as differences from the world."""


@door(every=4)
def pages(world: Played, path: str) -> object:
    """Return the words, claims, contents and views that the page of the run shows."""
    reader, asked = world.nest.reader, parse_path(path, world.nest.agents)
    page = RunData(reader, About("pair", labels=reader.setting.labels, paths=(asked,)), 0).update()
    line = page["timelines"]["0"]
    track, (_, events) = line["tracks"][path], line.get("events", (0, []))
    # Verdicts (false, a lie) are for the reader of the page.
    told = [{**event, "claims": [c[0] for c in event.get("claims", [])]} for event in events]
    heard = [told[number] for number in track.get("heard", (0, []))[1]]
    verdicts = [(told[number], *more) for number, *more in track.get("claims", (0, []))[1]]
    numbers = range(len(AGENTS))
    looks = [
        look_of(reader, _KEY, asked, world.nest.tick, viewer, f"agent-{number}")
        for viewer in AGENTS
        for number in numbers
        if AGENTS[number] != viewer
    ]
    sights = [sight_of(reader, _KEY, asked, world.nest.tick, viewer) for viewer in AGENTS]
    rows = {name: told for name, told in track.items() if name.startswith(_OWN)}
    return heard, verdicts, rows, looks, sights


@door(every=10)
def participants(world: Played, path: str) -> object:
    """Return everything of an item that a participant is shown and asked."""
    asked = Answers("Where?", ("here",), ("there", "here"))
    probe = Probe(path=path, acts_in=path, agent="ann", task="", expect=(asked,))
    key = CellKey("pair", "", None, {}, "people", "", 1, {})
    cell = Cell(key, Scenario(world.nest.setting, probes=(probe,)))
    item = Item("item", cell, (ItemQuestion(0, 0, asked),))
    return experiment([(item, [view_of(world.nest, path, 0, "both")])], "both", 0)
