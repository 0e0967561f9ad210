"""The Sally-Anne task under the paper's three conditions, from geometry alone."""

import pytest

import beliefnest as bn

LEFT, RIGHT = (-2, -51, -4), (2, -51, -4)
BEFORE_LEFT, BEFORE_RIGHT = (-1.5, -51, -2.5), (2.5, -51, -2.5)
HIDDEN_FROM_ANNE, SEEN_BY_ALL, HIDDEN_FROM_OBSERVER = 9.5, 6.5, -8.5


def mirrored(point):
    """Return the point on the other side of the middle of the box, in x."""
    x, y, z = point
    return (1 - x, y, z)


def same(point):
    return point


def walls():
    floor = {(x, -52, z): "smooth_stone" for x in range(-11, 12) for z in range(-11, 12)}
    east = {(x, y, 1): "stone_bricks" for x in range(3, 12) for y in (-51, -50, -49)}
    west = {(x, y, -1): "stone_bricks" for x in range(-11, -4) for y in (-51, -50, -49)}
    return floor | east | west


def played(sallys_place, side=1):
    """Act the story out, with Sally's second place; in the mirror with side -1."""
    at = same if side == 1 else mirrored

    def cell(position):
        return (side * position[0], *position[1:])

    world = bn.ScriptedWorld(
        ((-11, -52, -11), (11, -49, 11)),
        {cell(position): block for position, block in walls().items()},
        {
            "sally": at((-0.5, -51, 3.5)),
            "anne": at((2.5, -51, -0.5)),
            "observer": at((-3.5, -51, 9.5)),
        },
        inventories={"sally": {"diamond": 1}},
        containers={cell(LEFT): {}, cell(RIGHT): {}},
        equipment={"anne": {"main_hand": "iron_chestplate"}},
    )
    nest = bn.Nest(world, static_blocks=["stone_bricks", "smooth_stone"])
    world.place_agent("sally", at(BEFORE_LEFT))
    world.deposit("sally", cell(LEFT), {"diamond": 1})
    world.place_agent("sally", at(sallys_place))
    world.place_agent("anne", at(BEFORE_LEFT))
    world.withdraw("anne", cell(LEFT), {"diamond": 1})
    world.place_agent("anne", at(BEFORE_RIGHT))
    world.deposit("anne", cell(RIGHT), {"diamond": 1})

    def diamond(path):
        """In which chests the diamond is, `left` and `right` as in the unmirrored world."""
        held = nest[path].state.containers
        sides = {"left": cell(LEFT), "right": cell(RIGHT)}
        return [name for name, place in sides.items() if held[place].items.get("diamond")]

    return diamond


CONDITIONS = [
    pytest.param((HIDDEN_FROM_ANNE, -51, 3.5), ["left"], ["left"], id="1-behind-a-wall"),
    pytest.param((SEEN_BY_ALL, -51, -5.5), ["right"], ["right"], id="2-in-sight"),
    pytest.param((HIDDEN_FROM_OBSERVER, -51, -4.5), ["right"], ["left"], id="3-unseen"),
]


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize(("sallys_place", "sally", "observer_of_sally"), CONDITIONS)
def test_where_each_believes_the_diamond_to_be(sallys_place, sally, observer_of_sally, side):
    diamond = played(sallys_place, side)
    assert diamond("/") == diamond("/observer") == diamond("/anne") == ["right"]
    assert diamond("/sally") == sally
    assert diamond("/observer/sally") == observer_of_sally


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize(
    ("x", "sally"),
    [
        pytest.param(2.5, ["right"], id="sees-both-moves"),
        pytest.param(3.5, [], id="sees-the-diamond-taken-only"),
        pytest.param(5.5, ["left"], id="sees-nothing"),
    ],
)
def test_either_side_of_the_edge_of_sally_s_sight(x, sally, side):
    diamond = played((x, -51, 3.5), side)
    assert diamond("/sally") == diamond("/observer/sally") == sally


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize(("x", "observer_of_sally"), [(-3.5, ["right"]), (-4.5, ["left"])])
def test_either_side_of_the_edge_of_the_observer_s_sight(x, observer_of_sally, side):
    diamond = played((x, -51, -4.5), side)
    assert diamond("/sally") == ["right"]
    assert diamond("/observer/sally") == observer_of_sally
