"""Bodies stand and pass alike in Minecraft, in the scripted world and on the maps of planners."""

from collections.abc import Iterator, Sequence
from functools import cache
from random import Random

import numpy as np
import pytest
from msgspec.structs import replace
from tests.profiles import at_night, few_by_day

import beliefnest as bn
from beliefnest.minds.ways import Floor, ways_from
from beliefnest.world.doors import is_doorway
from beliefnest.world.frames import Frame, Snapshot
from beliefnest.world.registry import Registry
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import AgentState, Box, Point, Position, block_at
from beliefnest.worlds.by_name import open_world
from beliefnest.worlds.protocol import World
from beliefnest.worlds.scripted.footpaths import Ground, Near

LENGTH, HEIGHT, FLOOR, MIDDLE = 13, 8, 3, 6
"""Size of a lane, height of its floor, and the place of the block in question."""
AT_ONCE = 12
"""Number of lanes of one body."""
LIMIT = 2000

BY_DAY = (
    *("stone", "oak_fence", "oak_fence_gate[facing=east,open=false]", "cobblestone_wall"),
    *("oak_fence_gate[facing=east,open=true]", "oak_fence_gate[facing=north,open=false]"),
    *("glass_pane", "iron_bars", "oak_slab", "oak_slab[type=top]", "oak_stairs[facing=west]"),
    *("white_carpet", "snow", "snow[layers=2]", "snow[layers=5]", "ladder[facing=west]"),
    *("ladder[facing=east]", "oak_trapdoor", "oak_trapdoor[open=true]", "iron_trapdoor", "cobweb"),
    *("lily_pad", "sweet_berry_bush[age=3]", "soul_sand", "ice", "water", "lava", "magma_block"),
    *("cactus", "farmland", "white_bed", "fire", "soul_fire", "nether_portal[axis=x]", "campfire"),
    *("oak_door[facing=east,open=false]", "oak_door[facing=north,open=false]", "honey_block"),
    *("oak_door[facing=east,open=true]", "iron_door[facing=east,open=false]", "powder_snow"),
    *("iron_door[facing=east,open=true]", "vine", "chest", "bamboo", "lantern", "scaffolding"),
)

Case = tuple[str, int]


def distinct_states() -> list[int]:
    """Return one state of each kind of shape that a body meets."""
    registry = Registry.load()
    kinds: dict[object, int] = {}
    for name in registry.block_names:
        states = registry.state_ids(name)
        boxes = registry.boxes(states[0])
        kind = name if name in ("ladder", "water", "lava", "fire", "cobweb") else ""
        layer = bool(boxes) and boxes[0][4] < 0.1, bool(boxes) and boxes[0][4] > 1
        for state in states:
            door: tuple[object, ...] = ()
            if is_doorway(name):
                told = registry.properties(state)
                door = (name.split("_")[-1], name.startswith("iron"), told.get("half"))
                door += (told["open"], told["facing"])
            key = (registry.is_solid(name), kind, layer, door, registry.boxes(state))
            kinds.setdefault(key, state)
    return sorted(kinds.values())


def upper(state: int) -> int:
    """Return the block above one: the other half of a door, else the same."""
    registry = Registry.load()
    is_door = registry.name(state).endswith("_door")
    return registry.changed(state, half="upper") if is_door else state


def lane(kind: str, state: int, blocks: np.ndarray) -> Position:
    """Build a lane (length, height); return its goal, with z 0."""
    stone = Registry.load().state_id("stone")
    blocks[:, : FLOOR + 1] = stone
    goal = (LENGTH - 2, FLOOR + 1, 0)
    match kind:
        case "barrier":
            blocks[MIDDLE, FLOOR + 1] = state
        case "high barrier":
            blocks[MIDDLE, FLOOR + 1], blocks[MIDDLE, FLOOR + 2] = state, upper(state)
        case "beam":
            blocks[MIDDLE, FLOOR + 2] = state
        case "tunnel":
            blocks[:, FLOOR + 3] = stone
            blocks[MIDDLE, FLOOR + 1] = state
        case "floor":
            blocks[MIDDLE, FLOOR] = state
        case "bridge":
            blocks[MIDDLE - 2 : MIDDLE + 3, 1 : FLOOR + 1] = 0
            blocks[MIDDLE - 2 : MIDDLE + 3, FLOOR] = state
        case "below a layer":
            carpet = Registry.load().state_id("white_carpet")
            blocks[MIDDLE, FLOOR + 1], blocks[MIDDLE, FLOOR + 2] = state, carpet
        case "step":
            blocks[MIDDLE, FLOOR + 1] = state
            blocks[MIDDLE + 1 :, FLOOR + 1] = stone
            goal = (LENGTH - 2, FLOOR + 2, 0)
        case _:
            far, up, ceiling = (int(part) for part in kind.split()[1:])
            blocks[4:, 1:] = 0
            blocks[4 + far :, : FLOOR + up + 1] = stone
            if ceiling:
                blocks[:, FLOOR + 3] = stone
            goal = (LENGTH - 2, FLOOR + up + 1, 0)
    return goal


