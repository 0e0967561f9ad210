"""Films of participants do not tell how long others, out of sight, go on."""

import pytest

import beliefnest as bn
from beliefnest.studies.participants.film import SceneFilm, read_film

FLOOR = {(x, 0, z): "stone" for x in range(12) for z in range(5)}
WALL = {(6, y, z): "bricks" for y in range(4) for z in range(5)}


def film(quiet: int, act: str) -> SceneFilm:
    """Return the film of Ann, after whose last act Bob goes on behind a wall."""
    world = bn.ScriptedWorld(
        ((0, 0, 0), (11, 3, 4)),
        FLOOR | WALL,
        {"ann": (2.5, 1, 1.5), "bob": (8.5, 1, 1.5)},
        containers={(2, 1, 3): {"apple": 1}},
    )
    with bn.Nest(world, bn.Perception(hearing="sight")) as nest:
        world.open("ann", (2, 1, 3))
        world.withdraw("ann", (2, 1, 3), {"apple": 1})
        world.step(2)
        for number in range(quiet):
            if act == "walk":
                world.place_agent("bob", (8.5 + number % 3, 1, 1.5))
            elif act == "speak":
                world.say("bob", "hello")
            else:
                world.think("bob", "hm")
        return read_film(nest, "/ann", 0)


@pytest.mark.parametrize("act", ["walk", "speak", "think"])
def test_a_film_is_as_long_as_its_mind_perceives(act: str) -> None:
    assert film(40, act) == film(0, act)
