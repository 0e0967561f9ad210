"""Figures show what simulators hold, are written in three forms, and nothing in them collides."""

import base64
import itertools
import math
import re
import zlib
from collections.abc import Iterator
from pathlib import Path

import pytest
from PIL import Image
from tests.pictures.measuring import faults, texts

import beliefnest as bn
from beliefnest.pictures.marks import XY, Bounds, Circle, Lines, Text
from beliefnest.pictures.palette import MARKS, Mark, agent_looks

NAMES = ("abcdefghijklmnop", "abcdefghijklmnoq", "zzzzzzzzzzzzzzzz")
CHEST, BOX = (4, 1, 6), (7, 1, 6)


@pytest.fixture
def nest() -> Iterator[bn.Nest]:
    """Yield a nest: a wall hides the first agent, who moves an apple and walks, from the second."""
    blocks = {(x, 0, z): "stone" for x in range(12) for z in range(12)}
    blocks |= {(x, y, 4): "bricks" for x in range(12) for y in (1, 2, 3)}
    blocks |= {(1, 1, 1): "lever[face=floor,powered=true]", (2, 1, 9): "oak_door[open=true]"}
    ann, bob, eve = NAMES
    world = bn.ScriptedWorld(
        ((0, 0, 0), (11, 8, 11)),
        blocks,
        {ann: (2.5, 1, 6.5), bob: (7.5, 1, 7.5), eve: (7.5, 1, 8.5)},
        inventories={ann: {"apple": 1}},
        containers={CHEST: {}, BOX: {}},
    )
    with bn.Nest(world, static_blocks=["bricks", "stone"]) as nest:
        world.deposit(ann, CHEST, {"apple": 1})
        world.place_agent(bob, (1.5, 1, 1.5))
        world.withdraw(ann, CHEST, {"apple": 1})
        world.deposit(ann, BOX, {"apple": 1})
        yield nest


def test_a_belief_is_drawn_from_its_own_state_and_marked_against_reality(nest: bn.Nest) -> None:
    ann, bob, _ = NAMES
    said = texts(nest.figure(["/", f"/{bob}"]).drawing())
    assert "(4, 1, 6): empty" in said
    assert any(text.startswith("(4, 1, 6): apple") for text in said)
    assert "in reality: empty" in said
    assert any(text.endswith("ticks ago") for text in said)
    alone = nest[f"/{ann}"].figure().drawing()
    assert not any("in reality" in text for text in texts(alone) if "(4, 1, 6)" in text)
    same = nest.figure(f"/{bob}", against=f"/{bob}").drawing()
    assert MARKS[Mark.FALSE].words not in texts(same)


def test_what_an_agent_is_falsely_believed_to_have_is_said_in_the_margin(nest: bn.Nest) -> None:
    ann, bob, _ = NAMES
    prior = bn.InitialBelief((bob,), containers={CHEST: ({}, True)})
    world = bn.ScriptedWorld(
        ((0, 0, 0), (11, 4, 11)),
        {(x, y, 4): "bricks" for x in range(12) for y in (0, 1, 2, 3)},
        {ann: (2.5, 1, 6.5), bob: (7.5, 1, 7.5)},
        containers={CHEST: {"apple": 1}},
    )
    with bn.Nest(world, static_blocks=["bricks"], initial_beliefs=[prior]) as other:
        world.withdraw(ann, CHEST, {"apple": 1})
        world.place_agent(bob, (1.5, 1, 1.5))
        world.deposit(ann, CHEST, {"apple": 1})
        said = texts(other[f"/{bob}"].figure().drawing())
        assert f"{ann}: has 1 apple, more?" in said
        assert said[said.index(f"{ann}: has 1 apple, more?") + 1] == "in reality: empty"
        assert f"what {ann} has" in repr(other[f"/{bob}"])


