"""Rules of sight, one each: blocks that hide others and blocks that do not."""

import math
import subprocess
import sys

import numpy as np
import pytest

from beliefnest.errors import InputError, UnknownNameError
from beliefnest.perception.sight import Sight
from beliefnest.world.registry import Registry

REGISTRY = Registry.load()
ORIGIN = (0, 0, 0)


def grid(shape, blocks=None):
    """Return a grid of air with blocks, given by position and text."""
    states = np.zeros(shape, dtype=np.int32)
    for position, text in (blocks or {}).items():
        states[position] = -1 if text == "unknown" else REGISTRY.state_id(text)
    return states


def sees(blocks, eye, position, yaw=0.0, pitch=0.0, **options):
    sight = Sight(REGISTRY, **options)
    return bool(sight.geometry(blocks, ORIGIN).sees_blocks(eye, yaw, pitch, [position])[0])


def wall(text, x=3, size=7):
    return {(x, y, z): text for y in range(size) for z in range(size)}


@pytest.mark.parametrize("text", ["stone", "oak_leaves", "packed_ice", "oak_slab[type=double]"])
def test_a_wall_of_opaque_blocks_hides(text):
    assert not sees(grid((7, 7, 7), wall(text)), (0.5, 3.6, 3.5), (5, 3, 3))


@pytest.mark.parametrize(
    "text",
    [
        "glass",
        "tinted_glass",
        "lime_stained_glass",
        "glass_pane[north=true,south=true]",
        "lime_stained_glass_pane[north=true,south=true]",
        "barrier",
        "ice",
        "water",
        "wheat",
        "unknown",
    ],
)
def test_a_wall_of_transparent_blocks_hides_nothing(text):
    blocks = grid((7, 7, 7), wall(text))
    assert Sight(REGISTRY).geometry(blocks, ORIGIN).visible_blocks((0.5, 3.6, 3.5), 0, 0).all()


def test_blocks_the_user_lists_are_transparent():
    blocks = grid((7, 7, 7), wall("oak_leaves"))
    assert sees(blocks, (0.5, 3.6, 3.5), (5, 3, 3), transparent_blocks=["minecraft:oak_leaves"])


def test_air_and_unknown_blocks_are_seen():
    assert sees(grid((7, 7, 7)), (0.5, 3.6, 3.5), (5, 3, 3))
    assert sees(grid((7, 7, 7), {(5, 3, 3): "unknown"}), (0.5, 3.6, 3.5), (5, 3, 3))


def test_nothing_outside_the_grid_hides_but_a_shape_that_reaches_out_does():
    eye = (0.5, 1.3, 0.5)
    assert sees(grid((1, 1, 1)), eye, (9, 1, 0))
    fences = {(3, 0, z): "oak_fence[north=true,south=true]" for z in range(3)}
    points = [(4.5, 1.25, 1.5), (4.5, 1.75, 1.5)]
    seen = (
        Sight(REGISTRY)
        .geometry(grid((5, 1, 3), fences), ORIGIN)
        .sees_points((0.5, 1.25, 1.5), 0, 0, points)
    )
    assert seen.tolist() == [False, True]


def test_a_half_wall_hides_what_is_behind_its_boxes_only():
    blocks = grid((7, 7, 7), wall("stone") | {(3, 3, 3): "oak_slab[type=bottom]"})
    assert sees(blocks, (0.5, 3.75, 3.5), (5, 3, 3))
    blocks[3, 3, 3] = REGISTRY.state_id("oak_slab[type=top]")
    assert sees(blocks, (0.5, 3.25, 3.5), (5, 3, 3))


def test_a_door_hides_when_closed_and_not_when_open():
    doorway = wall("stone")
    for half, y in (("lower", 3), ("upper", 4)):
        doorway[3, y, 3] = f"oak_door[facing=east,half={half},open=false]"
    closed = grid((7, 7, 7), doorway)
    opened = closed.copy()
    for half, y in (("lower", 3), ("upper", 4)):
        opened[3, y, 3] = REGISTRY.state_id(f"oak_door[facing=east,half={half},open=true]")
    assert not sees(closed, (0.5, 4.6, 3.5), (5, 4, 3))
    assert sees(opened, (0.5, 4.6, 3.5), (5, 4, 3))


def test_a_fence_hides_half_a_block_above_itself():
    fences = {(3, 0, z): "oak_fence[north=true,south=true]" for z in range(5)}
    blocks = grid((7, 4, 5), fences)
    assert not sees(blocks, (0.5, 1.2, 2.5), (4, 0, 2))
    assert sees(blocks, (0.5, 1.6, 2.5), (5, 1, 2))
    sight = Sight(REGISTRY)
    assert sight.geometry(blocks, ORIGIN).blocker((0.5, 1.2, 2.5), (6.5, 1.4, 2.5)) == (3, 0, 2)


