"""Hearsay is marked as such; false doors and signs are marked and described in words."""

import random

import pytest
from tests.pictures.measuring import faults, texts

import beliefnest as bn
from beliefnest.pictures.lettering import text_width
from beliefnest.pictures.marks import Drawing, Rectangle, Text
from beliefnest.pictures.palette import INK, MARKS, Mark
from beliefnest.pictures.raster import raster
from beliefnest.world.registry import Registry

BOX, DOOR, SIGN = (8, 0, 2), (6, 0, 7), (2, 0, 7)
DOORS = {DOOR: "oak_door[half=lower]", (6, 1, 7): "oak_door[half=upper]"}


@pytest.fixture
def nest():
    """Max hears of a box, a door and an agent that he does not see, and saw a sign that changed."""
    wall = {(x, y, 5): "bricks" for x in range(12) for y in range(3)}
    world = bn.ScriptedWorld(
        ((0, 0, 0), (11, 3, 11)),
        {**DOORS, **wall, SIGN: "oak_sign"},
        {"max": (2.5, 0, 8.5), "nora": (4.5, 0, 8.5), "sal": (9.5, 0, 8.5)},
        containers={BOX: {}},
        signs={SIGN: "food"},
    )
    perception = bn.Perception(testimony="accept")
    with bn.Nest(world, perception, static_blocks=["bricks", "oak_door"]) as nest:
        world.place_agent("max", (2.5, 0, 2.5))
        world.write_sign("nora", SIGN, "tools")
        claims = [
            bn.Claim.located("diamond", BOX),
            bn.Claim.block(DOOR, "oak_door[open=true]"),
            bn.Claim.position("sal", (9.5, 0, 9.5)),
        ]
        world.say("nora", "Look!", claims=claims)
        world.step(1)
        world.place_agent("max", (3.5, 0, 2.5))
        yield nest


def test_hearsay_is_told_as_such_with_its_speaker_and_age(nest):
    said = texts(nest["/max"].figure().drawing())
    assert "(8, 0, 2): diamond, more? (told by nora 2 ticks ago)" in said
    assert "(6, 0, 7): oak door, open (told by nora 2 ticks ago)" in said
    assert MARKS[Mark.HEARD].words in said
    assert "told by nora" in said
    assert MARKS[Mark.HEARD].words not in texts(nest["/nora"].figure().drawing())


def test_what_a_sign_of_an_unknown_writer_says_is_told_by_a_sign():
    world = bn.ScriptedWorld(
        ((0, 0, 0), (9, 3, 9)),
        {SIGN: "oak_sign"},
        {"max": (2.5, 0, 8.5)},
        containers={BOX: {}},
        signs={SIGN: "food"},
        sign_claims={SIGN: [bn.Claim.located("bread", BOX)]},
    )
    with bn.Nest(world, bn.Perception(testimony="accept")) as nest:
        world.step(2)
        said = texts(nest["/max"].figure().drawing())
    assert "(8, 0, 2): bread, more? (told by a sign 2 ticks ago)" in said


def test_false_doors_and_signs_have_a_line_that_says_how_it_is(nest):
    drawing = nest["/max"].figure().drawing()
    said = texts(drawing)
    assert said[said.index("(6, 0, 7): oak door, open (told by nora 2 ticks ago)") + 1] == (
        "in reality: oak door, shut"
    )
    sign = next(n for n, text in enumerate(said) if text.startswith("(2, 0, 7): oak sign that"))
    assert 'says "food"' in said[sign]
    assert said[sign + 1] == 'in reality: oak sign that says "tools"'
    assert faults(drawing) == []


@pytest.mark.parametrize("seed", [2, 4, 10])
def test_no_name_lies_on_a_sign_however_small_the_plan(seed):
    names = ("abcdefghijklmnop", "abcdefghijklmnoq", "zzzzzzzzzzzzzzzz")
    spots = [(x, 0, z) for x in range(9) for z in range(9)]
    random.Random(seed).shuffle(spots)
    places = dict.fromkeys(spots[:8], "oak_sign")
    feet = [(x + 0.5, 0, z + 0.5) for x, _, z in spots[10:13]]
    agents = dict(zip(names, feet, strict=True))
    with bn.Nest(bn.ScriptedWorld(((0, 0, 0), (8, 3, 8)), places, agents)) as nest:
        drawing = nest.figure("/").drawing(40)
    boards = [
        mark.bounds
        for mark in drawing.marks
        if isinstance(mark, Rectangle) and mark.role == "part" and mark.stroke == INK
    ]
    assert len(boards) >= len(places)
    for text in (mark for mark in drawing.marks if isinstance(mark, Text) and mark.halo):
        x0, y0, x1, y1 = text.bounds
        assert not any(x0 < b[2] and b[0] < x1 and y0 < b[3] and b[1] < y1 for b in boards), text


def test_signs_that_the_font_lacks_are_drawn_as_those_it_has():
    def pixels(text):
        drawn = Drawing(30.0, 20.0, (Text(4, 15, text, 12, "#000000"),))
        return raster(drawn, 72).tobytes()

    assert pixels("\u2713") == pixels("\u221a") != pixels("\u2603")
    assert text_width("\u2717", 10) == text_width("\u00d7", 10)


def test_what_was_never_perceived_is_never_called_seen():
    prior = bn.InitialBelief(
        ("max",),
        containers={BOX: ({"bread": 1}, True)},
        blocks={BOX: Registry.load().state_id("chest")},
        agents={"nora": (6.5, 0, 2.5)},
    )
    wall = {(4, y, z): "bricks" for y in range(4) for z in range(10)}
    world = bn.ScriptedWorld(
        ((0, 0, 0), (9, 3, 9)),
        wall,
        {"max": (2.5, 0, 2.5), "nora": (6.5, 0, 2.5)},
        containers={BOX: {}, (8, 0, 6): {}},
    )
    with bn.Nest(world, initial_beliefs=[prior], static_blocks=["bricks"]) as nest:
        for moves in range(2):
            said = texts(nest["/max"].figure().drawing())
            assert "(8, 0, 2): bread (believed from the start)" in said
            assert "believed from the start" in said
            assert not any("ago" in each or "seen now" in each for each in said)
            assert "nora at (6.5, 0, 2.5), believed from the start" in repr(nest["/max"].state)
            rows = nest["/max"].render("{{ branch | events_and_visibilities }}")
            assert "0;assumed;nora;position:[6.5, 0, 2.5];" in rows
            world.place_agent("nora", (7.5, 0, 2.5 + moves))
        # The place has become false.
        said = texts(nest["/max"].figure().drawing())
        assert not any("seen" in each for each in said if "seen by" not in each), said
        nest["/max"].edit(containers={(8, 0, 6): {"apple": 1}})
        world.step(3)
        world.think("nora", "hm")
        said = texts(nest["/max"].figure().drawing())
        assert "(8, 0, 6): apple (edited 4 ticks ago)" in said
