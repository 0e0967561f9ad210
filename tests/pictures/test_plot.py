"""Plots of beliefs over time show what was held when, and where it was false."""

from collections.abc import Iterator

import pytest
from tests.pictures.measuring import faults, texts

import beliefnest as bn
from beliefnest.pictures.marks import Rectangle
from beliefnest.pictures.plot import Band, NotedClaim, PlotRow, belief_plot
from beliefnest.pictures.time_axis import NotedAct

CHEST = (3, 1, 3)
PLOT = "beliefnest.viewer.figures.plotting.belief_plot"
LONG = ("abcdefghijklmnop", "qrstuvwxyzabcdef")


@pytest.fixture
def nest() -> Iterator[bn.Nest]:
    """Sally puts a diamond away and goes behind a wall; Anne takes it out."""
    blocks = {(x, 0, z): "stone" for x in range(10) for z in range(10)}
    blocks |= {(x, y, 5): "bricks" for x in range(10) for y in (1, 2, 3)}
    world = bn.ScriptedWorld(
        ((0, 0, 0), (9, 4, 9)),
        blocks,
        {"sally": (2.5, 1, 2.5), "anne": (4.5, 1, 2.5)},
        inventories={"sally": {"diamond": 1}},
        containers={CHEST: {}},
    )
    with bn.Nest(world, static_blocks=["stone", "bricks"]) as nest:
        world.step(4)
        world.deposit("sally", CHEST, {"diamond": 1})
        world.place_agent("sally", (2.5, 1, 7.5))
        world.withdraw("anne", CHEST, {"diamond": 1})
        world.step(3)
        yield nest


