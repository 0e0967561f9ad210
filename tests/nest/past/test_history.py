"""Nodes that join a head later: folded together, they are as if each was asked for alone."""

import beliefnest as bn
from beliefnest.world.paths import path_text

AGENTS = ("ann", "bob", "carl")


def played() -> bn.Nest:
    """Return a nest after some ticks in which agents lose sight of each other."""
    world = bn.ScriptedWorld(
        ((0, 0, 0), (8, 3, 8)),
        blocks={(4, y, z): "stone" for y in (1, 2, 3) for z in range(6)},
        agents={"ann": (2.5, 1, 2.5), "bob": (6.5, 1, 7.5), "carl": (2.5, 1, 6.5)},
        containers={(2, 1, 7): {"apple": 2}},
    )
    nest = bn.Nest(world)
    world.place_agent("bob", (6.5, 1, 2.5))
    world.withdraw("carl", (2, 1, 7), {"apple": 1})
    world.place_agent("ann", (3.5, 1, 7.5))
    return nest


def test_nodes_of_several_imaginations_are_folded_as_each_alone() -> None:
    paths = [(one, *other) for one in AGENTS for other in ((), *((name,) for name in AGENTS))]
    paths = [path for path in paths if len(path) == 1 or path[0] != path[1]]
    with played() as nest:
        minds = {agent: nest[f"/{agent}"].imagination(1) for agent in AGENTS}
        together = {path: nest[path_text(path)].state for path in paths}
    for path in paths:
        with played() as alone:
            wanted = alone[path_text(path)].state
            assert together[path].agents == wanted.agents
            assert together[path].containers == wanted.containers
            assert list(together[path].blocks) == list(wanted.blocks)
            view = minds[path[0]].view(path[1:])
            assert view.grid.tolist() == wanted.blocks.grid.tolist()
            assert {n: a.position for n, a in view.agents.items()} == {
                n: a.position for n, a in wanted.agents.items()
            }