@cache
def built(cases: tuple[Case, ...]) -> tuple[Snapshot, dict[str, Position]]:
    """Return lanes side by side, with walls between them, and the goal of each agent."""
    stone = Registry.load().state_id("stone")
    box = Box((0, 0, 0), (LENGTH - 1, HEIGHT - 1, 2 * len(cases)))
    blocks = np.zeros(box.shape, dtype=np.int32)
    blocks[:, :, ::2] = stone
    goals, agents = {}, {}
    for number, (kind, state) in enumerate(cases):
        z = 2 * number + 1
        x, y, _ = lane(kind, state, blocks[:, :, z])
        goals[f"a{number}"] = (x, y, z)
        agents[f"a{number}"] = AgentState((1.5, FLOOR + 1.0, z + 0.5))
    blocks[0], blocks[-1] = stone, stone
    return Snapshot(0, box, Terrain.of(blocks), {}, agents), goals


def walked(world: World, cases: tuple[Case, ...]) -> list[tuple[bool, Point]]:
    """Let agents walk through lanes; return whether each arrived, and where it ended."""
    start, goals = built(cases)
    body = world.open_body("/", "seed", start, lambda frame: None)
    try:
        programs = {
            name: f"await goToPosition(bot, new Vec3{goal}, 0)" for name, goal in goals.items()
        }
        results = body.run(programs, LIMIT)
        there = body.snapshot().agents
    finally:
        body.close()
    return [(results[name].ok, there[name].position) for name in goals]


def plans(cases: tuple[Case, ...]) -> list[bool]:
    """Return whether planners find a way through each lane."""
    start, goals = built(cases)
    floor = Floor(Registry.load(), start.blocks)
    begins = [(1, FLOOR + 1, goal[2]) for goal in goals.values()]
    ways = ways_from(start.box, [floor], begins, diagonal=False, most=10_000)
    assert ways is not None
    return [goal in ways.cells for goal in goals.values()]


def parts(cases: Sequence[Case]) -> Iterator[tuple[Case, ...]]:
    for first in range(0, len(cases), AT_ONCE):
        yield tuple(cases[first : first + AT_ONCE])


def names(cases: Sequence[Case]) -> list[str]:
    return [f"{kind}: {Registry.load().text(state)}" for kind, state in cases]


@pytest.fixture(scope="module")
def scripted() -> Iterator[World]:
    with_world = open_world("scripted", 0)
    yield with_world
    with_world.close()


KINDS = ("barrier", "high barrier", "floor", "bridge", "beam", "tunnel")
GAPS = [f"gap {far} {up} {low}" for far in (1, 2, 3, 4) for up in (1, 0, -1, -2) for low in (0, 1)]


def cases_by_day() -> list[Case]:
    registry = Registry.load()
    states = [registry.state_id(text) for text in BY_DAY]
    return [(KINDS[n % 2], state) for n, state in enumerate(states)][:: at_night(1, 3)]


def check(embedded: World, scripted: World, cases: Sequence[Case]) -> None:
    """Compare walks in both worlds, and planners' ways, through some lanes."""
    for part in parts(cases):
        real, told = walked(embedded, part), walked(scripted, part)
        assert dict(zip(names(part), told, strict=True)) == {
            name: (ok, pytest.approx(feet, abs=0.45 if ok else 99))
            for name, (ok, feet) in zip(names(part), real, strict=True)
        }
        # Planners take no jumps and no ladders, and drop by one block only.
        for name, (ok, _), planned in zip(names(part), told, plans(part), strict=True):
            assert ok or not planned, name


@pytest.fixture(scope="module")
def embedded() -> Iterator[World]:
    world = open_world("embedded", 0)
    yield world
    world.close()


def test_bodies_pass_alike_in_both_worlds(embedded: World, scripted: World) -> None:
    check(embedded, scripted, cases_by_day())


@pytest.mark.parametrize("kind", few_by_day(KINDS, 0))
def test_bodies_pass_alike_for_all_shapes(kind: str, scripted: World) -> None:
    # All of them at night; else each kind has others.
    step = at_night(1, 8 * len(KINDS))
    states = distinct_states()[8 * KINDS.index(kind) % step :: step]
    for first in range(0, len(states), 96):
        # Each bot takes memory of Node until its world is closed.
        world = open_world("embedded", 0)
        try:
            check(world, scripted, [(kind, state) for state in states[first : first + 96]])
        finally:
            world.close()


