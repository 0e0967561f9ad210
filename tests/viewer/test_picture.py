"""Pictures show what they claim to show, and the same scene gives the same bytes."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import beliefnest as bn
from beliefnest.timeline.store import SqliteJournal
from beliefnest.viewer.canvas import Canvas
from beliefnest.viewer.icons import AGENT_COLOURS
from beliefnest.viewer.picture import draw_overview, draw_scene, save
from beliefnest.viewer.plan import Plan
from beliefnest.viewer.scene import Caption, Row, Scene, decisive_tick, read_scene, read_trails

CELL = 40
SIZE = 9
CHEST = (4, 1, 6)
COLOURS = {"bob": AGENT_COLOURS[0], "ann": AGENT_COLOURS[1]}


@pytest.fixture
def scene(tmp_path: Path) -> Iterator[Scene]:
    """A wall stands between Ann and Bob; Ann puts an apple away."""
    blocks = {(x, 0, z): "stone" for x in range(SIZE) for z in range(SIZE)}
    blocks |= {(x, y, 4): "bricks" for x in range(6) for y in (1, 2, 3)}
    world = bn.ScriptedWorld(
        ((0, 0, 0), (SIZE - 1, 3, SIZE - 1)),
        blocks,
        {"ann": (2.5, 1, 6.5), "bob": (7.5, 1, 7.5)},
        inventories={"ann": {"apple": 1}},
        containers={CHEST: {}},
    )
    store = tmp_path / "run.bn"
    nest = bn.Nest(world, static_blocks=["bricks", "stone"], store=store)
    start = world.snapshot()
    world.place_agent("bob", (1.5, 1, 1.5))
    world.deposit("ann", CHEST, {"apple": 1})
    world.place_agent("ann", (3.5, 1, 7.5))
    rows = [Row("Ann believes", "/ann", {CHEST: {"apple": 1}}, frozenset({CHEST}), True)]
    tick, caption = decisive_tick(nest), Caption("t", "s", "m")
    with SqliteJournal.read(store) as journal:
        trails = read_trails(journal, start, tick)
    yield read_scene(nest, tick, caption, {CHEST: "box"}, ("ann", "bob"), rows, trails)
    nest.close()


def plan_of(scene: Scene) -> Image.Image:
    canvas = Canvas(CELL * SIZE, CELL * SIZE, (255, 255, 255))
    Plan(canvas, scene, (0, 0), CELL * SIZE, COLOURS, brief=True).draw()
    return canvas.image


def colour_at(image: Image.Image, x: float, z: float) -> tuple[int, int, int]:
    pixel = image.getpixel((round(x * CELL), round(z * CELL)))
    assert isinstance(pixel, tuple)
    red, green, blue = pixel
    return red, green, blue


def near(first: tuple[int, int, int], second: tuple[int, int, int]) -> bool:
    return max(abs(a - b) for a, b in zip(first, second, strict=True)) < 12


def test_the_moment_is_the_last_deed_and_not_the_last_walk(scene: Scene) -> None:
    people = {person.name: person for person in scene.people}
    assert people["ann"].position == (2.5, 1, 6.5)
    assert people["ann"].acts
    assert not people["bob"].acts
    assert people["bob"].trail == ((7.5, 1, 7.5), (1.5, 1, 1.5))
    assert scene.containers == {CHEST: {"apple": 1}}


def test_views_are_what_the_agents_see_at_the_height_of_the_containers(scene: Scene) -> None:
    ann, bob = scene.views
    assert (ann.name, bob.name) == ("ann", "bob")
    assert ann.seen[2, 7]
    assert not ann.seen[2, 1]
    assert bob.seen[2, 1]
    assert not bob.seen[2, 7]


def test_the_ghost_is_where_the_first_viewer_last_saw_the_other(scene: Scene) -> None:
    (ghost,) = scene.ghosts
    assert (ghost.name, ghost.believer) == ("bob", "ann")
    assert ghost.position == (7.5, 1, 7.5)


def test_agents_walls_and_sight_are_drawn_where_they_are(scene: Scene) -> None:
    image = plan_of(scene)
    assert near(colour_at(image, 2.5 + 0.35, 6.5), COLOURS["ann"])
    assert near(colour_at(image, 1.5 + 0.35, 1.5), COLOURS["bob"])
    bare = plan_of(replace(scene, views=()))
    assert colour_at(image, 1.5, 4.3) == colour_at(bare, 1.5, 4.3)
    assert sum(colour_at(bare, 1.5, 4.3)) < sum(colour_at(bare, 6.5, 4.3)) - 150
    assert colour_at(image, 0.3, 7.3) != colour_at(bare, 0.3, 7.3)
    assert not scene.views[0].seen[0, 0]


def test_hatching_is_only_where_the_second_agent_sees(scene: Scene) -> None:
    both = np.asarray(plan_of(scene), dtype=int)
    first = np.asarray(plan_of(replace(scene, views=scene.views[:1])), dtype=int)
    changed = np.abs(both - first).max(axis=2) > 8
    squares = changed.reshape(SIZE, CELL, SIZE, CELL)[:, 3:-3, :, 3:-3].any(axis=(1, 3)).T
    seen = scene.views[1].seen
    # Walls, chests and agents cover the hatching.
    assert not (squares & ~seen).any()
    assert (squares & seen).sum() > 0.6 * seen.sum()


def test_the_same_scene_gives_the_same_bytes(scene: Scene, tmp_path: Path) -> None:
    for name in ("one.png", "two.png"):
        save(draw_scene(scene), tmp_path / name)
    assert (tmp_path / "one.png").read_bytes() == (tmp_path / "two.png").read_bytes()
    with Image.open(tmp_path / "one.png") as image:
        assert image.format == "PNG"


def test_what_is_believed_changes_the_picture(scene: Scene) -> None:
    other = replace(scene.rows[0], contents={CHEST: {}})
    assert draw_scene(scene).tobytes() != draw_scene(replace(scene, rows=(other,))).tobytes()


def test_an_overview_holds_every_scene(scene: Scene) -> None:
    one, three = draw_overview([scene], "one"), draw_overview([scene] * 3, "three")
    assert three.width > 2 * one.width
    assert three.height == one.height
