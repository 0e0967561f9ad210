"""Doors of environments for learners: nested beliefs as arrays, masks, and what is rendered."""

from msgspec.structs import replace
from tests.noninterference.doors import door
from tests.noninterference.environment_doors import _BOUNDS
from tests.noninterference.pairs import AGENTS, Played

from beliefnest.env.actions import Calls, NotKnownError
from beliefnest.env.flat import ActorMind, FlatActions
from beliefnest.env.order import KINDS, KnownOrder
from beliefnest.env.rendering import line, picture
from beliefnest.skills.calls import Call
from beliefnest.world.paths import parse_path, path_text, paths_below
from beliefnest.world.values import Position
from beliefnest.worlds.scripted.footpaths import InReach, Near
from beliefnest.worlds.scripted.ground_cache import Grounds
from beliefnest.worlds.scripted.hand import REACH

_BOUNDS_OF_FLAT = replace(_BOUNDS, most={**dict.fromkeys(KINDS, 8), "places": 0, "cells": 3})
_FLAT = FlatActions(Calls(_BOUNDS_OF_FLAT, {"hello": ()}), _BOUNDS_OF_FLAT.most, speaks=True)
_CELLS = ((2, 1, 1), (6, 1, 3), (10, 1, 3))
"""Cells in the western room, in the wall, and in the eastern room."""
_GROUNDS = Grounds()


@door(every=4)
def nested_arrays(world: Played, path: str) -> object:
    """Return an observation with nested beliefs as arrays."""
    order, bounds = KnownOrder(), replace(_BOUNDS, nested=(9, 4))
    own = world.nest[path].state
    order.note(own)
    paths = paths_below(parse_path(path, AGENTS), 1, AGENTS)[1:]
    below = {path: world.nest[path_text(path)].state for path in paths}
    for state in below.values():
        order.note(state)
    told = {path: bounds.arrays(order, state) for path, state in below.items()}
    found = bounds.with_nested(bounds.arrays(order, own), order, told)
    return {name: array.tolist() for name, array in found.items()}


@door(every=2)
def masks(world: Played, path: str) -> object:
    """Return which actions can begin by the belief, and what their numbers stand for."""
    state, order = world.nest[path].state, KnownOrder()
    order.note(state)
    ground = _GROUNDS.of(state.box, state.blocks.terrain).with_doors_opened

    def may_reach(place: Position, near: float | None) -> bool:
        feet = state.agents[state.path[-1]].position
        goal = InReach(place, REACH) if near is None else Near(place, near)
        return feet is not None and ground.may_lead(ground.cell_of(feet), goal)

    mind = ActorMind(state.path[-1], state, order.things, (), _CELLS, True, may_reach)
    calls = [_call(number, mind) for number in range(len(_FLAT.offers))]
    return _FLAT.mask(mind).tolist(), calls, order.things


def _call(number: int, mind: ActorMind) -> Call | None:
    try:
        return _FLAT.call(number, mind)
    except NotKnownError:
        return None


@door(every=12)
def shown(world: Played, path: str) -> object:
    """Return the picture and the line of an environment that shows a belief."""
    return picture(world.nest, path).tobytes(), line(world.nest, path)
