"""The first thing two histories do not agree on."""

import pytest
from msgspec.structs import replace

from beliefnest.timeline.compare import EntryDifference, first_difference
from beliefnest.timeline.journal import Edit
from beliefnest.world.frames import Frame
from beliefnest.world.values import AgentState, Event, EventKind

SALLY = AgentState((1.0, 2.0, 3.0), inventory={"egg": 1})
TALK = Event(EventKind.CHAT, "sally", {"text": "a"})
FRAME = Frame(5, {"sally": SALLY}, {(1, 2, 3): 4}, {(0, 0, 0): {"egg": 1}}, {}, (TALK,))
BEFORE = [Frame(3), Edit(3, ("sally",), {(0, 0, 0): 1})]


def test_equal_histories_do_not_differ(make_history):
    assert first_difference(iter(make_history(50)), make_history(50)) is None
    assert first_difference([], []) is None


@pytest.mark.parametrize(
    ("changed", "field", "recorded", "found"),
    [
        ({"agents": {"sally": replace(SALLY, position=(1.0, 2.0, 3.5))}},
         "agents.sally.position.2", 3.0, 3.5),
        ({"agents": {"sally": replace(SALLY, inventory={"egg": 2})}},
         "agents.sally.inventory.egg", 1, 2),
        ({"agents": {"sally": None}}, "agents.sally", SALLY, None),
        ({"agents": {}}, "agents.sally", SALLY, None),
        ({"agents": {"sally": SALLY, "anne": SALLY}}, "agents.anne", None, SALLY),
        ({"blocks": {(1, 2, 3): 5}}, "blocks.1,2,3", 4, 5),
        ({"containers": {(0, 0, 0): {}}}, "containers.0,0,0.egg", 1, None),
        ({"events": ()}, "events.0", TALK, None),
        ({"events": (replace(TALK, detail={"text": "b"}),)}, "events.0.detail.text", "a", "b"),
    ],
)  # fmt: skip
def test_the_first_field_is_named(changed, field, recorded, found):
    other = replace(FRAME, **changed)
    after = Frame(9, {"anne": SALLY})
    assert first_difference([*BEFORE, FRAME, after], [*BEFORE, other]) == (
        EntryDifference(5, 2, field, recorded, found)
    )


@pytest.mark.parametrize(
    ("one", "other", "recorded", "found"),
    [
        ([], [FRAME], None, FRAME),
        ([FRAME], [], FRAME, None),
        ([Frame(4)], [FRAME], Frame(4), None),
        ([FRAME], [Frame(4)], None, Frame(4)),
        ([Edit(5, ())], [FRAME], Edit(5, ()), FRAME),
    ],
)
def test_an_entry_of_one_history_alone(one, other, recorded, found):
    difference = first_difference([*BEFORE, *one], [*BEFORE, *other])
    tick = min(entry.tick for entry in (*one, *other))
    assert difference == EntryDifference(tick, 2, "", recorded, found)