@pytest.mark.parametrize("size", [60, "one column", "two columns"])
def test_a_name_stands_at_its_disc_or_a_line_leads_to_it(nest: bn.Nest, size: object) -> None:
    for path in ("/", *(f"/{name}" for name in NAMES)):
        drawing = nest.figure(path).drawing(size)  # type: ignore[arg-type]
        discs: dict[str, Circle] = {}
        for circle, badge in itertools.pairwise(drawing.marks):
            if isinstance(circle, Circle) and circle.role == "icon" and isinstance(badge, Text):
                # Those on the plan come first; more of them stand in the margin.
                discs.setdefault(badge.text, circle)
        ends = [
            point for m in drawing.marks if isinstance(m, Lines) for s in m.segments for point in s
        ]
        for name in NAMES:
            labels = [m for m in drawing.having("text") if isinstance(m, Text) and m.text == name]
            disc = discs[agent_looks(NAMES)[name].badge]
            assert any(
                _apart(m.bounds, disc) < 6 + disc.radius / 2 or _ends(m.bounds, ends)
                for m in labels
            ), name


def _apart(bounds: Bounds, circle: Circle) -> float:
    x0, y0, x1, y1 = bounds
    x, y = min(max(circle.x, x0), x1), min(max(circle.y, y0), y1)
    return math.dist((x, y), (circle.x, circle.y)) - circle.radius


def _ends(bounds: Bounds, ends: list[XY]) -> bool:
    x0, y0, x1, y1 = bounds
    return any(x0 - 1 <= x <= x1 + 1 and y0 - 9 <= y <= y1 + 9 for x, y in ends)


def test_an_agent_of_unknown_place_is_named_in_the_margin_and_not_drawn() -> None:
    world = bn.ScriptedWorld(
        ((0, 0, 0), (8, 3, 4)),
        {(4, y, z): "stone" for y in range(4) for z in range(5)},
        {"ann": (1.5, 0, 2.5), "bob": (7.5, 0, 2.5)},
    )
    with bn.Nest(world, static_blocks=["stone"]) as nest:
        drawing = nest["/ann"].figure().drawing()
        said = texts(drawing)
        assert said[said.index("place not known:") + 1] == "bob"
        discs = [m for m in drawing.marks if isinstance(m, Circle) and m.role == "icon"]
        assert len(discs) == 2
        assert discs[0].fill == agent_looks(["ann", "bob"])["ann"].colour
        assert discs[1].dash


def test_an_agent_has_one_colour_in_all_figures(nest: bn.Nest) -> None:
    ann = agent_looks(NAMES)[NAMES[0]].colour
    for path in ("/", f"/{NAMES[2]}"):
        marks = nest.figure(path).drawing().marks
        assert any(isinstance(mark, Circle) and mark.fill == ann for mark in marks)


@pytest.mark.parametrize("size", [None, "one column", "two columns", 60, 250])
def test_nothing_collides_with_names_of_sixteen_letters(nest: bn.Nest, size: object) -> None:
    ann, bob, eve = NAMES
    figure = nest.figure(["/", f"/{bob}", f"/{bob}/{ann}", f"/{eve}/{bob}/{ann}"])
    assert faults(figure.drawing(size)) == []  # type: ignore[arg-type]


def test_a_figure_fits_into_width_and_height(nest: bn.Nest) -> None:
    drawing = nest.figure(["/", f"/{NAMES[1]}"]).drawing((80, 60))
    assert drawing.width == pytest.approx(80 * 72 / 25.4, rel=0.01)
    assert drawing.height <= 60 * 72 / 25.4 + 0.1
    assert faults(drawing) == []


def test_the_storey_is_that_of_most_things_and_another_can_be_chosen(nest: bn.Nest) -> None:
    low, high = nest.figure("/"), nest.figure("/", height=6)
    assert not any("down" in text for text in texts(low.drawing()))
    assert any("down" in text for text in texts(high.drawing()))
    with pytest.raises(bn.InputError, match="give a height from 0 to 8"):
        nest.figure("/", height=9)


@pytest.mark.parametrize("ending", ["svg", "pdf", "png"])
def test_the_same_figure_gives_the_same_bytes(nest: bn.Nest, tmp_path: Path, ending: str) -> None:
    for name in ("one", "two"):
        nest.figure(["/", f"/{NAMES[0]}"]).save(tmp_path / f"{name}.{ending}")
    one, two = (tmp_path / f"{name}.{ending}" for name in ("one", "two"))
    assert one.read_bytes() == two.read_bytes()
    beginnings = {"svg": b"<svg", "pdf": b"%PDF", "png": b"\x89PNG"}
    assert one.read_bytes().startswith(beginnings[ending])


