"""Initial forests: of the real world with its priors, or forked from another forest."""

from collections.abc import Iterable, Sequence
from functools import cached_property

import numpy as np
import numpy.typing as npt

from beliefnest.belief.arrays import UNKNOWN
from beliefnest.belief.chunk_pool import CutGrids, cut_grids
from beliefnest.belief.columns import cell_of
from beliefnest.belief.context import BeliefContext
from beliefnest.belief.forest import EventHistory, Forest
from beliefnest.belief.grounds import Basis, InitialBelief, Source
from beliefnest.belief.holdings import Content, Holdings
from beliefnest.belief.holdings_table import HoldingsTable, RootFacts
from beliefnest.belief.node_table import NodeTable
from beliefnest.belief.poses import PoseTable
from beliefnest.belief.priors import merged_belief
from beliefnest.world.array_types import Ints
from beliefnest.world.claims import ClaimKind, claims_from_plain
from beliefnest.world.frames import Snapshot
from beliefnest.world.paths import BeliefPath
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import Position, Sign


class Beginning:
    """Real world at its first tick, and the blocks that everybody knows from the start.

    Forests of a nest begin anew for every node that is asked for alone; in a large box they share
    the chunks.

    Args:
        context: The part that all nodes share; the signs and containers of the world are noted.
        snapshot: The real world.
        static_blocks: Names and positions of blocks that everybody knows.
    """

    def __init__(
        self, context: BeliefContext, snapshot: Snapshot, static_blocks: frozenset[str | Position]
    ) -> None:
        self.snapshot, self._context, self._static = snapshot, context, static_blocks
        self._cut: CutGrids | None = None
        self._world = _numbers(context, snapshot)
        holders = [state for state in snapshot.blocks.states if context.shows[state]]
        context.track(cell_of(context.box, place) for place in snapshot.places(holders))

    @cached_property
    def grids(self) -> tuple[Terrain, Terrain]:
        """The numbers of all blocks of the world, and of those that everybody knows."""
        context, world = self._context, self._world
        is_named = _numbers_of(context, {name for name in self._static if isinstance(name, str)})
        prior = world.mapped(lambda numbers: np.where(is_named[numbers], numbers, UNKNOWN)).draft()
        for place in self._static:
            if not isinstance(place, str):
                prior[context.box.index(place)] = world[context.box.index(place)]
        return world, prior.terrain()

    def cut(self) -> CutGrids:
        """Return the chunks of both grids of `grids`."""
        if self._cut is None:
            space = self._context.space
            self._cut = cut_grids(space.codes, space.reaches, self.grids)
        return self._cut


def initial_forest(
    context: BeliefContext,
    events: EventHistory,
    beginning: Beginning,
    initial: Sequence[InitialBelief],
    paths: Sequence[BeliefPath],
    extra: Sequence[int] = (),
) -> Forest:
    """Return a forest of the real world with some nodes, after their first perception.

    Args:
        context: The part that all nodes share.
        events: Events of the real world's timeline.
        beginning: The real world at its first tick, and what everybody knows of it.
        initial: Further priors, at any depth.
        paths: The nodes that are wanted; those between them and the real world are added.
        extra: Further cells whose basis is to be tracked.
    """
    for belief in initial:
        written = (at for at, block in belief.blocks.items() if isinstance(block, Sign))
        context.note_signs(cell_of(context.box, place) for place in written)
        context.track(cell_of(context.box, place) for place in belief.containers)
        context.track(
            cell_of(context.box, place)
            for place, block in belief.blocks.items()
            if context.container_name(context.number(block))
        )
    above = (path[:depth] for path in paths for depth in range(1, len(path) + 1))
    wanted = dict.fromkeys(above)
    table = NodeTable(context, PoseTable(), extra, room=1 + len(wanted))
    snapshot = beginning.snapshot
    holdings = HoldingsTable(table, RootFacts(seen_at=snapshot.tick))
    rows = () if table.pool is None else table.pool.add_grids(beginning.cut())
    holdings.add(_add_world(table, beginning, rows))
    for node in wanted:
        holdings.add(_add_prior(table, node, beginning, rows, merged_belief(initial, node)))
    for each in rows:
        table.leave(each)
    table.link()
    forest = Forest(events, table, holdings, snapshot.tick)
    forest.perceive(0, context.first_perceptions)
    return forest


def _numbers_of(context: BeliefContext, names: Iterable[str]) -> npt.NDArray[np.bool_]:
    """Return by number of a block whether its block has one of some names."""
    is_named = np.zeros(context.holds.size, dtype=np.bool_)
    is_named[context.registry.states_of(names)] = True
    for number, sign in context.signs.items():
        is_named[number] = is_named[sign.state]
    return is_named


def _numbers(context: BeliefContext, snapshot: Snapshot) -> Terrain:
    """Return the numbers of all blocks of the world, and note its signs and what they claim."""
    if not snapshot.signs:
        return snapshot.blocks
    numbers = snapshot.blocks.draft()
    for place in sorted(snapshot.signs):
        claims = claims_from_plain(snapshot.sign_claims.get(place, ()))
        number = context.number(snapshot.block(place), claims)
        numbers[context.box.index(place)] = number
        context.note_signs((cell_of(context.box, place),))
        about = [claim for claim in claims if claim.kind is not ClaimKind.POSITION]
        context.track(cell_of(context.box, claim.cell) for claim in about)
    return numbers.terrain()