def test_bodies_jump_onto_layers_above_open_gates_alike(embedded: World, scripted: World) -> None:
    gates = [f"oak_fence_gate[facing={way},open=true]" for way in ("east", "north")]
    states = [Registry.load().state_id(text) for text in (*gates, "air", "oak_slab", "oak_fence")]
    check(embedded, scripted, [("below a layer", state) for state in states])


def test_gaps_are_jumped_alike(embedded: World, scripted: World) -> None:
    stone = Registry.load().state_id("stone")
    check(embedded, scripted, [(kind, stone) for kind in GAPS[::3]])


@pytest.mark.parametrize("gap", [True, False])
@pytest.mark.parametrize("door", ["open=true", "open=false"])
def test_doors_are_passed_alike_only_if_there_is_no_other_way(
    door: str, *, gap: bool, embedded: World, scripted: World
) -> None:
    registry = Registry.load()
    box = Box((0, 0, 0), (8, 4, 8))
    blocks = np.zeros(box.shape, dtype=np.int32)
    blocks[:, 0] = registry.state_id("stone")
    blocks[4, 1:3, : 8 if gap else 9] = registry.state_id("bricks")
    for y, half in ((1, "lower"), (2, "upper")):
        blocks[4, y, 4] = registry.state_id(f"oak_door[facing=east,half={half},{door}]")
    start = Snapshot(0, box, Terrain.of(blocks), {}, {"ann": AgentState((1.5, 1.0, 4.5))})
    for world in (scripted, embedded):
        cells: set[Position] = set()

        def note(frame: Frame, cells: set[Position] = cells) -> None:
            cells.update(block_at(each.position) for each in frame.agents.values())

        body = world.open_body("/", "seed", start, note)
        try:
            result = body.run({"ann": "await goToPosition(bot, new Vec3(7, 1, 4), 0)"}, LIMIT)
        finally:
            body.close()
        assert result["ann"].ok
        assert ((4, 1, 4) in cells, (4, 1, 8) in cells) == (not gap, gap)


@pytest.mark.parametrize(
    ("block", "passes"),
    [
        ("bricks", False),
        ("oak_fence", False),
        ("oak_fence_gate[facing=east]", True),
        ("oak_fence_gate[facing=north]", False),
        ("iron_door[facing=east,half=lower]", False),
        ("cobblestone_wall", False),
        ("cobweb", False),
        ("lava", False),
        ("fire", False),
        ("snow[layers=2]", True),
        ("ladder[facing=west]", True),
        ("oak_slab", True),
    ],
)
def test_walkers_and_planners_agree_about_a_barrier(block: str, *, passes: bool) -> None:
    registry = Registry.load()
    kind = "high barrier" if block.startswith(("bricks", "iron_door")) else "barrier"
    cases = ((kind, registry.state_id(block)),)
    start, goals = built(cases)
    ground = Ground(registry, start.box, start.blocks).with_doors_opened
    (goal,) = goals.values()
    assert (ground.way((1, FLOOR + 1, 1), Near(goal, 0)) is not None) is passes
    assert plans(cases) == [passes]


@pytest.mark.parametrize(
    ("block", "feet"),
    [
        ("oak_slab", 4.5),
        ("white_carpet", 4.0625),
        ("soul_sand", 4.875),
        ("air", 4.0),
        ("snow", 4.0),
    ],
)
def test_feet_are_on_top_of_low_blocks(block: str, feet: float) -> None:
    registry = Registry.load()
    start, _ = built((("barrier", registry.state_id(block)),))
    ground = Ground(registry, start.box, start.blocks)
    way = ground.way((1, FLOOR + 1, 1), Near((LENGTH - 2, FLOOR + 1, 1), 0))
    assert way is not None
    (cell,) = (cell for cell in way if cell[0] == MIDDLE)
    assert ground.feet(cell) == (MIDDLE + 0.5, feet, 1.5)
    assert ground.cell_of(ground.feet(cell)) == cell


def test_feet_are_in_one_cell_only() -> None:
    registry = Registry.load()
    texts = ("air", *BY_DAY)
    shapes = [registry.state_id(text) for text in texts]
    box = Box((0, 0, 0), (2 * len(shapes), 4, 2 * len(shapes)))
    blocks = np.zeros(box.shape, dtype=np.int32)
    blocks[:, 0] = registry.state_id("stone")
    for a, b in np.ndindex(len(shapes), len(shapes)):
        blocks[2 * a, 1, 2 * b], blocks[2 * a, 2, 2 * b] = shapes[a], shapes[b]
    for ground in (Ground(registry, box, blocks), Ground(registry, box, blocks).with_doors_opened):
        found = [at for at in box.positions() if ground.stands(at)]
        assert len(found) > 9_000
        assert {cell for cell in found if ground.cell_of(ground.feet(cell)) != cell} == set()


