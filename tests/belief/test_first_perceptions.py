"""Scenes that begin alike are looked at once; those that differ in anything are not mixed up."""

from collections.abc import Callable
from typing import Any

import pytest

import beliefnest as bn
from beliefnest.belief.first_perceptions import FirstPerceptions
from beliefnest.nest.past import history

PATHS = ("/ann", "/bob", "/ann/bob", "/bob/ann/bob")
Scene = dict[str, Any]


def believed(scene: Scene) -> list[object]:
    """Return the beliefs of nodes at first, and after an agent has walked."""
    world = bn.ScriptedWorld(
        ((0, 0, 0), (8, 3, 8)),
        blocks={(4, y, z): "stone" for y in (1, 2, 3) for z in range(scene.get("wall", 6))},
        agents={
            "ann": (2.5, 1, scene.get("z", 2.5)),
            "bob": (6.5, 1, 2.5),
        },
        containers={(2, 1, 7): {"apple": scene.get("apples", 1)}},
    )
    perception = bn.Perception(
        max_visible_distance=scene.get("far", 20),
        field_of_view=scene.get("field", 360),
        containers="transparent",
    )
    with bn.Nest(world, perception) as nest:
        held = [told(nest)]
        world.place_agent("bob", (6.5, 1, 7.5), yaw=1.0)
        return [*held, told(nest)]


def told(nest: bn.Nest) -> list[object]:
    """All that nodes hold."""
    states = nest.states(PATHS)
    return [
        (path, list(state.blocks), state.containers, state.agents) for path, state in states.items()
    ]


@pytest.fixture
def apart(monkeypatch: pytest.MonkeyPatch) -> Callable[[], None]:
    """From the call on nests share nothing."""

    def begin() -> None:
        monkeypatch.setattr(history, "_seeing", history._seeing.__wrapped__)

    return begin


SCENES: list[Scene] = [
    {},
    {"wall": 2},
    {"z": 6.5},
    {"apples": 2},
    {"far": 3},
    {"field": 90},
]


def test_what_was_looked_at_already_is_what_one_would_see(apart: Callable[[], None]) -> None:
    first = [believed(scene) for scene in SCENES]
    again = [believed(scene) for scene in SCENES]
    apart()
    alone = [believed(scene) for scene in SCENES]
    assert first == again == alone
    texts = [str(each) for each in alone]
    assert len(set(texts)) == len(texts)


def test_a_scene_that_begins_alike_is_not_looked_at_again(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    kept = []
    keep = FirstPerceptions._keep
    monkeypatch.setattr(
        FirstPerceptions,
        "_keep",
        lambda first, key, seen: (kept.append(key), keep(first, key, seen)),
    )
    scene = {"z": 3.25, "apples": 3}
    believed(scene)
    count = len(kept)
    assert count > 0
    believed(scene)
    assert len(kept) == count