def _add_world(table: NodeTable, beginning: Beginning, rows: Sequence[Ints]) -> Holdings:
    """Add the node of the real world, and return its holdings.

    `rows` are those of the chunks of `Beginning.cut`, if nodes are in chunks.
    """
    context, snapshot = table.context, beginning.snapshot
    node = table.add((), UNKNOWN)
    if table.pool is None:
        table.set_blocks(node, beginning.grids[0])
    else:
        table.set_rows(node, rows[0])
    basis = Basis(snapshot.tick, Source.SEEN)
    table.set_known_bases(node, basis)
    for name, agent in snapshot.agents.items():
        pose = table.poses.add(name, agent)
        number = context.numbers[name]
        table.set_pose(node, number, pose, snapshot.tick, current=True)
        table.set_equipment(node, number, pose)
    holdings = Holdings()
    for place, items in snapshot.containers.items():
        holdings.containers[cell_of(context.box, place)] = Content(dict(items), True, basis)
    for key, item in snapshot.items.items():
        holdings.items[key] = item
    return holdings


def _add_prior(
    table: NodeTable,
    path: BeliefPath,
    beginning: Beginning,
    rows: Sequence[Ints],
    mine: InitialBelief,
) -> Holdings:
    """Add a node with its priors, and return its holdings; `rows` are as for `_add_world`."""
    context, tick = table.context, beginning.snapshot.tick
    basis = Basis(tick, Source.PRIOR)
    node = table.add(path, table.index[path[:-1]])
    if table.pool is None:
        prior = beginning.grids[1]
        blocks = prior.draft()
        for place, block in mine.blocks.items():
            blocks[context.box.index(place)] = context.number(block)
        table.set_blocks(node, blocks.terrain())
    else:
        table.set_rows(node, rows[1])
        if mine.blocks:
            table.link()
        blocks_before = {cell_of(context.box, at): block for at, block in mine.blocks.items()}
        table.change(node, {cell: context.number(block) for cell, block in blocks_before.items()})
    for name, position in mine.agents.items():
        pose = table.poses.add_pose(position, 0.0, 0.0)
        table.set_pose(node, context.numbers[name], pose, tick, current=False)
    holdings = Holdings()
    for place, (items, complete) in mine.containers.items():
        holdings.containers[cell_of(context.box, place)] = Content(dict(items), complete, basis)
    for name, items in mine.inventories.items():
        if name != path[-1]:
            holdings.inventories[context.numbers[name]] = dict(items)
    table.set_known_bases(node, basis)
    for cell in context.tracked:
        if context.container_name(table.block(node, cell)):
            holdings.containers.setdefault(cell, Content({}, False, basis))
    return holdings


def forked_forest(
    source: Forest,
    events: EventHistory,
    root: BeliefPath,
    path: BeliefPath,
    tick: int,
    extra: Sequence[int] = (),
    further: Sequence[BeliefPath] = (),
) -> Forest:
    """Return a forest that begins with nodes of another: `root`, `path` and those between.

    `root` becomes node 0: everything that it knows is current from the fork on. The beliefs of the
    other nodes stay as they were (semantics, section 6).

    Args:
        source: The other forest, at the fork.
        events: Events of the new timeline.
        root: Path of the simulator that gets a timeline of its own.
        path: Path of the deepest node.
        tick: Tick of the fork.
        extra: Further cells whose basis is to be tracked; the source tracks them too.
        further: More nodes below `root`, each after its parent.
    """
    source.table.track()
    first, agents = source.node(root), range(len(source.context.agents))
    vitals = {agent: source.holdings.vitals(first, agent) for agent in agents}
    chain = [path[:depth] for depth in range(len(root), len(path) + 1)]
    nodes = tuple(dict.fromkeys((*chain, *further)))
    # To copy all nodes at once is much faster than one by one.
    is_whole = nodes == tuple(source.paths) and not extra
    table = (
        source.table.forked()
        if is_whole
        else NodeTable(source.context, PoseTable(), extra, room=len(nodes))
    )
    holdings = HoldingsTable(table, RootFacts(vitals=vitals))
    for wanted in nodes:
        old, is_root = source.node(wanted), wanted == root
        if not is_whole:
            table.copy_node(source.table, old, is_root=is_root, recorded=False)
        holdings.add(_forked_holdings(source.holdings, old, agents, is_root=is_root))
    if not is_whole:
        table.link()
    return Forest(events, table, holdings, tick, source.since)


def _forked_holdings(
    source: HoldingsTable, node: int, agents: Iterable[int], *, is_root: bool
) -> Holdings:
    """Return the holdings of a node at a fork.

    Contents that were current stay so until something new is perceived. Node 0 gets the possessions
    of all agents as the node believes them.
    """
    copied = source.of(node).copy()
    for cell in copied.containers:
        content = source.content(node, cell)
        copied.containers[cell] = content
    if is_root:
        for agent in agents:
            items, complete = source.inventory(node, agent)
            copied.inventories.pop(agent, None)
            if not complete:
                copied.inventories[agent] = items
    return copied
