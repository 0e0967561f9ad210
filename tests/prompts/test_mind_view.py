"""View of one mind, which everything in its name is made from."""

from pathlib import Path

import pytest

import beliefnest as bn
from beliefnest.prompts.mind_view import MindView

HIDDEN = """
name: hidden
box: [[0, 0, 0], [12, 3, 4]]
blocks:
  - {block: stone, fill: [[0, 0, 0], [12, 0, 4]]}
  - {block: bricks, fill: [[6, 1, 0], [6, 3, 4]]}
containers:
  - {at: [2, 1, 2], items: {apple: 1}}
  - {at: [9, 1, 2], label: red box, looks: candy}
places: {cellar: [10, 1, 2], porch: [4, 1, 2]}
labels: true
agents:
  ann: {position: [4.5, 1, 1.5]}
  bob: {position: [8.5, 1, 1.5]}
script:
  - {agent: ann, program: "await waitTicks(bot, 2);"}
"""


@pytest.fixture
def nest(tmp_path: Path):
    (tmp_path / "hidden.yaml").write_text(HIDDEN)
    with bn.Nest.open(bn.Scenario.load(str(tmp_path / "hidden.yaml")), "scripted") as opened:
        opened.play()
        yield opened


def test_a_view_has_no_member_that_leads_to_the_world():
    members = {name for name in dir(MindView) if not name.startswith("_")}
    read = {"state", "path", "owner", "tick", "observations", "names", "labels", "places", "unique"}
    assert members == read | {"child"}


def test_a_mind_has_names_for_what_it_knows(nest):
    assert nest["/ann"].view.names == {(2, 1, 2): "chest"}
    assert nest["/ann"].view.labels == {}
    assert nest["/ann"].view.places == {"porch": (4, 1, 2)}
    assert nest["/bob"].view.names == {(9, 1, 2): "red box"}
    assert nest["/bob"].view.labels == {(9, 1, 2): "red box, looks as if it held candy"}
    assert nest["/"].view.names == {(2, 1, 2): "chest", (9, 1, 2): "red box"}
    assert nest["/ann"].view.child("bob").names == {}


def test_templates_get_views_and_no_simulators(nest):
    told = nest["/ann"].render("{{ other.names }}", other=nest["/bob"])
    assert told == "{(9, 1, 2): 'red box'}"
    with pytest.raises(bn.BeliefNestError, match=r"<view of /ann at tick 2> has no 'figure'$"):
        nest["/ann"].render("{{ branch.figure }}")
    assert nest["/ann"].render("{{ branch }}") == "<view of /ann at tick 2>"


def test_a_thing_has_the_name_of_what_its_owner_came_to_see(nest):
    world = nest.scripted_world
    world.set_block((9, 1, 2), "barrel")
    for y in (1, 2):
        world.set_block((6, y, 1), "air")
    world.place_agent("ann", (6.5, 1, 1.5))
    assert nest["/ann"].view.names[9, 1, 2] == "barrel"
    assert nest["/bob"].view.names[9, 1, 2] == "red box"
    assert "candy" not in nest["/ann"].render("{{ branch | story }}")
    assert "You could now see Bob and the barrel" in nest["/ann"].render("{{ branch | story }}")
