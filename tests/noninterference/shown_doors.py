"""Doors of pictures, and of everything that a simulator returns in words."""

from tests.noninterference.doors import door
from tests.noninterference.pairs import Played

from beliefnest.viewer.figures.plotting import Contained

_BELOW = {"/ann": "/ann/bob", "/ann/bob": "/ann/bob/ann"}
"""Paths with which paths are compared."""


@door(every=4)
def figures(world: Played, path: str) -> object:
    """Return the drawing of a belief, compared with itself: its false entries are not its own."""
    return world.nest[path].figure(path)._repr_html_()


@door()
def states(world: Played, path: str) -> object:
    """Return the state in words, and the blocks that the owner sees."""
    state = world.nest[path].state
    seen = world.nest[path].visible_blocks(path.rpartition("/")[2])
    return repr(state), state.perceived, seen.tobytes()


@door(every=8)
def explanations(world: Played, path: str) -> object:
    """Return the explanations of beliefs about what is in the western room."""
    if "carl" in path:  # Reasons tell where he really is.
        return None
    asked = [{"agent": name} for name in ("ann", "bob")]
    asked += [{kind: at} for at in world.places for kind in ("container", "block")]
    return [str(world.nest[path].explain(**each)) for each in asked]


@door(every=2)
def comparisons(world: Played, path: str) -> object:
    """Return the differences between a belief and one below it."""
    return world.nest.compare(path, _BELOW.get(path, "/ann"))


@door(every=2)
def claims(world: Played, path: str) -> object:
    """Return the claims that the owner heard, and the ticks of its percepts."""
    return world.nest[path].heard_claims, world.nest[path].changes(0)


@door(every=4)
def titles(world: Played, path: str) -> object:
    """Return the words that plots have for the contents of containers."""
    (state,) = world.nest.states([path]).values()
    return [Contained(at, None, "it").value(state) for at in world.places]
