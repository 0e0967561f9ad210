"""Films of participants do not tell how long others, out of sight, go on."""

from pathlib import Path

import pytest
from PIL import Image

import beliefnest as bn
from beliefnest.cli.app import run_command_line
from beliefnest.studies.participants.film import SceneFilm, read_film

FLOOR = {(x, 0, z): "stone" for x in range(12) for z in range(5)}
WALL = {(6, y, z): "bricks" for y in range(4) for z in range(5)}


def film(quiet: int, act: str, store: Path | None = None) -> SceneFilm:
    """Return the film of Ann, after whose last act Bob goes on behind a wall."""
    world = bn.ScriptedWorld(
        ((0, 0, 0), (11, 3, 4)),
        FLOOR | WALL,
        {"ann": (2.5, 1, 1.5), "bob": (8.5, 1, 1.5)},
        containers={(2, 1, 3): {"apple": 1}},
    )
    with bn.Nest(world, bn.Perception(hearing="sight"), store=store) as nest:
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


def test_an_animation_of_a_belief_alone_is_as_long(tmp_path: Path) -> None:
    frames = []
    for quiet in (0, 20):
        run, picture = tmp_path / f"{quiet}.bn", tmp_path / f"{quiet}.gif"
        film(quiet, "walk", run)
        asked = ["show", str(run), "--path", "/ann", "--against", "/ann", "--gif", str(picture)]
        assert run_command_line(asked) == 0
        with Image.open(picture) as shown:
            frames.append(shown.n_frames)
    assert frames[0] == frames[1]
