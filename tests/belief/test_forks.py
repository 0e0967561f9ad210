"""Forks of forests: copied as a whole or node by node, they hold and perceive the same."""

from collections.abc import Sequence

import beliefnest as bn
from beliefnest.belief.forest import Forest
from beliefnest.belief.grounds import PerceivedEvent
from beliefnest.belief.initial import forked_forest
from beliefnest.belief.node_view import NodeView
from beliefnest.world.frames import Frame
from beliefnest.world.paths import BeliefPath
from beliefnest.world.values import AgentState, Event, EventKind

CHEST = (2, 1, 7)


class Silence:
    """History without events."""

    def events(self, count: int) -> Sequence[tuple[int, Event]]:
        """Return no events."""
        return ()

    def before(self, path: BeliefPath) -> Sequence[PerceivedEvent]:
        """Return no events."""
        return ()


def source() -> Forest:
    """Return a forest below Ann, in which some beliefs are out of date."""
    world = bn.ScriptedWorld(
        ((0, 0, 0), (8, 3, 8)),
        blocks={(4, y, z): "stone" for y in (1, 2, 3) for z in range(6)},
        agents={"ann": (2.5, 1, 2.5), "bob": (6.5, 1, 7.5), "carl": (2.5, 1, 6.5)},
        containers={CHEST: {"apple": 2}},
        equipment={"bob": {"head": "iron_helmet"}},
    )
    nest = bn.Nest(world, bn.Perception(containers="transparent", testimony="accept"))
    with nest:
        world.place_agent("bob", (6.5, 1, 2.5))
        world.set_block((3, 1, 8), "stone")
        world.withdraw("carl", CHEST, {"apple": 1})
        forest = nest["/ann"].imagination(2)._forest
    assert forest is not None
    # Poses that nobody believes in any more have numbers as well.
    for tick, z in enumerate((3.5, 4.5, 5.5), forest.tick + 1):
        forest.columns.add(Frame(tick, {"ann": AgentState((2.5, 1.0, z), yaw=float(tick))}))
    forest.advance(forest.columns.end)
    return forest


def held(forest: Forest) -> list[object]:
    """Return all that the nodes of a forest hold."""
    views = [NodeView(forest, path) for path in forest.paths]
    return [
        (view.path, view.numbers.dense().tolist(), view.agents, view.containers, view.items)
        for view in views
    ]


def test_a_fork_of_all_nodes_is_that_of_each_node() -> None:
    forest = source()
    root, *others = forest.paths
    assert len(others) == 6
    parts: list[int] = forest.table.tracked.tolist()[:1]
    whole = forked_forest(forest, Silence(), root, root, forest.tick, further=others)
    # With a cell to track besides, nodes are copied one by one.
    each = forked_forest(forest, Silence(), root, root, forest.tick, parts, further=others)
    assert held(whole) == held(each)
    before = held(forest)
    frames = [
        Frame(forest.tick + 1, {"bob": AgentState((4.5, 1.0, 7.5), yaw=1.0)}),
        Frame(forest.tick + 2, {"carl": AgentState((6.5, 1.0, 1.5))}, {(4, 1, 4): 0, (4, 2, 4): 0}),
        Frame(
            forest.tick + 3,
            {"ann": AgentState((3.5, 1.0, 6.5), inventory={"apple": 1})},
            containers={CHEST: {}},
            events=(
                Event(
                    EventKind.GET_ITEM_FROM_CHEST, "ann", {"position": CHEST, "items": {"apple": 1}}
                ),
            ),
        ),
    ]
    for frame in frames:
        for fork in (whole, each):
            fork.columns.add(frame)
            fork.advance(fork.columns.end)
        assert held(whole) == held(each)
    assert held(whole) != before
    assert held(forest) == before
