"""Speech, thought and who is credited with hearing them (semantics, sections 3 and 5.5)."""

import pytest
from tests.nest.places import CLOSED, CORNER, EAST, GAP, MEETING, WEST, nest_of

import beliefnest as bn


def chat(nest, path):
    return tuple(nest[path].state.chat)


def test_5_5_global_everyone_hears_at_every_depth_present_or_not():
    world, nest = nest_of({"a": WEST, "b": EAST, "c": (8.5, 0, 8.5)}, CLOSED)
    world.say("b", "hello")
    for path in ("/", "/a", "/b", "/c", "/a/b", "/a/c/b", "/b/a/c", "/a/b/a"):
        assert chat(nest, path) == ((1, "b", "hello"),)


def test_5_5_global_is_the_default():
    world, nest = nest_of({"a": WEST, "b": EAST}, CLOSED)
    world.say("b", "hello")
    assert chat(nest, "/a") == ((1, "b", "hello"),)


def test_5_5_sight_an_agent_hears_whom_it_sees():
    world, nest = nest_of({"a": WEST, "b": EAST, "c": GAP}, CORNER, hearing="sight")
    world.say("b", "hello")
    assert chat(nest, "/b") == chat(nest, "/c") == ((1, "b", "hello"),)
    assert chat(nest, "/a") == ()


def test_5_5_sight_a_listener_must_be_present():
    agents = {"observer": WEST, "sally": MEETING, "anne": GAP}
    world, nest = nest_of(agents, CORNER, hearing="sight")
    world.say("anne", "one")
    world.place_agent("sally", EAST)
    world.say("anne", "two")
    assert (
        chat(nest, "/sally") == chat(nest, "/observer") == ((1, "anne", "one"), (3, "anne", "two"))
    )
    assert chat(nest, "/observer/sally") == ((1, "anne", "one"),)


def test_5_5_an_utterance_is_credited_to_its_speaker_whom_nobody_sees():
    """The observer hears Sally through the wall, and Carl as well, whom it sees."""
    agents = {"observer": (4.5, 0, 1.5), "sally": (6.5, 0, 1.5), "carl": (3.5, 0, 1.5)}
    world, nest = nest_of(agents, CLOSED, hearing={"radius": 5})
    world.say("sally", "hello")
    assert not nest["/observer"].state.agents["sally"].current
    for path in ("/observer", "/observer/sally", "/sally", "/carl/sally"):
        assert chat(nest, path) == ((1, "sally", "hello"),), path
    for path in ("/observer/carl", "/observer/sally/carl", "/observer/carl/sally"):
        assert chat(nest, path) == (), path


def test_5_5_a_whisper_is_credited_to_both_by_who_perceives_it():
    agents = {"anne": (4.5, 0, 1.5), "sally": (6.5, 0, 1.5), "carl": (3.5, 0, 1.5)}
    world, nest = nest_of(agents, CLOSED, hearing={"radius": 5})
    world.whisper("sally", "anne", "psst")
    for path in ("/anne", "/sally", "/anne/sally", "/sally/anne", "/anne/sally/anne"):
        assert chat(nest, path) == ((1, "sally", "psst"),), path
    for path in ("/carl", "/carl/sally", "/carl/anne", "/anne/carl", "/anne/sally/carl"):
        assert chat(nest, path) == (), path


@pytest.mark.parametrize(("distance", "heard"), [(3.0, True), (3.01, False)])
def test_5_5_radius_is_measured_from_feet_to_feet_and_inclusive(distance, heard):
    agents = {"a": (1.5, 0, 1.5), "b": (1.5 + distance, 0, 1.5)}
    world, nest = nest_of(agents, hearing={"radius": 3})
    world.say("b", "hello")
    assert (chat(nest, "/a") != ()) == heard


def test_5_5_radius_goes_through_walls():
    world, nest = nest_of({"a": (4.5, 0, 1.5), "b": (6.5, 0, 1.5)}, CLOSED, hearing={"radius": 3})
    world.say("b", "hello")
    assert chat(nest, "/a") == ((1, "b", "hello"),)


@pytest.mark.parametrize("hearing", ["global", {"radius": 9}])
def test_5_5_hearing_makes_no_pose_current(hearing):
    world, nest = nest_of({"a": WEST, "b": MEETING}, CORNER, hearing=hearing)
    world.place_agent("b", EAST)
    world.say("b", "hello")
    assert chat(nest, "/a") == ((2, "b", "hello"),)
    speaker = nest["/a"].state.agents["b"]
    assert (speaker.position, speaker.current, speaker.basis.observed_at) == (MEETING, False, 0)


def test_5_5_hearing_an_unseen_speaker_tells_no_pose():
    world, nest = nest_of({"a": WEST, "b": EAST}, CLOSED)
    world.say("b", "hello")
    assert nest["/a"].state.agents["b"].position is None


def test_5_5_radius_is_tested_against_the_speaker_s_believed_pose():
    """In the observer's belief Anne still speaks in the gap, where Carl would hear her."""
    agents = {"observer": (4.5, 0, 6.5), "anne": GAP, "carl": (1.5, 0, 10.5)}
    world, nest = nest_of(agents, CORNER, hearing={"radius": 5})
    world.place_agent("anne", (7.5, 0, 4.5))
    world.say("anne", "hello")
    believed = nest["/observer"].state.agents["anne"]
    assert (believed.position, believed.current) == (GAP, False)
    assert chat(nest, "/observer") == ((2, "anne", "hello"),)
    assert chat(nest, "/carl") == ()
    assert chat(nest, "/observer/carl") == ((2, "anne", "hello"),)


