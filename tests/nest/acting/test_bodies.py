"""Bodies follow changes by hand as their states do (semantics, sections 6 and 7)."""

import pytest

import beliefnest as bn
from beliefnest.worlds.by_name import Worlds

FULL, EMPTY, FLOOR = (2, 1, 2), (4, 1, 2), (4, 1, 4)
ROOM = {
    "name": "room",
    "box": [[0, 0, 0], [6, 3, 6]],
    "blocks": [
        {"block": "stone", "fill": [[0, 0, 0], [6, 0, 6]]},
        {"block": "glass", "at": [5, 1, 5]},
    ],
    "containers": [{"at": list(FULL), "items": {"apple": 3}}, {"at": list(EMPTY), "items": {}}],
    "agents": {"ann": {"position": [1.5, 1, 4.5]}, "bob": {"position": [5.5, 1, 3.5]}},
    "static_blocks": ["stone"],
}
EDITS = {
    "a container where there was none": {"blocks": {FLOOR: "chest"}},
    "a container with contents": {"blocks": {FLOOR: "chest"}, "containers": {FLOOR: {"bread": 2}}},
    "a filled container gone": {"blocks": {FULL: "air"}},
    "a filled container unknown": {"blocks": {FULL: None}},
    "a filled container replaced by a block": {"blocks": {FULL: "stone"}},
    "a filled container replaced by another kind": {"blocks": {FULL: "barrel"}},
    "another kind with the same contents": {
        "blocks": {FULL: "barrel"},
        "containers": {FULL: {"apple": 3}},
    },
    "a filled container turned": {"blocks": {FULL: "chest[facing=east]"}},
    "other contents": {"containers": {FULL: {"emerald": 1}, EMPTY: {"bread": 64}}},
    "no contents": {"containers": {FULL: {}}},
    "blocks": {"blocks": {FLOOR: "oak_planks", (5, 1, 5): None}},
}


@pytest.fixture(scope="module")
def worlds():
    with Worlds(0) as lending:
        yield lending


def check(simulator, path, nest):
    """Compare the body, and a body made anew, with the state."""
    body, state = nest._engine.body(path).snapshot(), simulator.state
    known = {place: state.blocks[place] or "air" for place in state.blocks}
    registry = nest._recording.history.context.registry
    in_body = {p: registry.text(int(body.blocks[body.box.index(p)])) for p in state.blocks}
    assert in_body == known
    assert body.containers == {place: held.items for place, held in state.containers.items()}
    assert body.tick == state.tick == simulator.tick


@pytest.mark.parametrize("kind", ["scripted", "embedded"])
@pytest.mark.parametrize("path", ["/", "/ann"])
def test_a_body_is_what_the_state_is_after_every_kind_of_edit(worlds, kind, path):
    with bn.Nest.open(bn.Scenario.from_mapping(ROOM), world=kind, worlds=worlds) as nest:
        simulator = nest[path]
        names = () if path == "/" else ("ann",)
        for number, (label, edit) in enumerate(EDITS.items()):
            simulator.switch("main" if path == "/" else "base")
            simulator.switch(f"edit {number}")
            simulator.edit(**edit)
            check(simulator, names, nest)
            simulator.step(2)
            check(simulator, names, nest)
            again = f"again {number}"
            simulator.switch(again)
            check(simulator, names, nest)
            assert simulator.branch == again, label


def test_items_can_be_put_into_a_container_that_was_put_there_by_hand():
    world = bn.ScriptedWorld(
        ((0, 0, 0), (6, 2, 6)), agents={"ann": (1.5, 0, 1.5)}, inventories={"ann": {"apple": 1}}
    )
    nest = bn.Nest(world)
    nest["/"].edit(blocks={FLOOR: "chest"})
    world.deposit("ann", FLOOR, {"apple": 1})
    assert nest["/ann"].state.containers[FLOOR].items == {"apple": 1}


def test_an_edit_that_the_body_refuses_has_not_happened(worlds):
    """Contents need a container in Minecraft."""
    with bn.Nest.open(bn.Scenario.from_mapping(ROOM), worlds=worlds) as nest:
        before = dict(nest["/"].state.containers)
        with pytest.raises(bn.WorldError, match=r"\(4, 1, 4\): there is no container, but air"):
            nest["/"].edit(blocks={FULL: "air"}, containers={FLOOR: {"bread": 1}})
        assert dict(nest["/"].state.containers) == before
        assert nest["/"].state.blocks[FULL].startswith("chest")
        check(nest["/"], (), nest)
        nest["/"].edit(containers={FULL: {"bread": 1}})
        assert nest["/ann"].tick == nest.tick == nest["/"].tick
        check(nest["/"], (), nest)