def test_a_target_does_not_hide_itself_even_where_it_reaches_out():
    fence = grid((3, 3, 3), {(1, 0, 1): "oak_fence"})
    assert sees(fence, (1.5, 2.6, 1.5), (1, 0, 1))


def test_a_fully_enclosed_block_is_hidden_and_an_uncovered_one_seen():
    cube = grid(
        (5, 5, 5), {(x, y, z): "stone" for x in (1, 2, 3) for y in (1, 2, 3) for z in (1, 2, 3)}
    )
    assert not sees(cube, (-2.3, 6.1, -1.7), (2, 2, 2))
    cube[2, 3, 2] = 0
    assert sees(cube, (-2.3, 9.1, -1.7), (2, 3, 2))


def test_an_eye_inside_a_block_sees_that_block_and_nothing_else():
    blocks = grid((5, 5, 5), {(2, 2, 2): "stone"})
    seen = Sight(REGISTRY).geometry(blocks, ORIGIN).visible_blocks((2.4, 2.6, 2.3), 0, 0)
    assert np.argwhere(seen).tolist() == [[2, 2, 2]]


def test_a_crack_between_two_blocks_is_closed_and_one_block_is_grazed():
    sight = Sight(REGISTRY)
    eye, point = (0.5, 0.5, 1.0), (4.5, 0.5, 1.0)
    two = grid((5, 1, 2), {(2, 0, 0): "stone", (2, 0, 1): "stone"})
    one = grid((5, 1, 2), {(2, 0, 0): "stone"})
    assert not sight.geometry(two, ORIGIN).sees_points(eye, 0, 0, [point])[0]
    assert sight.geometry(one, ORIGIN).sees_points(eye, 0, 0, [point])[0]


def test_a_crack_between_shapes_inside_a_cell_is_closed():
    sight = Sight(REGISTRY)
    eye, point = (0.5, 0.5, 0.5), (4.5, 0.5, 0.5)
    stairs = grid((5, 1, 1), {(2, 0, 0): "oak_stairs[facing=east]"})
    top = grid((5, 1, 1), {(2, 0, 0): "oak_slab[type=top]"})
    both = grid((5, 1, 1), {(2, 0, 0): "oak_slab[type=top]", (3, 0, 0): "oak_slab[type=bottom]"})
    assert not sight.geometry(stairs, ORIGIN).sees_points(eye, 0, 0, [point])[0]
    assert sight.geometry(top, ORIGIN).sees_points(eye, 0, 0, [point])[0]
    assert not sight.geometry(both, ORIGIN).sees_points(eye, 0, 0, [point])[0]


def test_four_blocks_around_a_ray_close_it_and_three_do_not():
    sight = Sight(REGISTRY)
    eye, point = (0.5, 1.0, 1.0), (4.5, 1.0, 1.0)
    blocks = grid((5, 2, 2), {(2, y, z): "stone" for y in (0, 1) for z in (0, 1)})
    assert not sight.geometry(blocks, ORIGIN).sees_points(eye, 0, 0, [point])[0]
    blocks[2, 1, 0] = 0
    assert sight.geometry(blocks, ORIGIN).sees_points(eye, 0, 0, [point])[0]


def test_a_ray_passes_the_edge_where_two_blocks_touch():
    blocks = grid((4, 1, 4), {(1, 0, 2): "stone", (2, 0, 1): "stone"})
    sight = Sight(REGISTRY)
    assert sight.geometry(blocks, ORIGIN).sees_points((0.5, 0.5, 0.5), 0, 0, [(3.5, 0.5, 3.5)])[0]
    assert not sight.geometry(blocks, ORIGIN).sees_points((0.5, 0.5, 0.5), 0, 0, [(3.5, 0.5, 3.4)])[
        0
    ]


def test_the_distance_limit_is_measured_to_the_block_s_centre_and_inclusive():
    blocks = grid((9, 3, 3))
    assert sees(blocks, (0.5, 1.5, 1.5), (5, 1, 1), max_visible_distance=5)
    assert not sees(blocks, (0.5, 1.5, 1.5), (6, 1, 1), max_visible_distance=5)
    assert sees(blocks, (0.5, 1.5, 1.5), (6, 1, 1), max_visible_distance=None)


def test_more_distance_never_hides_anything():
    states = [REGISTRY.state_id(text) for text in ("stone", "oak_slab", "oak_fence")]
    rng = np.random.default_rng(3)
    blocks = np.where(rng.random((11, 7, 11)) < 0.2, rng.choice(states, (11, 7, 11)), 0)
    before = np.zeros(blocks.shape, dtype=bool)
    for distance in (1, 3, 5, 6):
        sight = Sight(REGISTRY, max_visible_distance=distance)
        seen = sight.geometry(blocks.astype(np.int32), ORIGIN).visible_blocks(
            (5.3, 3.62, 5.4), 0, 0
        )
        assert (seen >= before).all() and seen.sum() > before.sum()
        before = seen


