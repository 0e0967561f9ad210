"""Facts as files, other processes and code give them, and what they hold of."""

import copy
import pickle
from typing import Any

import pytest

import beliefnest as bn
from beliefnest.belief.view import State
from beliefnest.errors import BeliefNestError, InputError
from beliefnest.facts.kinds import FactEntry
from beliefnest.facts.reading import PlainScene, conditions_of, fact_entry, fact_in, plain_entry
from beliefnest.facts.states import StateFacts
from beliefnest.world.values import Box

LEVER = FactEntry(block=(4, 1, 4), state="lever[powered=true]")
CHEST, SIGN, DOOR = (3, 1, 3), (1, 1, 1), (5, 1, 5)
SCENE = PlainScene(("ann", "bob"), Box((0, 0, 0), (8, 3, 8)))


def test_a_fact_means_the_same_in_another_process() -> None:
    """Studies send scenarios to other processes, where a default is equal, but another object."""
    sent = pickle.loads(pickle.dumps(LEVER))
    assert conditions_of(sent, ("ann",)) == conditions_of(LEVER, ("ann",))


def test_a_fact_with_keys_that_do_not_fit_is_refused() -> None:
    with pytest.raises(InputError, match=r"\{'within': 2.0, 'block': .* makes no sense"):
        conditions_of(FactEntry(block=(4, 1, 4), state="lever", within=2.0), ("ann",))


@pytest.mark.parametrize(
    ("given", "told"),
    [
        (
            {"container": CHEST, "items": {"apple": 1}, "lacks": "stick"},
            "give container and items or container and lacks; a condition leaves out what the file "
            "gives by `items: null` or `lacks: null`",
        ),
        (
            {"container": CHEST, "items": {"apple": 1}, "within": 3},
            "give container and items, without within$",
        ),
        ({"block": DOOR}, "makes no sense; give block and state.* or block and like$"),
        ({"agent": "ann", "at": [1, 1, 1], "withn": 2}, "'withn'; did you mean 'within'"),
        ({"container": CHEST, "itmes": {"apple": 1}}, "'itmes'; did you mean 'items'"),
        ({"agent": "ann", "position": [1, 1, 1]}, "has the key 'position'; write 'at'$"),
        ({"agent": "ann", "at": (6, 1)}, r"'at' cannot be \(6, 1\); it says: a block position, or"),
        ({"agent": "ann", "at": DOOR, "within": -1}, "'within' cannot be -1; it says: greatest"),
        ({"container": CHEST, "items": {"apple": "1"}}, "'items' cannot be .*; it says: item name"),
        ("apple", "'apple' is no fact; give a mapping such as"),
        ({"heard": ""}, "^'heard' is empty; give part of an utterance$"),
        ({"not_heard": " "}, "^'not_heard' is empty; give part of an utterance$"),
        ({"block": DOOR, "like": SIGN, "property": "zz"}, "no block has the property 'zz'; give"),
        ({"block": DOOR, "like": SIGN, "property": "opne"}, "'opne'; did you mean open"),
    ],
)
def test_a_fact_that_makes_no_sense_is_told_what_to_give(given: object, told: str) -> None:
    with pytest.raises(BeliefNestError, match=told):
        fact_entry(given, SCENE)


@pytest.fixture(scope="module")
def ann() -> State:
    """Return what Ann believes in a room with a chest, a sign and Bob."""
    world = bn.ScriptedWorld(
        box=((0, 0, 0), (8, 3, 8)),
        blocks={DOOR: "oak_planks"},
        agents={"ann": (2.5, 1, 2.5), "bob": (6.5, 1, 6.5)},
        inventories={"ann": {"apple": 2, "stick": 1}},
        containers={CHEST: {}},
    )
    nest = bn.Nest(world)
    world.deposit("ann", CHEST, {"apple": 2})
    world.set_block(SIGN, "oak_sign")
    world.write_sign("ann", SIGN, "to the left")
    world.say("bob", "good morning")
    return nest["/ann"].state


@pytest.mark.parametrize(
    ("given", "holds", "is_expected"),
    [
        ({"container": CHEST, "items": {"apple": 1}}, True, False),
        ({"container": CHEST, "items": {"apple": 2}}, True, True),
        ({"container": CHEST, "items": {"apple": 2, "stick": 1}}, False, False),
        ({"container": CHEST, "items": {}}, False, False),
        ({"agent": "ann", "items": {"stick": 1}}, True, True),
        ({"agent": "ann", "items": {}}, False, False),
        ({"agent": "bob", "at": [6, 1, 6]}, True, True),
        ({"agent": "bob", "at": [6.5, 1, 7.6]}, False, False),
        ({"agent": "bob", "at": [6.5, 1, 7.6], "within": 1.2}, True, True),
        ({"agent": "bob", "at": None}, False, False),
        ({"block": DOOR, "state": "oak_planks"}, True, True),
        ({"block": SIGN, "state": "oak_sign[waterlogged=false]"}, True, True),
        ({"block": DOOR, "state": None}, False, False),
        ({"block": DOOR, "like": SIGN}, False, False),
        ({"sign": SIGN, "text": "to the left"}, True, True),
        ({"sign": DOOR, "text": None}, True, True),
        ({"heard": "morning"}, True, True),
        ({"not_heard": "morning"}, False, False),
    ],
)
def test_a_fact_is_judged_and_written(
    ann: State, given: dict[str, Any], holds: bool, is_expected: bool
) -> None:
    fact = fact_in(fact_entry(given, SCENE))
    facts = StateFacts(ann)
    assert fact.holds(facts) is holds
    assert (fact.instead(facts) is None) is is_expected
    assert fact_in(fact_entry(fact.written(), SCENE)) == fact
    assert all(fact.found(facts, str))


@pytest.mark.parametrize(
    "given",
    [
        {"container": (1, 1, 1), "items": {"apple": 1}},
        {"agent": "ann", "at": None},
        {"path": "/ann", "block": (2, 1, 2), "state": None},
        {"sign": (1, 2, 3), "text": None},
        {"agents": ("ann",), "sites": (((1, 1, 1),),)},
    ],
)
def test_a_copied_fact_keeps_what_is_null_and_what_is_not_given(given: dict[str, Any]) -> None:
    entry = plain_entry(given)
    written = pickle.dumps(entry)
    assert pickle.loads(written) == entry == copy.deepcopy(entry)
    assert b"UNSET" not in written
