"""Still: picture of one scene for people who know nothing of simulators, ticks and positions."""

from collections.abc import Mapping
from dataclasses import replace

from beliefnest.pictures.figure import MARGIN, TEXT_SIZE
from beliefnest.pictures.legend import draw_legend
from beliefnest.pictures.marks import Drawing
from beliefnest.pictures.palette import Mark, agent_looks
from beliefnest.pictures.panel import draw_body
from beliefnest.pictures.scene import AgentSight, DrawnAgent, Scene, Store
from beliefnest.world.values import Position

__all__ = ["draw_still"]

_WIDTH = 260.0
"""Width of a still, in points."""
_UNSURE = (Mark.UNKNOWN, Mark.INCOMPLETE)
_WORDS: Mapping[str, str] = {"remembered": "seen there before, not in sight now"}


def draw_still(scene: Scene, names: Mapping[Position, str]) -> Drawing:
    """Draw a scene without path, ticks, ages and positions.

    Args:
        scene: The scene, which is compared with no other simulator.
        names: Names of containers, by position.
    """
    plain = _plain(scene, names)
    looks = agent_looks(plain.agents)
    inner = _WIDTH - 2 * MARGIN
    body = draw_body(plain, looks, (MARGIN, MARGIN), inner, TEXT_SIZE)
    at = (MARGIN, body.bottom + 4)
    unsure = any(store.mark in _UNSURE for store in plain.stores)
    kinds = body.kinds if unsure else body.kinds - {"container"}
    legend = draw_legend(kinds, looks, at, inner, TEXT_SIZE * 0.95, _WORDS)
    return Drawing(_WIDTH, legend.bottom + MARGIN, (*body.marks, *legend.marks), "")


def _plain(scene: Scene, names: Mapping[Position, str]) -> Scene:
    return replace(
        scene,
        agents=tuple(map(_titled, scene.agents)),
        stores=tuple(_named(store, names) for store in scene.stores),
        people=tuple(_person(person) for person in scene.people),
        sights=tuple(AgentSight(_titled(each.name), each.seen) for each in scene.sights),
    )


def _named(store: Store, names: Mapping[Position, str]) -> Store:
    kind = (store.name or "container").replace("_", " ")
    return replace(store, label=names.get(store.position, kind), age=0)


def _person(person: DrawnAgent) -> DrawnAgent:
    return replace(person, name=_titled(person.name), age=0)


def _titled(name: str) -> str:
    return name[:1].upper() + name[1:]