@pytest.mark.parametrize(
    ("yaw", "pitch", "ahead"),
    [
        (0.0, 0.0, (5, 5, 1)),
        (math.pi / 2, 0.0, (1, 5, 5)),
        (math.pi, 0.0, (5, 5, 9)),
        (-math.pi / 2, 0.0, (9, 5, 5)),
        (0.0, math.pi / 2, (5, 9, 5)),
        (0.0, -math.pi / 2, (5, 1, 5)),
    ],
)
def test_the_field_of_view_is_a_cone_around_yaw_and_pitch(yaw, pitch, ahead):
    blocks, eye = grid((11, 11, 11)), (5.5, 5.5, 5.5)
    for position in [(5, 5, 1), (1, 5, 5), (5, 5, 9), (9, 5, 5), (5, 9, 5), (5, 1, 5)]:
        seen = sees(blocks, eye, position, yaw, pitch, field_of_view=70)
        assert seen == (position == ahead)


def test_the_rim_of_the_field_of_view_belongs_to_it():
    blocks, eye = grid((11, 1, 11)), (5.5, 0.5, 5.5)
    sight = Sight(REGISTRY, field_of_view=90)
    rim, beyond = (8.5, 0.5, 2.5), (8.5, 0.5, 2.6)
    assert sight.geometry(blocks, ORIGIN).sees_points(eye, 0, 0, [rim, beyond]).tolist() == [
        True,
        False,
    ]


def test_agents_are_seen_by_eye_body_or_feet():
    sight = Sight(REGISTRY)
    eye, feet = (0.5, 1.62, 2.5), (5.5, 0.0, 2.5)

    def sees_agent(*rows):
        blocks = grid((7, 4, 5), {(3, y, z): "stone" for y in rows for z in range(5)})
        return bool(sight.geometry(blocks, ORIGIN).sees_agents(eye, 0, 0, [feet])[0])

    assert sees_agent()
    assert sees_agent(0)
    assert sees_agent(1)
    assert not sees_agent(0, 1)


def test_agents_are_bounded_by_the_distance_to_the_body_centre():
    sight = Sight(REGISTRY, max_visible_distance=4)
    eye = (0.5, 0.9, 0.5)
    feet = [(4.5, 0.0, 0.5), (4.6, 0.0, 0.5)]
    assert sight.geometry(grid((1, 1, 1)), ORIGIN).sees_agents(eye, 0, 0, feet).tolist() == [
        True,
        False,
    ]


def test_the_blocker_is_the_first_block_on_the_ray():
    blocks = grid((6, 1, 1), {(2, 0, 0): "oak_slab", (4, 0, 0): "stone"})
    sight = Sight(REGISTRY)
    assert sight.geometry(blocks, (10, 20, 30)).blocker((10.5, 20.3, 30.5), (15.5, 20.3, 30.5)) == (
        12,
        20,
        30,
    )
    assert sight.geometry(blocks, (10, 20, 30)).blocker((10.5, 20.7, 30.5), (15.5, 20.7, 30.5)) == (
        14,
        20,
        30,
    )
    assert (
        sight.geometry(blocks, (10, 20, 30)).blocker((10.5, 20.7, 30.5), (13.5, 20.7, 30.5)) is None
    )


def test_questions_about_nothing_have_no_answers():
    blocks, sight = grid((2, 2, 2)), Sight(REGISTRY)
    assert sight.geometry(blocks, ORIGIN).sees_blocks((0.5, 1.6, 0.5), 0, 0, []).shape == (0,)
    assert sight.geometry(blocks, ORIGIN).sees_agents((0.5, 1.6, 0.5), 0, 0, []).shape == (0,)


def test_wrong_input_is_refused():
    sight = Sight(REGISTRY)
    with pytest.raises(UnknownNameError, match="oak_leaves"):
        Sight(REGISTRY, transparent_blocks=["oak_leavs"])
    with pytest.raises(UnknownNameError, match="no block state -2"):
        sight.geometry(np.full((2, 2, 2), -2, dtype=np.int32), ORIGIN)
    with pytest.raises(InputError, match="shape"):
        sight.geometry(np.zeros((2, 2), dtype=np.int32), ORIGIN)
    geometry = sight.geometry(grid((2, 2, 2)), ORIGIN)
    with pytest.raises(InputError, match="integers"):
        geometry.sees_blocks((0.5, 1.6, 0.5), 0, 0, [(0.5, 0.5, 0.5)])


def test_the_compiler_is_not_loaded_before_the_first_look():
    code = "import sys, beliefnest.perception.sight; sys.exit('numba' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
