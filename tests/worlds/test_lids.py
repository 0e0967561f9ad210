"""A block on the lid of a chest keeps it shut, in both worlds, if Minecraft's rule says so."""

from collections.abc import Iterator
from typing import Any

import pytest
from tests.shared_worlds import WORLDS

import beliefnest as bn

pytestmark = pytest.mark.usefixtures("kept_worlds")

ROW: dict[str, str] = {
    "stone": "shut",
    "oak_planks": "shut",
    "furnace": "shut",
    "soul_sand": "shut",
    "chest": "opens",
    "glass": "opens",
    "oak_leaves": "opens",
    "oak_slab[type=bottom]": "opens",
    "oak_slab[type=double]": "shut",
    "oak_stairs": "opens",
    "redstone_block": "opens",
    "glowstone": "opens",
}
"""Blocks above single chests, and whether these open."""


@pytest.fixture(scope="module", params=WORLDS)
def nest(request: pytest.FixtureRequest) -> Iterator[bn.Nest]:
    """Open a row of chests, each under a block, with double chests and a barrel beside them."""
    last = 2 * len(ROW)
    singles = [[1 + 2 * n, 1, 1] for n in range(len(ROW))]
    stones = [[2, 2, 9], [5, 2, 9], [8, 2, 9]]
    scenario: dict[str, Any] = {
        "name": "lids",
        "box": [[0, 0, 0], [last, 4, 10]],
        "agents": {"ann": {"position": [1.5, 1, 5.5]}},
        "blocks": [
            {"block": "stone", "fill": [[0, 0, 0], [last, 0, 10]]},
            *({"block": b, "at": [x, 2, z]} for b, (x, _, z) in zip(ROW, singles, strict=True)),
            *({"block": "stone", "at": place} for place in stones),
            {"block": "chest[facing=north,type=left]", "at": [1, 1, 9]},
            {"block": "trapped_chest[facing=north,type=left]", "at": [5, 1, 9]},
        ],
        "containers": [
            *({"at": place, "items": {"apple": 2}} for place in singles),
            {"at": [2, 1, 9], "block": "chest[facing=north,type=right]"},
            {"at": [6, 1, 9], "block": "trapped_chest[facing=north,type=right]"},
            {"at": [8, 1, 9], "block": "barrel"},
        ],
    }
    with bn.Nest.open(bn.Scenario.from_mapping(scenario), world=request.param) as nest:
        yield nest


def _fault(nest: bn.Nest, code: str) -> str:
    error = nest["/"].run("ann", code, timeout_ticks=400).error
    return "" if error is None else error.message.partition(": ")[2]


@pytest.mark.parametrize(("number", "block"), list(enumerate(ROW)))
def test_a_chest_opens_unless_an_opaque_cube_lies_on_it(
    nest: bn.Nest, number: int, block: str
) -> None:
    place = f"({1 + 2 * number}, 1, 1)"
    fault = _fault(nest, f"await getItemFromChest(bot, new Vec3{place}, {{apple: 1}})")
    name = block.partition("[")[0]
    shut = f"the chest at {place} cannot be opened: {name} lies on its lid. Remove it first."
    assert fault == (shut if ROW[block] == "shut" else "")


@pytest.mark.parametrize("x", [1, 2, 5, 6])
def test_a_double_chest_is_shut_by_a_block_on_either_half(nest: bn.Nest, x: int) -> None:
    shut = f"the chest at ({x}, 1, 9) cannot be opened: stone lies on its lid. Remove it first."
    assert _fault(nest, f"await openContainer(bot, new Vec3({x}, 1, 9))") == shut


def test_a_method_of_the_bot_says_the_same_at_once(nest: bn.Nest) -> None:
    code = (
        "await goToPosition(bot, new Vec3(2, 1, 8), 1)\n"
        "await bot.openContainer(bot.blockAt(new Vec3(2, 1, 9)))"
    )
    before = nest.tick
    fault = nest["/"].run("ann", code, timeout_ticks=400).error
    assert fault is not None
    assert fault.message.startswith("the chest at (2, 1, 9) cannot be opened: stone lies on its")
    assert nest.tick - before < 200


def test_a_barrel_has_no_lid(nest: bn.Nest) -> None:
    assert _fault(nest, "await openContainer(bot, new Vec3(8, 1, 9))") == ""
