"""Refusal of nodes for which memory has no room, before they are made."""

from collections.abc import Callable
from itertools import permutations

import pytest

import beliefnest as bn
from beliefnest.belief import context, node_memory
from beliefnest.belief.node_table import NodeTable
from beliefnest.errors import InputError
from beliefnest.nest.face.nest import Nest
from beliefnest.world.memory import MemoryLimit
from beliefnest.world.paths import paths_below
from beliefnest.worlds.scripted.world import ScriptedWorld

_AGENTS = 6
Limit = Callable[[int], None]


@pytest.fixture
def limit(monkeypatch: pytest.MonkeyPatch) -> Limit:
    """Return a function that sets the memory of this process in bytes."""

    def set_limit(size: int) -> None:
        monkeypatch.setattr(context, "memory_limit", lambda: MemoryLimit(size, "a test's limit"))

    return set_limit


def _nest(testimony: str = "none", side: int = 9) -> Nest:
    agents = {f"agent{n}": (n + 0.5, 1.0, 0.5) for n in range(_AGENTS)}
    world = ScriptedWorld(((0, 0, 0), (side, 3, side)), {}, agents=agents)
    return Nest(world, perception=bn.Perception(testimony=testimony))


def _room_for(nodes: int) -> int:
    return nodes * node_memory.node_bytes(_nest()._recording.context)


def _paths(nest: Nest) -> list[str]:
    return [
        *(f"/{a}" for a in nest.agents),
        *(f"/{a}/{b}" for a, b in permutations(nest.agents, 2)),
    ]


@pytest.mark.parametrize(("testimony", "side"), [("none", 9), ("informed", 9), ("informed", 200)])
def test_the_estimate_is_the_size_of_the_arrays(testimony: str, side: int) -> None:
    """A node's arrays have the size that is told, in dense boxes and in chunks."""
    nest = _nest(testimony, side)
    shared = nest._recording.context
    table = NodeTable(
        shared,
        nest._recording.history.shared(nest._recording.moment(()).timeline, (), 0).poses,
        room=8,
    )
    arrays = sum(row.nbytes for row in table._rows.values()) // 8
    assert arrays < node_memory.node_bytes(shared) < arrays + 2_000


def test_nodes_are_refused_before_any_is_made(
    limit: Limit, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Beliefs to depth 2 without room are refused, told with the figures; fewer still work."""
    limit(_room_for(20))
    nest = _nest()
    nest.states(["/agent0"])
    made: list[object] = []
    monkeypatch.setattr(NodeTable, "add", lambda *given: made.append(given))
    with pytest.raises(InputError, match=r"37 simulators need at least .* MB, .* for 6 agents"):
        nest.states(_paths(nest))
    assert not made
    monkeypatch.undo()
    assert nest["/agent1"].state is not None


def test_what_has_room_is_not_refused(limit: Limit) -> None:
    """Exactly as many nodes as there is room for can be read, at once and one by one."""
    limit(_room_for(37))
    assert len(_nest().states(_paths(_nest()))) == 36
    nest = _nest()
    assert all(nest[path].state is not None for path in _paths(nest))


def test_nodes_are_refused_one_by_one(limit: Limit) -> None:
    """The node too many is refused, and the others stay."""
    limit(_room_for(20))
    nest = _nest()
    paths = _paths(nest)
    for path in paths[:19]:
        assert nest[path].state is not None
    with pytest.raises(InputError, match="21 simulators"):
        _ = nest[paths[19]].state
    assert nest[paths[18]].state is not None


@pytest.mark.parametrize(
    ("root", "depth", "count"), [((), 2, 37), (("agent0",), 2, 32), ((), 3, 187)]
)
def test_the_count_to_a_depth_is_that_of_the_paths(
    limit: Limit, root: tuple[str, ...], depth: int, count: int
) -> None:
    """Nodes to a depth are counted as `paths_below` lists them, with those above the root."""
    nest = _nest()
    assert len(paths_below(root, depth, nest.agents)) + len(root) == count
    limit(_room_for(count))
    node_memory.check_depth(_nest()._recording.context, root, depth)
    limit(_room_for(count) - 1)
    with pytest.raises(InputError, match=f"{count} simulators.* choose depth {depth - 1}"):
        node_memory.paths_with_room(_nest()._recording.context, root, depth)


def test_a_huge_depth_is_refused_at_once() -> None:
    """Paths to depth 60 are never listed, with the memory that this machine really has."""
    with pytest.raises(InputError, match="choose depth"):
        _nest()["/agent0"].imagination(depth=60)
