"""Sight against a slow reference written from the text of the semantics alone."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.profiles import at_night

from beliefnest.perception.compiling import compiled
from beliefnest.perception.eyes import open_room, set_code
from beliefnest.perception.sight import Sight
from beliefnest.world.registry import Registry

REGISTRY = Registry.load()


UNKNOWN = -1
HEIGHTS = (1.62, 0.9, 0.05)
PALETTE = [
    "air",
    "stone",
    "oak_slab[type=top]",
    "oak_slab[type=bottom]",
    "oak_fence",
    "oak_fence[east=true,north=true]",
    "iron_bars[east=true,west=true]",
    "glass",
    "glass_pane[north=true,south=true]",
    "oak_door[facing=north,half=lower]",
    "oak_door[facing=east,half=upper,open=true]",
    "oak_stairs[facing=south]",
    "oak_stairs[facing=west,half=top,shape=inner_left]",
    "cobblestone_wall[west=tall,up=true]",
    "piston_head[facing=up]",
    "piston_head[facing=west]",
    "water",
    "chest",
]
STATES = [REGISTRY.state_id(text) for text in PALETTE] + [UNKNOWN]


class Reference:
    """The definition, by clipping every ray against every box of the world."""

    def __init__(self, blocks, origin, max_distance, field_of_view):
        self.boxes = []
        for index in np.ndindex(blocks.shape):
            state = int(blocks[index])
            if state == UNKNOWN or REGISTRY.default_transparent[state]:
                continue
            at = tuple(o + i for o, i in zip(origin, index, strict=True))
            for box in REGISTRY.boxes(state):
                low = [at[axis] + box[axis] for axis in range(3)]
                high = [at[axis] + box[axis + 3] for axis in range(3)]
                self.boxes.append((at, low, high))
        self.max_distance = math.inf if max_distance is None else max_distance
        self.field_of_view = field_of_view

    def enters(self, eye, d, low, high):
        t0, t1 = 0.0, 1.0
        for axis in range(3):
            if d[axis] == 0:
                if not low[axis] < eye[axis] < high[axis]:
                    return False
                continue
            ends = sorted((plane - eye[axis]) / d[axis] for plane in (low[axis], high[axis]))
            t0, t1 = max(t0, ends[0]), min(t1, ends[1])
        return (t1 - t0) * math.hypot(*d) > 1e-9

    def is_free(self, eye, sample, target):
        d = [s - e for s, e in zip(sample, eye, strict=True)]
        across = [
            d[axis] == 0
            and any(eye[axis] in (low[axis], high[axis]) for _, low, high in self.boxes)
            for axis in range(3)
        ]
        moves = itertools.product(*[(-1e-7, 1e-7) if a else (0.0,) for a in across])
        return any(
            not any(
                at != target
                and self.enters([e + m for e, m in zip(eye, move, strict=True)], d, *box)
                for at, *box in self.boxes
            )
            for move in moves
        )

    def in_field(self, eye, yaw, pitch, sample):
        if self.field_of_view == 360:
            return True
        look = (-math.sin(yaw) * math.cos(pitch), math.sin(pitch), -math.cos(yaw) * math.cos(pitch))
        d = [s - e for s, e in zip(sample, eye, strict=True)]
        if not any(d):
            return True
        cosine = sum(a * b for a, b in zip(look, d, strict=True)) / math.hypot(*d)
        return cosine >= math.cos(math.radians(self.field_of_view / 2)) - 1e-9

    def samples(self, eye, position):
        yield tuple(p + 0.5 for p in position)
        for axis in range(3):
            if position[axis] <= eye[axis] <= position[axis] + 1:
                continue
            face = position[axis] + (1 if eye[axis] > position[axis] else 0)
            inner = (0.01, 0.99)
            for u, v in [(0.5, 0.5), *itertools.product(inner, inner)]:
                others = iter((u, v))
                yield tuple(face if k == axis else position[k] + next(others) for k in range(3))

    def sees_block(self, eye, yaw, pitch, position):
        centre = [p + 0.5 for p in position]
        if math.dist(eye, centre) > self.max_distance + 1e-9:
            return False
        return any(
            self.in_field(eye, yaw, pitch, sample) and self.is_free(eye, sample, position)
            for sample in self.samples(eye, position)
        )

    def sees_agent(self, eye, yaw, pitch, feet):
        x, y, z = feet
        if math.dist(eye, (x, y + 0.9, z)) > self.max_distance + 1e-9:
            return False
        return any(
            self.in_field(eye, yaw, pitch, sample) and self.is_free(eye, sample, None)
            for sample in ((x, y + height, z) for height in HEIGHTS)
        )


coordinate = st.one_of(
    st.integers(-8, 48).map(lambda n: n / 8),
    st.integers(-1, 6).map(float),
    st.integers(-1, 5).map(lambda n: n + 0.5),
    st.floats(-1, 6).map(lambda x: round(x, 6)),
)
angles = st.one_of(
    st.sampled_from([0.0, math.pi / 2, math.pi, -math.pi / 2]), st.floats(-math.pi, math.pi)
)


@st.composite
def worlds(draw):
    shape = (draw(st.integers(1, 5)), draw(st.integers(1, 4)), draw(st.integers(1, 5)))
    cells = math.prod(shape)
    picks = draw(st.binary(min_size=cells, max_size=cells))
    air = draw(st.sampled_from([20, 128, 230]))
    states = [STATES[0] if b < air else STATES[b % len(STATES)] for b in picks]
    blocks = np.array(states, dtype=np.int32).reshape(shape)
    origin = draw(st.sampled_from([(0, 0, 0), (-3, -51, 7), (1000, 64, -1000)]))
    return blocks, origin


@settings(max_examples=at_night(2000, 80))
@given(
    world=worlds(),
    eye=st.tuples(coordinate, coordinate, coordinate),
    yaw=angles,
    pitch=angles,
    max_distance=st.sampled_from([None, 1.5, 3.0, 4.7]),
    field_of_view=st.sampled_from([360, 360, 70, 90, 180, 300]),
)
def test_blocks_agree_with_the_reference(world, eye, yaw, pitch, max_distance, field_of_view):
    blocks, origin = world
    eye = tuple(e + o for e, o in zip(eye, origin, strict=True))
    sight = Sight(REGISTRY, max_distance, field_of_view)
    reference = Reference(blocks, origin, max_distance, field_of_view)
    seen = sight.geometry(blocks, origin).visible_blocks(eye, yaw, pitch)
    positions = [
        tuple(o + i for o, i in zip(origin, index, strict=True))
        for index in np.ndindex(blocks.shape)
    ]
    expected = [reference.sees_block(eye, yaw, pitch, position) for position in positions]
    assert dict(zip(positions, seen.ravel().tolist(), strict=True)) == dict(
        zip(positions, expected, strict=True)
    )
    outside = [tuple(np.add(origin, move)) for move in [(-1, 0, 0), (0, 9, 1), (3, 2, -4)]]
    asked = [tuple(int(c) for c in p) for p in positions + outside]
    expected += [reference.sees_block(eye, yaw, pitch, p) for p in asked[len(positions) :]]
    assert sight.geometry(blocks, origin).sees_blocks(eye, yaw, pitch, asked).tolist() == expected


@settings(max_examples=at_night(2000, 80))
@given(
    world=worlds(),
    eye=st.tuples(coordinate, coordinate, coordinate),
    yaw=angles,
    pitch=angles,
    max_distance=st.sampled_from([None, 1.5, 3.0, 4.7]),
    field_of_view=st.sampled_from([360, 360, 70, 90, 180, 300]),
    feet=st.lists(st.tuples(coordinate, coordinate, coordinate), min_size=1, max_size=6),
)
def test_agents_agree_with_the_reference(world, eye, yaw, pitch, max_distance, field_of_view, feet):
    blocks, origin = world
    eye = tuple(e + o for e, o in zip(eye, origin, strict=True))
    feet = [tuple(f + o for f, o in zip(foot, origin, strict=True)) for foot in feet]
    reference = Reference(blocks, origin, max_distance, field_of_view)
    expected = [reference.sees_agent(eye, yaw, pitch, foot) for foot in feet]
    seen = Sight(REGISTRY, max_distance, field_of_view).geometry(blocks, origin)
    assert seen.sees_agents(eye, yaw, pitch, feet).tolist() == expected


@settings(max_examples=at_night(2000, 150))
@given(
    world=worlds(),
    eye=st.tuples(coordinate, coordinate, coordinate),
    points=st.lists(st.tuples(coordinate, coordinate, coordinate), min_size=1, max_size=6),
)
def test_points_agree_with_the_reference(world, eye, points):
    blocks, origin = world
    eye = tuple(e + o for e, o in zip(eye, origin, strict=True))
    points = [tuple(p + o for p, o in zip(point, origin, strict=True)) for point in points]
    reference = Reference(blocks, origin, None, 360)
    expected = [reference.is_free(eye, point, None) for point in points]
    sight = Sight(REGISTRY, None, 360)
    assert sight.geometry(blocks, origin).sees_points(eye, 0, 0, points).tolist() == expected
    for point, free in zip(points, expected, strict=True):
        assert (sight.geometry(blocks, origin).blocker(eye, point) is None) == free


@compiled
def change_code(codes, sizes, reaches, cell, code):
    """Call `set_code`, which only kernels can call."""
    set_code(codes, sizes, reaches, cell, code)


@settings(max_examples=at_night(2000, 100))
@given(
    world=worlds(),
    changes=st.lists(st.tuples(st.integers(0, 999), st.sampled_from(STATES)), max_size=6),
)
def test_a_changed_geometry_equals_one_built_anew(world, changes):
    blocks, origin = world
    sight = Sight(REGISTRY, None, 360)
    codes = sight.geometry(blocks, origin).codes.copy()
    changed = blocks.copy()
    for number, state in changes:
        index = np.unravel_index(number % blocks.size, blocks.shape)
        cell = tuple(int(i) + 1 for i in index)
        changed[index] = state
        code = int(sight.state_codes[state])
        change_code(codes.reshape(-1), codes.shape, sight.reaches, cell, code)
    assert np.array_equal(codes, sight.geometry(changed, origin).codes)


CLOSERS = [
    ["stone"],
    ["stone", "oak_door[facing=north,half=lower]", "oak_door[facing=north,half=upper]"],
    ["oak_door[facing=south,half=lower]", "oak_door[facing=north,half=upper]", "stone"],
    ["oak_slab[type=top]", "stone", "oak_stairs[facing=south,half=top]"],
    ["oak_slab[type=bottom]", "stone", "oak_stairs[facing=south,half=top]"],
    ["stone", "glass"],
]


@compiled
def room_seen(scene, eye):
    """Call `open_room`, which only kernels can call."""
    return open_room(scene, eye)


@settings(max_examples=at_night(2000, 150))
@given(
    world=worlds(),
    eye=st.tuples(coordinate, coordinate, coordinate),
    axis=st.integers(0, 2),
    layer=st.integers(0, 9),
    closers=st.sampled_from(CLOSERS),
    seed=st.integers(0, 99),
)
def test_nothing_is_seen_beyond_the_open_room(world, eye, axis, layer, closers, seed):
    blocks, origin = world
    where = [slice(None)] * 3
    where[axis] = layer % blocks.shape[axis]
    states = [REGISTRY.state_id(text) for text in closers]
    blocks[tuple(where)] = np.random.default_rng(seed).choice(states, blocks[tuple(where)].shape)
    geometry = Sight(REGISTRY, None, 360).geometry(blocks, origin)
    low, high = room_seen(geometry._scene, tuple(e + 1 for e in eye))
    there = tuple(e + o for e, o in zip(eye, origin, strict=True))
    for cell in np.argwhere(geometry.visible_blocks(there, 0, 0)):
        assert all(low <= cell) and all(cell < high), (low, high, cell)


def test_a_wall_with_a_shut_door_ends_the_open_room():
    blocks = np.zeros((9, 4, 3), dtype=np.int32)
    blocks[6] = REGISTRY.state_id("stone")
    for height, half in enumerate(("lower", "upper"), 1):
        blocks[6, height, 1] = REGISTRY.state_id(f"oak_door[facing=east,half={half}]")
    geometry = Sight(REGISTRY, None, 360).geometry(blocks, (0, 0, 0))
    assert room_seen(geometry._scene, (2.5, 2.5, 2.5)) == ((0, 0, 0), (7, 4, 3))
    blocks[6, 1, 1] = REGISTRY.state_id("oak_door[facing=east,half=lower,open=true]")
    geometry = Sight(REGISTRY, None, 360).geometry(blocks, (0, 0, 0))
    assert room_seen(geometry._scene, (2.5, 2.5, 2.5)) == ((0, 0, 0), (9, 4, 3))


def _state_by_shape():
    """Return an opaque state for every shape, by the set of its boxes."""
    return {
        frozenset(REGISTRY.boxes(state)): state
        for state in range(REGISTRY.states)
        if not REGISTRY.default_transparent[state]
    }


STATE_BY_SHAPE = _state_by_shape()
MAPS = {
    "mirror x": np.array([[-1, 0, 0], [0, 1, 0], [0, 0, 1]]),
    "mirror z": np.array([[1, 0, 0], [0, 1, 0], [0, 0, -1]]),
    "turn": np.array([[0, 0, 1], [0, 1, 0], [-1, 0, 0]]),
    "turn back": np.array([[0, 0, -1], [0, 1, 0], [1, 0, 0]]),
}


def _mapped_state(state, matrix):
    """Return a state whose shape is the mapped shape; None if Minecraft has none."""
    if state == UNKNOWN or REGISTRY.default_transparent[state]:
        return state
    boxes = set()
    for box in REGISTRY.boxes(state):
        corners = matrix @ (np.array(box).reshape(2, 3) - 0.5).T
        low, high = corners.min(axis=1) + 0.5, corners.max(axis=1) + 0.5
        boxes.add((*low.tolist(), *high.tolist()))
    return STATE_BY_SHAPE.get(frozenset(boxes))


def _mapped_yaw(yaw, matrix):
    x, _, z = matrix @ np.array([-math.sin(yaw), 0.0, -math.cos(yaw)])
    return math.atan2(-x, -z)


@pytest.mark.parametrize("name", MAPS)
@settings(max_examples=at_night(2000, 60))
@given(
    world=worlds(),
    eye=st.tuples(coordinate, coordinate, coordinate),
    yaw=st.sampled_from([0.0, math.pi / 2, math.pi, -math.pi / 2, 0.7, 2.0]),
    field_of_view=st.sampled_from([360, 90, 60]),
)
def test_mirrored_and_turned_worlds_are_seen_alike(name, world, eye, yaw, field_of_view):
    blocks, _ = world
    matrix = MAPS[name]
    mapping = {state: _mapped_state(state, matrix) for state in STATES}
    blocks = np.array(
        [state if mapping[state] is not None else STATES[1] for state in blocks.ravel().tolist()],
        dtype=np.int32,
    ).reshape(blocks.shape)
    sight = Sight(REGISTRY, 4.5, field_of_view)
    seen = sight.geometry(blocks, (0, 0, 0)).visible_blocks(eye, yaw, 0.1)
    twice_middles = 2 * np.argwhere(np.ones(blocks.shape)) + 1
    cells = (twice_middles @ matrix.T - 1) // 2
    origin = cells.min(axis=0)
    image = np.zeros(cells.max(axis=0) - origin + 1, dtype=np.int32)
    image[tuple((cells - origin).T)] = [mapping.get(s, s) for s in blocks.ravel().tolist()]
    image_seen = sight.geometry(image, tuple(origin.tolist())).visible_blocks(
        tuple((matrix @ np.array(eye)).tolist()), _mapped_yaw(yaw, matrix), 0.1
    )
    assert np.array_equal(image_seen[tuple((cells - origin).T)], seen.ravel())
