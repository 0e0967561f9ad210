"""The ice-cream van (semantics, section 8): A in /observer/john/mary, B in /observer/mary.

Two walled yards, the park (x < 10) and the street (x > 10); the observer looks down into
both from above. Location A is in the park, B at the end of the street.
"""

import pytest

import beliefnest as bn

A, B, MEETING = (3.5, 0, 5.5), (18.5, 0, 17.5), (14.5, 0, 8.5)
WALL = {(10, y, z): "stone" for y in range(4) for z in range(21)}
SHED = {(x, y, 15): "stone" for x in range(10) for y in range(4)}


def played(hearing):
    """Play the story of the paper, steps 1 to 5."""
    world = bn.ScriptedWorld(
        ((0, 0, 0), (20, 9, 20)),
        WALL | SHED,
        {
            "john": (5.5, 0, 7.5),
            "mary": (6.5, 0, 4.5),
            "seller": A,
            "observer": (8.5, 8, 10.5),
        },
    )
    nest = bn.Nest(world, bn.Perception(max_visible_distance=64, hearing=hearing))
    world.say("seller", "I stay at A")
    world.place_agent("mary", (13.5, 0, 3.5))
    world.say("seller", "I go to B")
    world.place_agent("seller", MEETING)
    world.say("seller", "I go to B now")
    world.place_agent("seller", B)
    world.place_agent("john", (3.5, 0, 18.5))
    return nest


@pytest.fixture(scope="module")
def nest():
    return played("sight")


def told(nest, path):
    return [text for _, _, text in nest[path].state.chat]


def seller(nest, path):
    return nest[path].state.agents["seller"].position


def test_the_observer_perceives_the_whole_sequence(nest):
    assert told(nest, "/observer") == ["I stay at A", "I go to B", "I go to B now"]
    assert seller(nest, "/observer") == B


def test_mary_was_told_of_b_and_the_observer_knows_it(nest):
    for path in ("/mary", "/observer/mary"):
        assert told(nest, path) == ["I stay at A", "I go to B now"]
        assert seller(nest, path) == B


def test_john_was_told_of_b_and_last_saw_the_seller_at_a(nest):
    for path in ("/john", "/observer/john"):
        assert told(nest, path) == ["I stay at A", "I go to B"]
        assert seller(nest, path) == A


def test_john_does_not_know_of_the_meeting_so_for_him_mary_believes_in_a(nest):
    for path in ("/john/mary", "/observer/john/mary"):
        assert told(nest, path) == ["I stay at A"]
        assert seller(nest, path) == A


def test_mary_does_not_know_that_john_was_told(nest):
    for path in ("/mary/john", "/observer/mary/john"):
        assert told(nest, path) == ["I stay at A"]
        assert seller(nest, path) == A


def test_with_global_hearing_it_is_common_ground_that_all_heard_all():
    nest = played("global")
    assert told(nest, "/observer/john/mary") == ["I stay at A", "I go to B", "I go to B now"]
