"""Doors in the scripted world: who uses them, what becomes of them, who sees it."""

import pytest

import beliefnest as bn
from beliefnest.timeline.events import event_from
from beliefnest.world.values import Event, EventKind

SHUT = "oak_door[facing=north,half={},hinge=left,open=false,powered=false]"
DOOR, TRAP, GATE, IRON = (5, 1, 5), (1, 1, 1), (7, 1, 5), (3, 1, 5)
WALL = {(x, y, 5): "stone" for x in range(11) for y in (1, 2, 3)}
BLOCKS = {
    **WALL,
    DOOR: SHUT.format("lower"),
    (5, 2, 5): SHUT.format("upper"),
    TRAP: "oak_trapdoor[facing=north,half=bottom,open=false,powered=false,waterlogged=false]",
    GATE: "oak_fence_gate[facing=north,in_wall=false,open=false,powered=false]",
    IRON: SHUT.format("lower").replace("oak", "iron"),
}


def world_of():
    agents = {"ann": (4.5, 1, 3.5), "bob": (6.5, 1, 3.5), "eve": (5.5, 1, 8.5)}
    return bn.ScriptedWorld(((0, 0, 0), (10, 4, 10)), BLOCKS, agents)


@pytest.mark.parametrize("used", [DOOR, (5, 2, 5)])
def test_both_halves_move_and_the_act_is_told_once_at_the_lower_one(used):
    world, frames = world_of(), []
    world.listen(frames.append)
    world.use_door("ann", used, open=True)
    (frame,) = frames
    assert sorted(frame.blocks) == [DOOR, (5, 2, 5)]
    acts = [event for event in frame.events if event.kind is EventKind.USE_DOOR]
    assert acts == [Event(EventKind.USE_DOOR, "ann", {"position": DOOR, "open": True})]
    nest = bn.Nest(world)
    assert "open=true" in nest["/"].state.blocks[DOOR]
    world.use_door("bob", DOOR, open=False)
    assert nest["/"].state.blocks[(5, 2, 5)] == SHUT.format("upper")


def test_trapdoors_and_gates_are_used_as_doors_are():
    world = world_of()
    nest = bn.Nest(world)
    for place in (TRAP, GATE):
        world.use_door("ann", place, open=True)
        assert "open=true" in nest["/"].state.blocks[place]


@pytest.mark.parametrize(
    ("place", "opens", "fault"),
    [
        (DOOR, False, "the oak_door at .* is shut already"),
        (IRON, True, "iron_door at .* is not moved by hand"),
        ((0, 1, 5), True, "no door, trapdoor or gate at .*, but stone"),
        ((99, 1, 5), True, "outside the box"),
    ],
)
def test_an_impossible_use_is_an_error_and_changes_nothing(place, opens, fault):
    world = world_of()
    before = world.snapshot()
    with pytest.raises(bn.WorldError, match=fault):
        world.use_door("ann", place, open=opens)
    assert world.now == before.tick
    assert world.snapshot().blocks == before.blocks


def test_who_sees_the_actor_sees_the_door_used_and_prompts_and_explanations_say_so():
    world = world_of()
    nest = bn.Nest(world, perception=bn.Perception(hearing="sight"))
    nest["/bob"].state, nest["/eve"].state
    world.use_door("ann", DOOR, open=True)
    assert [event.kind for event in nest["/bob"].state.events].count(EventKind.USE_DOOR) == 1
    row = "1;openDoor;ann;door:(5, 1, 5)"
    assert row in nest["/bob"].render("{{ branch | events }}")
    assert "ann opened it" in str(nest["/bob"].explain(block=DOOR))
    world.use_door("ann", DOOR, open=False)
    assert "2;closeDoor;ann;door:(5, 1, 5)" in nest["/bob/ann"].render("{{ branch | events }}")
    # Eve saw the door move, and nobody beside it.
    assert EventKind.USE_DOOR not in [event.kind for event in nest["/eve"].state.events[-1:]]


def test_a_trace_tells_who_used_which_door_how():
    detail = {"position": [5, 1, 5], "open": False}
    event = event_from("use_door", "ann", detail, {"ann"})
    assert event == Event(EventKind.USE_DOOR, "ann", {"position": (5, 1, 5), "open": False})
    with pytest.raises(bn.InputError, match="lacks the detail open"):
        event_from("use_door", "ann", {"position": [5, 1, 5]}, {"ann"})