def test_bands_begin_and_end_with_what_was_held_and_are_false_where_they_are(
    nest: bn.Nest, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn: list[tuple[list[PlotRow], list[NotedAct]]] = []
    monkeypatch.setattr(PLOT, lambda rows, acts, _: drawn.append((rows, acts)))
    nest.plot_beliefs(CHEST, "diamond", ["/", "/sally", "/anne/sally"])
    ((rows, acts),) = drawn
    assert rows[0].bands == (
        Band(0, 5, "no diamond", False),
        Band(5, 7, "1 diamond", False),
        Band(7, 11, "no diamond", False),
    )
    held = (Band(0, 5, "", False), Band(5, 7, "1 diamond", False), Band(7, 11, "1 diamond", True))
    assert rows[1] == PlotRow("/sally", held)
    assert [band.false for band in rows[2].bands][-1]
    assert acts == [NotedAct(5, "sally puts in"), NotedAct(7, "anne takes out")]


@pytest.mark.parametrize("size", [None, "one column", 50])
def test_nothing_collides_however_many_deeds_and_values(nest: bn.Nest, size: object) -> None:
    path = f"/{LONG[0]}/{LONG[1]}/{LONG[0]}"
    bands = tuple(Band(t, t + 3, f"{t % 7} oak_log", t % 2 == 0) for t in range(0, 90, 3))
    acts = [NotedAct(t, f"{LONG[t % 2]} takes out") for t in range(0, 90, 4)]
    many = belief_plot([PlotRow("/", bands), PlotRow(path, bands)], acts, "What is believed " * 5)
    plain = nest.plot_beliefs(CHEST, paths=["/", "/sally"])
    places = nest.plot_beliefs(agent="sally", paths=["/", "/anne", "/sally/anne"])
    for figure in (many, plain, places):
        assert faults(figure.drawing(size)) == []  # type: ignore[arg-type]
    assert "sally puts in" in texts(plain.drawing())


def test_the_past_ends_then_and_a_branch_goes_on(nest: bn.Nest) -> None:
    assert "anne takes out" not in texts(nest.at(6).plot_beliefs(CHEST).drawing())
    nest["/sally"].switch("try")
    nest["/sally"].scripted.withdraw("sally", CHEST, {"diamond": 1})
    assert "empty" in texts(nest.plot_beliefs(CHEST, paths=["/sally"]).drawing())


def test_wrong_questions_are_errors(nest: bn.Nest) -> None:
    with pytest.raises(bn.InputError, match="belief paths"):
        nest.plot_beliefs(CHEST, paths=[])
    with pytest.raises(bn.PositionError):
        nest.plot_beliefs((99, 0, 0))
    with pytest.raises(bn.PathError):
        nest.plot_beliefs(CHEST, paths=["/bob"])
    for one_too_many in (
        {},
        {"container": CHEST, "agent": "anne"},
        {"block": CHEST, "item": "diamond"},
    ):
        with pytest.raises(bn.InputError, match="a plot follows one thing"):
            nest.plot_beliefs(**one_too_many)  # type: ignore[arg-type]
    with pytest.raises(bn.PathError):
        nest.plot_beliefs(agent="bob")
    with pytest.raises(
        bn.InputError, match=r"never was a container at \(0, 1, 0\); containers are at"
    ):
        nest.plot_beliefs((0, 1, 0))
    with pytest.raises(bn.BeliefNestError, match="did you mean diamond"):
        nest.plot_beliefs(CHEST, "daimond")


def test_an_agents_place_is_followed_by_names_and_false_where_it_is(
    nest: bn.Nest, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn: list[list[PlotRow]] = []
    monkeypatch.setattr(PLOT, lambda rows, *_: drawn.append(rows))
    nest.plot_beliefs(agent="sally", paths=["/", "/anne"])
    # Sally walks on behind the wall, in small steps, and comes to stand.
    world = nest.scripted_world
    for step in range(1, 6):
        world.place_agent("sally", (2.5 + step, 1, 7.5))
    world.step(20)
    nest.plot_beliefs(agent="sally", paths=["/", "/anne"])
    before, after = drawn
    assert before[0].bands == (
        Band(0, 6, "at (2, 1, 2)", False),
        Band(6, 11, "at (2, 1, 7)", False),
    )
    assert [(band.words, band.false) for band in after[0].bands] == [
        ("at (2, 1, 2)", False),
        ("on the way", False),
        ("at (7, 1, 7)", False),
    ]
    # Anne saw her before she was behind the wall.
    assert after[1].bands == (Band(0, 6, "at (2, 1, 2)", False), Band(6, 36, "at (2, 1, 2)", True))


def test_what_an_agent_has_is_followed(nest: bn.Nest, monkeypatch: pytest.MonkeyPatch) -> None:
    drawn: list[tuple[list[PlotRow], list[NotedAct]]] = []
    monkeypatch.setattr(PLOT, lambda rows, acts, _: drawn.append((rows, acts)))
    nest.plot_beliefs(agent="anne", item="diamond", paths=["/", "/sally"])
    ((rows, acts),) = drawn
    assert rows[0].bands == (Band(0, 7, "no diamond", False), Band(7, 11, "1 diamond", False))
    assert rows[1].bands == (Band(0, 11, "", False),)
    assert acts == [NotedAct(7, "anne takes")]


def test_doors_and_signs_are_no_containers() -> None:
    door, sign = (5, 1, 3), (6, 1, 3)
    blocks = {door: "oak_door[half=lower]", (5, 2, 3): "oak_door[half=upper]", sign: "oak_sign"}
    world = bn.ScriptedWorld(
        ((0, 0, 0), (9, 4, 9)), blocks, {"anne": (4.5, 1, 2.5)}, containers={CHEST: {}}
    )
    with bn.Nest(world, bn.Perception(testimony="informed")) as nest:
        for place in (door, sign):
            with pytest.raises(bn.InputError, match=r"containers are at \(3, 1, 3\)$"):
                nest.plot_beliefs(place)


def test_claims_stand_above_what_became_of_them_and_items_and_blocks_are_followed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    left, right, door = (1, 0, 1), (8, 0, 1), (4, 0, 7)
    blocks = {door: "oak_door[half=lower]", (4, 1, 7): "oak_door[half=upper]"}
    agents = {"max": (2.5, 0, 3.5), "nora": (4.5, 0, 4.5), "sal": (5.5, 0, 5.5)}
    boxes = {left: {"diamond": 1}, right: {}}
    world = bn.ScriptedWorld(((0, 0, 0), (50, 3, 9)), blocks, agents, containers=boxes)
    perception = bn.Perception(max_visible_distance=12, testimony="informed", grace=5)
    drawn: list[tuple[list[PlotRow], list[NotedAct]]] = []
    with bn.Nest(world, perception) as nest:
        world.open("max", left)
        world.place_agent("max", (40.5, 0, 3.5))
        world.step(20)
        state = "oak_door[open=true]"
        claims = [bn.Claim.located("diamond", right), bn.Claim.block(door, state)]
        world.say("nora", "It is open.", claims=claims)
        world.withdraw("sal", left, {"diamond": 1})
        item = {"item": "diamond", "paths": ["/", "/max", "/sal", "/nora"]}
        for size in (None, 50):
            assert faults(nest.plot_beliefs(**item).drawing(size)) == []
            assert faults(nest.plot_beliefs(block=door, paths=["/max"]).drawing(size)) == []
        monkeypatch.setattr(PLOT, lambda rows, acts, _: drawn.append((rows, acts)))
        nest.plot_beliefs(**item)
        nest.plot_beliefs(block=door, paths=["/", "/max"])
    (rows, acts), (doors, said) = drawn
    assert [row.told for row in rows] == [(), (NotedClaim(23, True),), (NotedClaim(23, True),), ()]
    assert [band.words for band in rows[0].bands] == ["in container (1, 0, 1)", "with sal"]
    assert [(band.words, band.false) for band in rows[1].bands[-2:]] == [
        ("in container (1, 0, 1)", False),
        ("in container (8, 0, 1)", True),
    ]
    assert acts == [
        NotedAct(23, "nora: diamond is in (8, 0, 1) (false)"),
        NotedAct(24, "sal takes"),
    ]
    assert [band.words for band in doors[1].bands] == ["oak door, shut", "oak door, open"]
    assert doors[1].told == (NotedClaim(23, True),)
    assert said == [NotedAct(23, "nora: (4, 0, 7) is oak_door[open=true] (a lie)")]


def test_values_that_speak_of_a_colour_are_painted_in_it() -> None:
    words = ("in the blue box", "in the green box", "left of the green box", "nowhere")
    bands = tuple(Band(5 * n, 5 * n + 5, each, False) for n, each in enumerate(words))
    drawing = belief_plot([PlotRow("/", bands)], [], "the apple").drawing()
    fills = [mark.fill for mark in drawing.marks if isinstance(mark, Rectangle) and mark.fill]
    blue, green, other_green, neutral = fills[:4]
    assert len({blue, green, other_green, neutral}) == 4
    assert _strongest(blue) == 2
    assert _strongest(green) == _strongest(other_green) == 1


def _strongest(colour: str) -> int:
    parts = bytes.fromhex(colour[1:])
    return parts.index(max(parts))