def test_letters_of_a_pdf_are_outlined_only_where_they_have_a_halo(
    nest: bn.Nest, tmp_path: Path
) -> None:
    nest.figure("/").save(tmp_path / "f.pdf")
    (page,) = [
        zlib.decompress(base64.a85decode(stream.strip(), adobe=False))
        for stream in re.findall(
            rb"ASCII85Decode.*?stream\s(.*?)~>endstream",
            (tmp_path / "f.pdf").read_bytes(),
            re.DOTALL,
        )
        if b" Tf " in zlib.decompress(base64.a85decode(stream.strip(), adobe=False))
    ]
    depth, outlined_at = 0, []
    for word in page.split():
        depth += {b"q": 1, b"Q": -1}.get(word, 0)
        if word == b"Tr":
            outlined_at.append(depth)
    assert outlined_at
    assert min(outlined_at) >= 1


def test_a_png_has_the_asked_size(nest: bn.Nest, tmp_path: Path) -> None:
    nest.figure("/").save(tmp_path / "f.png", size=84, dpi=300)
    with Image.open(tmp_path / "f.png") as image:
        assert image.width == pytest.approx(84 / 25.4 * 300, abs=1)


@pytest.mark.parametrize("name", ["f.jpeg", "f", "f.svg.txt"])
def test_an_unknown_ending_is_an_error_and_writes_nothing(
    nest: bn.Nest, tmp_path: Path, name: str
) -> None:
    with pytest.raises(bn.InputError, match=r"\.svg, \.pdf, \.png"):
        nest.figure("/").save(tmp_path / name)
    assert not list(tmp_path.iterdir())


def test_wrong_sizes_and_paths_say_what_is_right(nest: bn.Nest) -> None:
    with pytest.raises(bn.InputError, match="millimetres"):
        nest.figure("/").drawing(-1)
    with pytest.raises(bn.InputError, match="one column"):
        nest.figure("/").drawing("a4")  # type: ignore[arg-type]
    with pytest.raises(bn.PathError):
        nest.figure("/nobody")
    with pytest.raises(bn.PathError):
        nest.figure("/", against="/nobody")


def test_contents_of_which_nothing_is_known_have_no_age() -> None:
    world = bn.ScriptedWorld(
        ((0, 0, 0), (6, 3, 6)),
        {(x, 0, z): "stone" for x in range(7) for z in range(7)},
        {"ann": (2.5, 1, 2.5), "bob": (4.5, 1, 4.5)},
        containers={(1, 1, 1): {"apple": 1}},
    )
    with bn.Nest(world, store=None) as nest:
        world.step(40)
        said = texts(nest["/bob"].figure().drawing())
        assert "(1, 1, 1): nothing known" in said


def test_past_and_branches_are_drawn_as_they_are(nest: bn.Nest) -> None:
    bob = NAMES[1]
    assert "(4, 1, 6): apple, more?" in " ".join(texts(nest.at(1)[f"/{bob}"].figure().drawing()))
    belief = nest[f"/{bob}"]
    belief.switch("try")
    belief.scripted.step(3)
    drawn = texts(nest.figure(f"/{bob}").drawing())
    assert any("branch try" in text for text in drawn)


def test_a_sign_is_drawn_with_what_is_known_to_be_written_on_it():
    place = (3, 1, 3)
    world = bn.ScriptedWorld(
        ((0, 0, 0), (6, 3, 6)),
        {place: "oak_sign"},
        {"ann": (1.5, 1, 1.5), "bob": (5.5, 1, 1.5)},
        signs={place: "food"},
    )
    with bn.Nest(world) as nest:
        nest["/ann"].edit(signs={place: "a long text that does not fit"})
        drawn = nest.figure(["/", "/ann"])._repr_html_()
        assert "“food”" in drawn
        assert "“a long text that does n…”" in drawn
        assert ">sign<" in drawn


def test_a_plan_of_a_part_of_the_box_says_which_part() -> None:
    ground = {(x, 0, z): "stone" for x in range(60) for z in range(8)}
    world = bn.ScriptedWorld(((0, 0, 0), (59, 4, 7)), ground, {"ann": (30.5, 1, 4.5)})
    with bn.Nest(world) as nest:
        said = " ".join(texts(nest.figure(["/"]).drawing()))
    assert "tick 0, x 26 to 34 of 0 to 59" in said
    assert "z 0" not in said