def planned_walk(seed: int) -> tuple[Snapshot, list[Position]]:
    """Return a floor with blocks of many shapes, and a walk on a planner's map of it."""
    random, registry = Random(seed), Registry.load()
    box = Box((0, 0, 0), (12, 5, 12))
    blocks = np.zeros(box.shape, dtype=np.int32)
    blocks[:, :2] = registry.state_id("stone")
    shapes = [registry.state_id(text) for text in BY_DAY if "door" not in text]
    for x, z in np.ndindex(13, 13):
        if (x, z) != (6, 6) and random.random() < 0.35:
            blocks[x, 2, z] = random.choice(shapes)
    begin = (6, 2, 6)
    terrain = Terrain.of(blocks)
    ways = ways_from(box, [Floor(registry, terrain)], [begin], diagonal=False, most=10_000)
    assert ways is not None
    walk = [begin]
    while len(walk) < 25:
        number = ways.cells.index(walk[-1])
        ahead = [to for to in ways.moves[0, number].tolist() if to != number]
        walk.append(ways.cells[random.choice(ahead)])
    agents = {"ann": AgentState((6.5, 2.0, 6.5))}
    return Snapshot(0, box, terrain, {}, agents), walk


@pytest.mark.parametrize("seed", few_by_day(range(8)))
def test_walks_on_planners_maps_are_walks_of_programs(
    seed: int, embedded: World, scripted: World
) -> None:
    start, walk = planned_walk(seed)
    program = "\n".join(f"await goToPosition(bot, new Vec3{cell}, 0)" for cell in walk)
    for world in (scripted, embedded):
        body = world.open_body("/", "seed", start, lambda frame: None)
        try:
            result = body.run({"ann": program}, 4000)["ann"]
        finally:
            body.close()
        assert result.ok, (result.error, walk)


def drawn_walks(seed: int) -> tuple[Snapshot, list[list[Position]]]:
    """Return a floor with blocks of many shapes, and walks there that models of Ann's mind took.

    The first are those of histories. The others are drawn by an observer who was walled in.
    """
    start, walk = planned_walk(seed)
    registry, box = Registry.load(), start.box
    blocks = start.blocks.draft()
    for x, y, z in np.ndindex(3, 3, 3):
        blocks[10 + x, 2 + y, 10 + z] = registry.state_id("bricks")
    blocks[11, 2, 11] = blocks[11, 3, 11] = registry.state_id("air")
    start = replace(
        start, blocks=blocks.terrain(), agents={**start.agents, "eye": AgentState((6.5, 2.0, 6.5))}
    )
    world = bn.ScriptedWorld.from_snapshot(start)
    ground = Ground(registry, box, start.blocks).with_doors_opened
    near = next(cell for cell in walk[::-1] if max(cell[0], cell[2]) < 10)
    goals, utilities = {"there": {"at": near}}, {"there": 30}
    model = bn.MindModel("ann", goals, utilities, rationality=0.3, stay_cost=1)
    kinds = [registry.name(state) for state in np.unique(start.blocks.dense())]
    with bn.Nest(world, static_blocks=kinds) as nest:
        world.step(1)
        world.place_agent("eye", (11.5, 2, 11.5))
        world.step(18)
        anything = [{"agent": "ann", "at": near, "mistaken": 0.5}]
        imagined = nest["/"].imagine(1, actors={"ann": {"walks": model}}, evidence=anything, n=3)
        walks = [[ground.cell_of(feet) for feet in h.feet("ann").values()] for h in imagined]
        inferred = nest["/eye"].infer(model)
        assert not nest["/eye"].state.agents["ann"].current
        walks += [list(path.cells.values()) for path in inferred.sample_paths(3)]
    return replace(start, tick=0), walks


@pytest.mark.parametrize("seed", few_by_day(range(8)))
def test_walks_that_models_of_minds_take_are_walks_of_programs(
    seed: int, embedded: World, scripted: World
) -> None:
    start, walks = drawn_walks(seed)
    assert len(walks) == 6 and sum(len(set(walk)) for walk in walks) > 12
    start = replace(start, agents={"ann": start.agents["ann"]})
    for walk in walks:
        program = "\n".join(f"await goToPosition(bot, new Vec3{cell}, 0)" for cell in walk)
        for world in (scripted, embedded):
            body = world.open_body("/", "seed", start, lambda frame: None)
            try:
                result = body.run({"ann": program}, 4000)["ann"]
            finally:
                body.close()
            assert result.ok, (result.error, walk)
