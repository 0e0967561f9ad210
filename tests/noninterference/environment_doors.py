"""Doors of environments: beliefs as arrays and as plain data, with the numbers of their holder."""

from tests.noninterference.doors import door
from tests.noninterference.pairs import BOX, Played

from beliefnest.belief.plain import belief_json
from beliefnest.env.bounds import SpaceBounds
from beliefnest.env.order import KINDS, KnownOrder
from beliefnest.world.values import Box

_BOUNDS = SpaceBounds(Box.between(*BOX), dict.fromkeys(KINDS, 40), ("hello",))
_EVERY = 3
"""Ticks from one observation to the next."""


@door(every=4)
def arrays(world: Played, path: str) -> object:
    """Return the observations of an episode as arrays, and the numbers of things."""
    order, found = KnownOrder(), []
    for tick in range(0, world.nest.tick + 1, _EVERY):
        state = world.nest.at(tick)[path].state
        order.note(state)
        told = _BOUNDS.arrays(order, state, state.chat)
        found.append({name: array.tolist() for name, array in told.items()})
    return found, order.things


@door()
def plain_data(world: Played, path: str) -> object:
    """Return an observation as plain data."""
    return belief_json(world.nest[path].state)
