"""Doors of environments for learners: nested beliefs as arrays, and what is rendered."""

from dataclasses import replace

from tests.noninterference.doors import door
from tests.noninterference.environment_doors import _BOUNDS
from tests.noninterference.pairs import AGENTS, Played

from beliefnest.adapters.pettingzoo.order import KnownOrder
from beliefnest.adapters.pettingzoo.rendering import line, picture
from beliefnest.world.paths import parse_path, path_text, paths_below


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


@door(every=12)
def shown(world: Played, path: str) -> object:
    """Return the picture and the line of an environment that shows a belief."""
    return picture(world.nest, path).tobytes(), line(world.nest, path)
