"""Still: picture of one scene for people who know nothing of simulators, ticks and positions."""

import math
from collections.abc import Mapping

from msgspec.structs import replace

from beliefnest.belief.grounds import Source
from beliefnest.pictures.figure import MARGIN, TEXT_SIZE
from beliefnest.pictures.legend import draw_legend
from beliefnest.pictures.marks import Drawing
from beliefnest.pictures.palette import Mark, agent_looks
from beliefnest.pictures.panel import draw_body
from beliefnest.pictures.plan import SignKind
from beliefnest.pictures.scene import AgentSight, Device, PlanColumn, Scene, Store
from beliefnest.world.values import Point, Position
from beliefnest.world.words import titled

_WIDTH = 260.0
"""Width of a still, in points."""
_WORDS: Mapping[SignKind, str] = {
    "container": "closed, or out of sight",
    "unknown blocks": "never seen, or out of sight",
}


def draw_still(scene: Scene, names: Mapping[Position, str]) -> Drawing:
    """Draw what the owner of a scene perceives, without path, ticks, ages and positions.

    Remembered and reported things are left out: agents out of sight, contents of containers that
    are closed or out of sight, states of doors and switches, dropped items. Walls and floors stay
    as they are remembered. A narrator perceives everything.

    Args:
        scene: The scene, with the sight of its owner, and compared with no other simulator.
        names: Names of containers, by position.
    """
    plain = _with_names(_perceived(scene), names)
    looks = agent_looks(plain.agents)
    inner = _WIDTH - 2 * MARGIN
    opened = [each for each in plain.stores if not each.unknown]
    body = draw_body(plain, looks, (MARGIN, MARGIN), inner, TEXT_SIZE, listed=opened)
    at = (MARGIN, body.bottom + 4)
    shut = len(opened) < len(plain.stores)
    kinds = body.kinds if shut else body.kinds - {"container"}
    legend = draw_legend(kinds, looks, at, inner, TEXT_SIZE * 0.95, _WORDS)
    return Drawing(_WIDTH, legend.bottom + MARGIN, (*body.marks, *legend.marks), "")


def _perceived(scene: Scene) -> Scene:
    """Return the part of a scene that its owner perceives at its tick."""
    out_of_sight = {each.position for each in scene.devices if _is_remembered(each)}
    low_x, low_z = scene.low
    cells = tuple(
        tuple(
            PlanColumn(cell.ground, None, wrong=False)
            if (low_x + i, scene.height, low_z + k) in out_of_sight
            else cell
            for k, cell in enumerate(row)
        )
        for i, row in enumerate(scene.cells)
    )
    return replace(
        scene,
        cells=cells,
        stores=tuple(_shut(store) if _is_remembered(store) else store for store in scene.stores),
        devices=tuple(each for each in scene.devices if each.position not in out_of_sight),
        items=tuple(each for each in scene.items if _sees(scene, each[1])),
        people=tuple(each for each in scene.people if each.mark is Mark.CURRENT),
    )


def _is_remembered(thing: Store | Device) -> bool:
    is_assumed = thing.source in (Source.PRIOR, Source.EDITED)
    return bool(thing.age or thing.teller or is_assumed)


def _shut(store: Store) -> Store:
    """Return a container of which only the outside is known."""
    return replace(
        store, items={}, complete=False, mark=Mark.UNKNOWN, age=0, teller="", source=None
    )


def _sees(scene: Scene, point: Point) -> bool:
    """Return True if the owner sees the column of a point now."""
    if scene.path == "/":
        return True
    i, k = math.floor(point[0]) - scene.low[0], math.floor(point[2]) - scene.low[1]
    across, down = scene.size
    return 0 <= i < across and 0 <= k < down and any(each.seen[i, k] for each in scene.sights)


def _with_names(scene: Scene, names: Mapping[Position, str]) -> Scene:
    """Return a scene whose containers and agents have the names that stories use."""
    return replace(
        scene,
        agents=tuple(map(titled, scene.agents)),
        stores=tuple(_named(store, names) for store in scene.stores),
        people=tuple(replace(each, name=titled(each.name)) for each in scene.people),
        sights=tuple(AgentSight(titled(each.name), each.seen) for each in scene.sights),
    )


def _named(store: Store, names: Mapping[Position, str]) -> Store:
    kind = (store.name or "container").replace("_", " ")
    return replace(store, label=names.get(store.position, kind))
