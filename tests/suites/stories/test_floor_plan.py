"""Within a room all is seen, and nothing of it from anywhere else."""

import numpy as np
from tests.suites.stories.texts import SHARED_SECRET

from beliefnest.perception.sight import Sight
from beliefnest.suites.stories import lay_out, read_story
from beliefnest.suites.stories.floor_plan import feet, item_names
from beliefnest.world.registry import Registry
from beliefnest.world.values import EYE_HEIGHT

PLAN = lay_out(read_story(SHARED_SECRET))
BOX, GRID = PLAN.snapshot.box, PLAN.snapshot.blocks.dense()
SIGHT = Sight(Registry.load(), max_visible_distance=None)
GEOMETRY = SIGHT.geometry(GRID, BOX.low)


def eye_of(block):
    x, y, z = feet(block)
    return (x, y + EYE_HEIGHT, z)


def seen_places(block):
    visible = GEOMETRY.visible_blocks(eye_of(block), 0.0, 0.0)
    return {place for place, position in PLAN.places.items() if visible[BOX.index(position)]}


def sees_stands(block, stands):
    return GEOMETRY.sees_agents(eye_of(block), 0.0, 0.0, [feet(stand) for stand in stands])


def test_whoever_stands_in_a_room_sees_its_containers_and_no_others():
    for (room, _), stand in PLAN.stands.items():
        assert seen_places(stand) == {place for place in PLAN.places if place.room == room}


def test_whoever_stands_in_a_room_sees_everyone_there_and_nobody_else():
    everywhere = [*PLAN.stands.items(), *(((None, a), cell) for a, cell in PLAN.apart.items())]
    for (room, _), stand in PLAN.stands.items():
        seen = sees_stands(stand, [place for _, place in everywhere])
        assert seen.tolist() == [other == room for (other, _), _ in everywhere]


def test_from_a_cell_and_from_the_corridor_nobody_is_seen_and_nothing():
    corridor = [(x, 1, 4) for x in range(1, BOX.high[0])]
    assert all(GRID[block] == 0 for block in corridor)
    others = [*PLAN.stands.values(), *PLAN.apart.values()]
    for block in (*corridor, *PLAN.apart.values()):
        assert seen_places(block) == set()
        seen = sees_stands(block, others)
        assert [o for o, s in zip(others, seen, strict=True) if s] == [
            o for o in others if o == block
        ]


def test_every_room_and_cell_can_be_walked_to():
    free = GRID[:, 1, :] == 0
    reached = np.zeros_like(free)
    reached[1, 4] = True
    for _ in range(free.size):
        spread = reached.copy()
        spread[1:] |= reached[:-1]
        spread[:-1] |= reached[1:]
        spread[:, 1:] |= reached[:, :-1]
        spread[:, :-1] |= reached[:, 1:]
        spread &= free
        if (spread == reached).all():
            break
        reached = spread
    assert all(reached[x, z] for x, _, z in (*PLAN.stands.values(), *PLAN.apart.values()))


def test_no_two_containers_share_a_position_and_all_hold_what_the_story_says():
    assert len(set(PLAN.places.values())) == len(PLAN.places)
    contents = PLAN.snapshot.containers
    assert set(contents) == set(PLAN.places.values())
    held = {PLAN.place_at(p): dict(items) for p, items in contents.items() if items}
    story = read_story(SHARED_SECRET)
    assert held == {place: {PLAN.items[t]: 1} for t, place in story.things.items()}


def test_each_thing_has_an_item_of_its_own():
    registry = Registry.load()
    names = item_names(("hat", "apple", "scarf", "stone", "air"), registry)
    assert list(names) == ["hat", "apple", "scarf", "stone", "air"]
    assert names["apple"] == "apple"
    assert names["stone"] == "stone"
    assert len(set(names.values())) == 5
    assert all(registry.has_item(item) and item != "air" for item in names.values())
