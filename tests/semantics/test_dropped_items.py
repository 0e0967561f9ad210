"""Knowledge of dropped items (semantics, section 3), in Minecraft."""

import pytest

import beliefnest as bn

pytestmark = pytest.mark.usefixtures("kept_worlds")

SCENARIO = {
    "name": "dropped",
    "box": [[0, 0, 0], [12, 3, 8]],
    "blocks": [
        {"block": "smooth_stone", "fill": [[0, 0, 0], [12, 0, 8]]},
        {"block": "stone_bricks", "fill": [[6, 1, 0], [6, 3, 6]]},
    ],
    "agents": {
        "sally": {"position": [2.5, 1, 6.5]},
        "anne": {"position": [4.5, 1, 2.5], "inventory": {"apple": 1}},
        "bob": {"position": [10.5, 1, 1.5]},
    },
}
TOSS = "await bot.toss(mcData.itemsByName.apple.id, null, 1); await bot.waitForTicks(30)"


def walk(x: int, z: int) -> str:
    return f"await goToPosition(bot, new Vec3({x}, 1, {z}), 0)"


def known(nest: bn.Nest, path: str) -> list[str]:
    return [item.name for item in nest[path].state.items.values()]


def test_an_item_is_known_to_who_saw_it_until_its_place_is_seen_empty() -> None:
    with bn.Nest.open(bn.Scenario.from_mapping(SCENARIO)) as nest:
        world = nest["/"]
        assert world.run("anne", TOSS).ok
        assert known(nest, "/") == known(nest, "/sally") == known(nest, "/sally/anne") == ["apple"]
        # A wall stands between.
        assert known(nest, "/bob") == known(nest, "/sally/bob") == []
        assert world.run("sally", walk(11, 7)).ok
        (lying,) = world.state.items.values()
        x, _, z = lying.position
        assert world.run("anne", walk(int(x), int(z))).ok
        assert known(nest, "/") == known(nest, "/anne") == []
        assert known(nest, "/sally") == known(nest, "/sally/anne") == ["apple"]
        assert world.run("sally", walk(2, 6)).ok
        assert known(nest, "/sally") == known(nest, "/sally/anne") == []
