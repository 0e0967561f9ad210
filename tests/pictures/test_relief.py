"""Plans of wide worlds show the ground from above, as one small image."""

import math
from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from tests.pictures.measuring import faults, texts
from tests.profiles import few_by_day

import beliefnest as bn
from beliefnest.nest.past.views import visible_from
from beliefnest.pictures.marks import Circle, Lines, Pixels, Text
from beliefnest.pictures.relief import NOWHERE, UNKNOWN, Relief, standing_columns
from beliefnest.pictures.scene import read_scene
from beliefnest_benchmarks.hills import Hills

SHAPE = (96, 32, 80)


@pytest.fixture(scope="module")
def hills() -> Iterator[bn.Nest]:
    """Yield a nest of a small world of hills in which two agents have walked for some ticks."""
    world = Hills(SHAPE, agents=2, houses=4)
    with bn.Nest(world.world) as nest:
        for _ in range(5):
            world.tick()
        yield nest


def pixels(drawing) -> Pixels:
    [found] = [mark for mark in drawing.marks if isinstance(mark, Pixels)]
    return found


def test_a_relief_has_the_highest_known_block_of_each_column(hills: bn.Nest) -> None:
    for path in ("/", "/agent0"):
        state = hills[path].state
        scene = read_scene(state, height=SHAPE[1] - 1)
        assert scene.relief is not None
        (low_x, low_z), (width, depth) = scene.low, scene.size
        for i, k in ((0, 0), (width - 1, depth - 1), (width // 2, depth // 3), (9, 2)):
            column = [state.blocks[low_x + i, y, low_z + k] for y in range(SHAPE[1])]
            known = [y for y, text in enumerate(column) if text not in (None, "air")]
            if known:
                assert scene.relief.levels[i, k] == known[-1]
                assert scene.relief.names[scene.relief.blocks[i, k]] == column[known[-1]]
            else:
                assert scene.relief.blocks[i, k] == (UNKNOWN if None in column else NOWHERE)
    assert (read_scene(hills["/agent0"].state).relief.blocks == UNKNOWN).any()


def test_a_height_hides_what_is_above_it(hills: bn.Nest) -> None:
    scene = hills.scenes("/", height=6)[0]
    assert scene.relief.levels.max() <= 6
    assert hills.scenes("/")[0].relief.levels.max() > 6


def test_the_ground_is_one_image_in_every_form(hills: bn.Nest, tmp_path: Path) -> None:
    figure = hills.figure(["/", "/agent0"])
    drawing = hills.figure("/").drawing()
    mark = pixels(drawing)
    assert (mark.columns, mark.rows) == hills.scenes("/")[0].size
    for ending, most in (("svg", 60_000), ("pdf", 90_000), ("png", 300_000)):
        file = tmp_path / f"hills.{ending}"
        figure.save(file)
        assert file.stat().st_size < most
        again = file.read_bytes()
        figure.save(file)
        assert file.read_bytes() == again
    root = ElementTree.fromstring((tmp_path / "hills.svg").read_text(encoding="utf-8"))
    images = [each for each in root.iter() if each.tag.endswith("image")]
    assert len(images) == 2
    assert not faults(drawing)


def test_an_image_shows_each_field_where_it_is(hills: bn.Nest) -> None:
    figure = hills.figure("/")
    drawing, image = figure.drawing(), figure.image(dpi=300)
    mark = pixels(drawing)
    fields = np.frombuffer(mark.colours, dtype=np.uint8).reshape(mark.rows, mark.columns, 3)
    # No icon or name is in the last rows of columns.
    k, i = mark.rows - 1, mark.columns // 2
    x = (mark.x + (i + 0.5) * mark.width / mark.columns) * 300 / 72
    y = (mark.y + (k + 0.5) * mark.height / mark.rows) * 300 / 72
    assert image.getpixel((round(x), round(y))) == tuple(fields[k, i].tolist())


def test_unknown_columns_are_dotted_but_not_each_of_many(hills: bn.Nest) -> None:
    drawing = hills.figure("/agent0").drawing()
    assert "not known what stands there" in texts(drawing)
    dots = [
        mark
        for mark in drawing.marks
        if isinstance(mark, Lines) and all(a[1] == b[1] for a, b in mark.segments)
    ]
    assert dots and sum(len(mark.segments) for mark in dots) < 40 * 40 + 1


@pytest.mark.parametrize("yaw", [0.0, 2.0])
def test_a_view_of_part_of_a_box_is_that_of_the_whole(yaw: float) -> None:
    world = Hills(SHAPE, agents=2, houses=4)
    with bn.Nest(world.world, bn.Perception(field_of_view=120)) as nest:
        world.world.place_agent("agent0", (3.5, 18.0, 40.2), yaw)
        reading, sight = nest._recording.state((), None), nest._recording.context.sight
        for name in ("agent0", "agent1"):
            seen = visible_from(reading, sight, name)
            assert seen.any()
            assert (seen == reading.visible_from(name)).all()


def test_walls_pillars_and_outlines_of_houses_stand_and_hills_do_not() -> None:
    levels = np.fromfunction(lambda x, z: x // 6, (80, 60), dtype=np.int32).astype(np.int32)
    levels[60:, :] += 3  # A plateau with a steep side.
    wall, pillar, kerb = np.s_[10:30, 20], np.s_[40, 40], np.s_[10:30, 10]
    levels[wall] += 2
    levels[pillar] += 5
    levels[kerb] += 1
    levels[40:47, 5:12] += 4
    blocks = np.zeros_like(levels)
    blocks[:, 50:] = UNKNOWN
    stand = standing_columns(Relief(("stone",), blocks, levels), height=99)
    assert stand[wall].all() and stand[pillar]
    assert not stand[kerb].any()
    assert stand[40:47, 5].all() and stand[40, 5:12].all() and not stand[42:45, 7:10].any()
    stand[wall] = stand[pillar] = stand[40:47, 5:12] = False
    assert not stand.any()


@pytest.mark.parametrize("width", few_by_day([65, 128, 400], 2))
def test_a_wall_is_dark_at_any_scale(width: int) -> None:
    blocks = {(x, 0, z): "stone" for x in range(width) for z in range(width)}
    middle = width // 2
    for along in range(middle - 10, middle + 11):
        blocks |= {(along, y, middle): "bricks" for y in (1, 2)}
        blocks |= {(middle, y, along): "bricks" for y in (1, 2)}
    ends = {"ann": (5.5, 1, 5.5), "bob": (width - 5.5, 1, width - 5.5)}
    world = bn.ScriptedWorld(((0, 0, 0), (width - 1, 3, width - 1)), blocks, ends)
    with bn.Nest(world) as nest:
        figure = nest.figure("/")
        mark, image = pixels(figure.drawing()), figure.image(dpi=150)
    field = mark.width / mark.columns
    assert mark.columns == width

    def darkest(x: int, z: int) -> int:
        left, top = mark.x + (x + 0.5) * field, mark.y + (z + 0.5) * field
        spot = round(left * 150 / 72), round(top * 150 / 72)
        near = [(spot[0] + i, spot[1] + k) for i in (-1, 0, 1) for k in (-1, 0, 1)]
        return min(sum(image.getpixel(each)) for each in near)

    ground = darkest(middle + 5, middle + 5)
    assert ground > 600
    for along in range(middle - 9, middle + 10):
        assert darkest(along, middle) < ground / 2
        assert darkest(middle, along) < ground / 2


def test_symbols_of_a_wide_world_stay_at_their_places_and_names_at_their_symbols() -> None:
    places = {f"a{n:02}": (120.5 + 3 * (n % 4), 1.0, 120.5 + 3 * (n // 4)) for n in range(12)}
    ends = {"b": (5.5, 1.0, 5.5), "c": (250.5, 1.0, 250.5)}
    world = bn.ScriptedWorld(((0, 0, 0), (255, 3, 255)), agents=places | ends)
    with bn.Nest(world) as nest:
        drawing = nest.figure("/").drawing()
    mark = pixels(drawing)
    assert mark.columns == 256
    discs = [each for each in drawing.marks if isinstance(each, Circle) and each.role == "icon"]
    true = [
        (mark.x + x * mark.width / 256, mark.y + z * mark.width / 256)
        for _, (x, _, z) in sorted((places | ends).items())
    ]
    discs = discs[: len(true)]
    for disc, at in zip(discs, true, strict=True):
        assert math.dist((disc.x, disc.y), at) <= 2 * disc.radius + 0.01
    assert any((disc.x, disc.y) != at for disc, at in zip(discs, true, strict=True))
    assert "moved aside; the line ends at its place" in texts(drawing)
    names = [each for each in drawing.marks if isinstance(each, Text) and each.text in places]
    assert len(names) < len(places)
    for name in names:
        disc = discs[sorted(places).index(name.text)]
        assert math.dist((disc.x, disc.y), ((name.left + name.width / 2), name.y)) < 25
    [rest] = [" ".join(texts(drawing)).partition("too close for a name: ")[2]]
    assert all(name in rest for name in places.keys() - {each.text for each in names})