def test_5_5_radius_nobody_is_credited_with_hearing_a_speaker_of_unknown_pose():
    agents = {"observer": (4.5, 0, 1.5), "anne": (6.5, 0, 1.5), "carl": (3.5, 0, 1.5)}
    world, nest = nest_of(agents, CLOSED, hearing={"radius": 5})
    world.say("anne", "hello")
    assert chat(nest, "/observer") == chat(nest, "/carl") == ((1, "anne", "hello"),)
    assert chat(nest, "/observer/carl") == ()


def test_5_5_radius_a_listener_must_be_present():
    agents = {"observer": (4.5, 0, 1.5), "anne": (3.5, 0, 1.5), "carl": (6.5, 0, 1.5)}
    world, nest = nest_of(agents, CLOSED, hearing={"radius": 5})
    world.say("anne", "hello")
    assert chat(nest, "/carl") == ((1, "anne", "hello"),)
    assert chat(nest, "/observer/carl") == ()


@pytest.mark.parametrize("hearing", ["global", "sight", {"radius": 99}])
def test_3_who_speaks_hears_itself(hearing):
    world, nest = nest_of({"a": WEST, "b": EAST}, CLOSED, hearing=hearing)
    world.say("a", "hello")
    assert chat(nest, "/a") == ((1, "a", "hello"),)


@pytest.mark.parametrize("hearing", ["global", "sight", {"radius": 99}])
def test_3_a_thought_is_perceived_by_the_thinker_alone(hearing):
    world, nest = nest_of({"a": WEST, "b": MEETING}, hearing=hearing)
    world.think("a", "hm")
    assert nest["/"].state.thoughts == nest["/a"].state.thoughts == [(1, "a", "hm")]
    for path in ("/b", "/a/b", "/b/a", "/a/b/a"):
        assert nest[path].state.thoughts == []
        assert nest[path].state.events == ()
        assert chat(nest, path) == ()


def test_4_what_was_heard_is_kept_in_order():
    world, nest = nest_of({"a": WEST, "b": MEETING})
    with world.tick():
        world.say("a", "one")
        world.say("b", "two")
    world.say("a", "three")
    assert chat(nest, "/a/b") == ((1, "a", "one"), (1, "b", "two"), (2, "a", "three"))


def whispered(nest, path):
    state = nest[path].state
    return tuple(zip(state.chat, state.addressees, strict=True))


def test_5_5_global_a_whisper_is_known_to_the_two_alone_present_or_not():
    world, nest = nest_of({"a": WEST, "b": EAST, "c": (8.5, 0, 8.5)}, CLOSED)
    world.whisper("b", "a", "hello")
    line = ((1, "b", "hello"), "a")
    for path in ("/", "/a", "/b", "/a/b", "/b/a", "/a/b/a", "/b/a/b"):
        assert whispered(nest, path) == (line,), path
    for path in ("/c", "/a/c", "/b/c", "/c/a", "/c/b", "/a/b/c", "/c/a/b", "/a/c/b"):
        assert whispered(nest, path) == (), path


def test_5_5_global_who_did_not_perceive_a_whisper_credits_nobody_with_it():
    """Carl stands beside both, and hears everything that is said aloud."""
    near = {"a": WEST, "b": (3.5, 0, 1.5), "c": (4.5, 0, 1.5)}
    world, nest = nest_of(near)
    world.whisper("a", "b", "one")
    world.say("a", "two")
    assert chat(nest, "/c") == chat(nest, "/c/a") == chat(nest, "/c/b") == ((2, "a", "two"),)
    assert chat(nest, "/b/a") == ((1, "a", "one"), (2, "a", "two"))


@pytest.mark.parametrize("hearing", ["sight", {"radius": 1}])
def test_3_a_whisper_reaches_whom_it_is_for_and_nobody_else(hearing):
    """Through a wall and from afar; Carl stands beside the speaker."""
    agents = {"a": WEST, "b": EAST, "c": (EAST[0], 0, EAST[2] + 0.5)}
    world, nest = nest_of(agents, CLOSED, hearing=hearing)
    world.whisper("b", "a", "psst")
    line = ((1, "b", "psst"), "a")
    for path in ("/a", "/b", "/a/b", "/b/a", "/a/b/a", "/b/a/b"):
        assert whispered(nest, path) == (line,), path
    for path in ("/c", "/c/a", "/c/b", "/a/c", "/b/c", "/a/b/c"):
        assert whispered(nest, path) == (), path


@pytest.mark.parametrize(
    ("name", "other", "hint"),
    [("a", "a", "itself"), ("a", "z", "no agent 'z'"), ("z", "a", "no agent 'z'")],
)
def test_a_whisper_needs_two_agents(name, other, hint):
    world, _ = nest_of({"a": WEST, "b": EAST})
    with pytest.raises(bn.WorldError, match=hint):
        world.whisper(name, other, "hello")
    assert world.now == 0


@pytest.mark.parametrize("hearing", [bn.Radius(-3), {"radius": 0}, "radius: 0", "near"])
def test_3_a_radius_is_above_0(hearing):
    with pytest.raises(bn.InputError, match="with BLOCKS above 0"):
        bn.Perception(hearing=hearing)
