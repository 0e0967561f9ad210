"""Nodes of one timeline over its ticks, as changes that the page plays back.

A track contains what one node holds, and from which tick on. It computes nothing anew: values and
their currency come from the beliefs, falsehood from differences to the world of the timeline, entry
by entry. The believed pose of an agent is given as the tick at which the agent had it in the
timeline's own world, which makes tracks of long runs short.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from beliefnest.belief.forest import Forest
from beliefnest.belief.holdings import Content
from beliefnest.belief.node_view import NodeView
from beliefnest.belief.testimony import Verdict
from beliefnest.nest.explain.comparison import are_elsewhere, are_false
from beliefnest.nest.explain.made_claims import says_otherwise
from beliefnest.nest.explain.parts import Contents
from beliefnest.nest.face.reader import Reader
from beliefnest.timeline.journal import TimelineKey
from beliefnest.viewer.page.blocks import BlockPalette
from beliefnest.viewer.page.grid_changes import GridChanges
from beliefnest.viewer.page.pose_history import PoseBook, PoseRow
from beliefnest.viewer.page.runs import grid_text, runs_text
from beliefnest.world.array_types import Cells
from beliefnest.world.claims import Claim, claims_of
from beliefnest.world.paths import BeliefPath, normalised

UNKNOWN, CURRENT, STALE, PLACED = 0, 1, 2, 3
"""Kinds of an agent's pose: unknown, as in the timeline's world now, as at a past tick, other."""

TrackRow = list[Any]
Onlooker = Callable[[Forest], None]
"""Function that is called with a forest at each entry."""


@dataclass
class Track:
    """Content of one node over the ticks of one timeline, in rows that begin with a tick.

    Attributes:
        path: Path of the node.
        grid: Blocks at the beginning that are not those of the timeline's own node, as `runs_text`;
            of that node itself, all blocks.
        blocks: [tick, blocks that changed, as `runs_text`].
        agents: By agent number: [tick, UNKNOWN | CURRENT], [tick, STALE, observed at] or [tick,
            PLACED, observed at, pose, source, current, item in the main hand, speaker].
        holds: By agent number: [tick, item in the main hand or None]; only of the timeline's own
            node, because other nodes store a believed item together with the believed pose.
        owns: By agent number: [tick, items, complete].
        contents: By cell: [tick, items or None, complete, current, observed at, source, event,
            speaker].
        items: [tick, number, None | [name, count, x, y, z]]: dropped items.
        wrong: [tick, things that are false from then on].
        heard: Numbers of the perceived events.
        claims: [number of the event, number of the claim in it, whether it was believed, deciding
            condition]; of the claims that were heard, where claims change beliefs.
    """

    path: BeliefPath
    grid: str
    agents: list[list[TrackRow]]
    holds: list[list[TrackRow]]
    owns: list[list[TrackRow]]
    blocks: list[TrackRow] = field(default_factory=list)
    contents: dict[int, list[TrackRow]] = field(default_factory=dict)
    items: list[TrackRow] = field(default_factory=list)
    wrong: list[TrackRow] = field(default_factory=list)
    heard: list[int] = field(default_factory=list)
    claims: list[TrackRow] = field(default_factory=list)


@dataclass
class _Last:
    """Last recorded content of all nodes, for finding changes."""

    code: npt.NDArray[np.int8]
    seen_at: npt.NDArray[np.int32]
    looks: list[Any]
    owned: dict[int, Any]
    contents: list[dict[int, Any]]
    items: list[dict[int, Any]]
    wrong: list[tuple[Any, ...]]


class TrackRecorder:
    """Recorder of the tracks of some nodes of a timeline, which may grow.

    Args:
        reader: Reader of the nest.
        key: Key of the timeline.
        paths: Paths of its nodes; its own comes first.
        book: Poses of agents in the world of the timeline; filled here if `fills`.
        palette: Numbers of blocks on the page.
        fills: True if this recorder fills the book and records claims.
        onlooker: Called with the nodes at the beginning and after each entry.

    Attributes:
        claims: Claims: number of the event, the claim, and whether it is false or a lie.
    """

    def __init__(
        self,
        reader: Reader,
        key: TimelineKey,
        paths: Sequence[BeliefPath],
        book: PoseBook,
        palette: BlockPalette,
        *,
        fills: bool = True,
        onlooker: Onlooker | None = None,
    ) -> None:
        self.key = key
        self.claims: list[tuple[int, Claim, str]] = []
        self._onlooker = onlooker
        self._reader, self._book, self._fills = reader, book, fills
        # The belief of its speaker tells if a claim is a lie.
        speakers = [normalised((*key.path, agent)) for agent in reader.agents if fills]
        self._forest = reader.walk(key, [*dict.fromkeys([*paths, *speakers])])
        self._numbers = [self._forest.node(path) for path in paths]
        agents = len(reader.agents)
        self._palette = palette
        self._grids = GridChanges(self._forest.table, (0, *self._numbers))
        self.tracks, false = [], []
        for path, (runs, cells) in zip(paths, self._grids.beginnings(self._numbers), strict=True):
            text = grid_text(runs, palette.number)
            self.tracks.append(Track(path, text, _empty(agents), _empty(agents), _empty(agents)))
            false.append(cells)
        count = len(paths)
        self._last = _Last(
            code=np.full((count, agents), -1, dtype=np.int8),
            seen_at=np.full((count, agents), -1, dtype=np.int32),
            looks=[_NOTHING] * agents,
            owned={},
            contents=[{} for _ in range(count)],
            items=[{} for _ in range(count)],
            wrong=[() for _ in range(count)],
        )
        self._wrong = _WrongThings(self._forest, self._numbers, self._grids, false)
        self._events = 0
        self._note()

    @property
    def tick(self) -> int:
        """Tick up to which it has recorded."""
        return self._forest.tick

    @property
    def position(self) -> int:
        """Number of recorded entries of the timeline."""
        return self._forest.position

    def advance(self, entries: int) -> None:
        """Record up to a number of entries of the timeline."""
        while self._forest.position < entries:
            self._reader.advance(self.key, self._forest, self._forest.position + 1)
            self._note()

    def _note(self) -> None:
        """Record what changed with the last entry."""
        forest, tick = self._forest, self._forest.tick
        self._note_own_poses(tick)
        cells = self._grids.found()
        self._note_blocks(tick, cells)
        self._note_agents(tick)
        changed = self._owners()
        for at, number in enumerate(self._numbers):
            track = self.tracks[at]
            self._note_contents(at, track, number, tick)
            self._note_items(at, track, number, tick)
            if number == 0:
                self._note_looks(track, tick)
            if number in changed:
                self._note_owned(track, number, tick)
        for at, things in enumerate(self._wrong.found(changed, cells)):
            if things != self._last.wrong[at]:
                self._last.wrong[at] = things
                _put(self.tracks[at].wrong, [tick, things])
        count = forest.count_of_events
        if count > self._events:
            for at, number in enumerate(self._numbers):
                heard = np.flatnonzero(forest.perceived_events.of(number, count)[self._events :])
                self.tracks[at].heard += (heard + self._events).tolist()
            self._note_claims()
            self._events = count
        if self._onlooker is not None:
            self._onlooker(forest)

    def _note_claims(self) -> None:
        forest, rows = self._forest, {}
        for number, index, speaker, claim in _claims_at(forest, self._events):
            if self._fills:
                kind = _kind_of(forest, self.key.path, speaker, claim)
                self.claims.append((number, claim, kind))
            rows[number, index] = forest.verdicts.get((number - self._events, index))
        for (number, index), verdicts in rows.items():
            for track, node in zip(self.tracks, self._numbers, strict=True):
                verdict = None if verdicts is None or not node else verdicts[node]
                if verdict is not None and verdict not in (Verdict.NOT_HEARD, Verdict.SPEAKER):
                    track.claims.append([number, index, verdict.believed, verdict.condition])

    def _note_own_poses(self, tick: int) -> None:
        if not self._fills:
            return
        poses, own = self._forest.poses, self._forest.table.nodes().pose[0]
        for agent, pose_id in enumerate(own.tolist()):
            pose = None
            if pose_id >= 0:
                pose = (*poses.position(pose_id), *poses.angles(pose_id))
            self._book.add(agent, tick, pose)

    def _note_blocks(self, tick: int, changed: Mapping[int, Cells]) -> None:
        for track, number in zip(self.tracks, self._numbers, strict=True):
            if number in changed:
                cells = changed[number]
                states = self._grids.states(number, cells)
                text = runs_text(
                    cells, states, self._grids.first_states(cells), self._palette.number
                )
                track.blocks.append([tick, text])

    def _note_agents(self, tick: int) -> None:
        nodes, last = self._forest.table.nodes(), self._last
        pose_id, seen_at = nodes.pose[self._numbers], nodes.seen_at[self._numbers]
        current = nodes.current[self._numbers].copy()
        # In the world of the timeline everything is current.
        current[np.array(self._numbers) == 0] = True
        code = np.where(pose_id < 0, UNKNOWN, np.where(current, CURRENT, STALE)).astype(np.int8)
        as_there = self._stands_there(pose_id) | (code != CURRENT)
        code[~as_there] = STALE
        stale = np.where((code == STALE) & ~current, seen_at, -1).astype(np.int32)
        for at, agent in np.argwhere((code != last.code) | (stale != last.seen_at)).tolist():
            row = [tick, int(code[at, agent])]
            if code[at, agent] == STALE:
                row = self._stale(at, agent, tick, current=bool(current[at, agent]))
            rows = self.tracks[at].agents[agent]
            if not rows or rows[-1][1:] != row[1:]:
                _put(rows, row)
        last.code, last.seen_at = code, stale

    def _stands_there(self, pose_id: npt.NDArray[np.int32]) -> npt.NDArray[np.bool_]:
        """Return True for poses that equal those of the timeline's own node."""
        own = self._forest.table.nodes().pose[0]
        there: npt.NDArray[np.bool_] = (pose_id >= 0) & (own >= 0)
        for table in self._forest.poses.arrays():
            if len(table):
                there &= (table[pose_id] == table[own]).all(axis=2)
        return there

    def _stale(self, at: int, agent: int, tick: int, *, current: bool) -> TrackRow:
        """Return the row of an agent whose pose differs from that in the timeline's world now."""
        table, poses = self._forest.table, self._forest.poses
        number = self._numbers[at]
        pose_id = table.pose(number, agent)
        seen = tick if current else table.seen_at(number, agent)
        pose: PoseRow = (*poses.position(pose_id), *poses.angles(pose_id))
        as_seen = poses.details(pose_id) is not None and poses.speaker(pose_id) < 0
        if not current and as_seen and self._book.at(agent, seen) == pose:
            return [tick, STALE, seen]
        name = self._reader.agents[agent]
        believed = NodeView(self._forest, self.tracks[at].path).agents[name]
        source = "" if believed.basis is None else believed.basis.source.value
        in_hand = (believed.equipment or {}).get("main_hand")
        speaker = None if believed.basis is None else believed.basis.speaker
        return [tick, PLACED, seen, list(pose), source, current, in_hand, speaker]

    def _note_contents(self, at: int, track: Track, number: int, tick: int) -> None:
        forest, contents = self._forest, self._forest.holdings.of(number).containers
        last = self._last.contents[at]
        for cell in last.keys() - contents.keys():
            del last[cell]
            _put(track.contents[cell], [tick, None, False, False, -1, "", "", None])
        for cell, raw in contents.items():
            current = number == 0 or raw.current
            now = (raw.items, raw.complete, current, None if current else raw.basis)
            if last.get(cell) == now:
                continue
            rows = track.contents.setdefault(cell, [])
            content = forest.holdings.content(number, cell).at(tick)
            _put(rows, _content_row(tick, content, current=current))
            if number and raw.current and not raw.in_sight:
                # An act shows contents in its own tick alone, whenever the next entry comes.
                now = (raw.items, raw.complete, False, raw.basis)
                _put(rows, _content_row(tick + 1, content, current=False))
            last[cell] = now

    def _note_items(self, at: int, track: Track, number: int, tick: int) -> None:
        lying = self._forest.holdings.of(number).items
        last = self._last.items[at]
        if not lying and not last:
            return
        for gone in last.keys() - lying.keys():
            track.items.append([tick, gone, None])
        for identity, item in lying.items():
            if last.get(identity) != item:
                place = [round(value, 3) for value in item.position]
                track.items.append([tick, identity, [item.name, item.count, *place]])
        self._last.items[at] = dict(lying)

    def _note_looks(self, track: Track, tick: int) -> None:
        for agent, looks in enumerate(self._last.looks):
            in_hand = None if looks is None else (looks.equipment or {}).get("main_hand")
            rows = track.holds[agent]
            if not rows or rows[-1][1] != in_hand:
                _put(rows, [tick, in_hand])

    def _owners(self) -> set[int]:
        """Return the numbers of nodes in which agents' possessions may have changed."""
        forest, last = self._forest, self._last
        looks = [forest.table.details_of(0, agent) for agent in range(len(last.looks))]
        # Beliefs about an agent's own possessions come from the parent node.
        everywhere = looks != last.looks
        last.looks = list(looks)
        changed = set()
        for number in range(forest.count_of_nodes):
            owned = dict(forest.holdings.of(number).inventories)
            parent = forest.table.parent(number)
            if everywhere or parent in changed or owned != last.owned.get(number):
                changed.add(number)
            last.owned[number] = owned
        return changed

    def _note_owned(self, track: Track, number: int, tick: int) -> None:
        for agent, rows in enumerate(track.owns):
            items, complete = self._forest.holdings.inventory(number, agent)
            if not rows or rows[-1][1:] != [dict(items), complete]:
                _put(rows, [tick, dict(items), complete])


_NOTHING = object()


def _empty(agents: int) -> list[list[TrackRow]]:
    return [[] for _ in range(agents)]


def _content_row(tick: int, content: Content, *, current: bool) -> TrackRow:
    basis = content.basis
    event = "" if basis.event is None else basis.event.value
    ground = [basis.observed_at, basis.source.value, event, basis.speaker]
    return [tick, dict(content.items), content.complete, current, *ground]


def _put(rows: list[TrackRow], row: TrackRow) -> None:
    """Add a row; among several of one tick the last one counts."""
    if rows and rows[-1][0] == row[0]:
        rows[-1] = row
    else:
        rows.append(row)


def _claims_at(forest: Forest, first: int) -> Iterator[tuple[int, int, str, Claim]]:
    """Yield the claims of the forest's present entry.

    Args:
        forest: Forest at the entry.
        first: Number of the entry's first event on the timeline.

    Yields:
        Number of the event, number of the claim in it, speaker, and claim.
    """
    if not forest.position or not forest.columns.has_claims(forest.position - 1):
        return
    for number in range(first, forest.count_of_events):
        event = forest.columns.event(number)
        for index, claim in enumerate(claims_of(event) if "text" in event.detail else ()):
            yield number, index, str(event.actor), claim


def _kind_of(forest: Forest, own: BeliefPath, speaker: str, claim: Claim) -> str:
    """Return `a lie` or `false` for a claim that was just made; empty if it is neither.

    Args:
        forest: Forest at the entry of the claim.
        own: Path of the simulator in whose world it was made.
        speaker: Agent that made it; the forest contains its beliefs.
        claim: The claim.
    """
    if says_otherwise(NodeView(forest, normalised((*own, speaker))), forest.context, claim):
        return "a lie"
    return "false" if says_otherwise(NodeView(forest, own), forest.context, claim) else ""


_WrongElements = tuple[str, ...]
"""`agent-1`: its pose; `inventory-1`: its inventory; `container-7`, `block-7`: those of cell 7."""


class _WrongThings:
    """Judge of the false beliefs along a forest, by the rules of `false_beliefs`.

    It judges again only what changed since the last call.

    Args:
        forest: The forest.
        numbers: Numbers of the judged nodes.
        grids: Blocks of these nodes and of node 0.
        false: Cells of the false blocks of each node at the beginning.
    """

    def __init__(
        self, forest: Forest, numbers: Sequence[int], grids: GridChanges, false: Sequence[Cells]
    ) -> None:
        self._forest, self._numbers = forest, list(numbers)
        self._grids = grids
        self._wrong_cells = [set(cells.tolist()) for cells in false]
        self._block_things = [_things_at(cells) for cells in self._wrong_cells]
        self._held: list[Any] = [None for _ in numbers]
        self._content_things: list[_WrongElements] = [() for _ in numbers]
        self._owned: dict[int, Any] = {}
        self._owner_things: list[_WrongElements] = [() for _ in numbers]

    def found(self, owned_changed: set[int], cells: Mapping[int, Cells]) -> list[_WrongElements]:
        """Return the false things in each node after the forest's present entry.

        Args:
            owned_changed: Numbers of the nodes in which an inventory changed.
            cells: Cells whose block changed, by number of the node.
        """
        self._judge_blocks(cells)
        self._judge_contents()
        for at, number in enumerate(self._numbers):
            if number in owned_changed or 0 in owned_changed:
                self._owner_things[at] = self._inventories(number)
        parts = (self._block_things, self._content_things, self._poses(), self._owner_things)
        return [sum(each, ()) for each in zip(*parts, strict=True)]

    def _judge_blocks(self, changed: Mapping[int, Cells]) -> None:
        for at, number in enumerate(self._numbers):
            cells = np.array([], dtype=np.int64)
            for node in {0, number} & changed.keys():
                cells = np.union1d(cells, changed[node])
            if not len(cells):
                continue
            believed, real = (self._grids.states(node, cells) for node in (number, 0))
            is_false = (believed >= 0) & (believed != real)
            wrong = self._wrong_cells[at]
            before = len(wrong)
            wrong.difference_update(cells[~is_false].tolist())
            wrong.update(cells[is_false].tolist())
            if before or wrong:
                self._block_things[at] = _things_at(wrong)

    def _judge_contents(self) -> None:
        forest = self._forest
        real = forest.holdings.of(0).containers
        for at, number in enumerate(self._numbers):
            contents = forest.holdings.of(number).containers
            mark = (_told(real), _told(contents))
            if mark == self._held[at]:
                continue
            self._held[at] = mark
            self._content_things[at] = tuple(
                f"container-{cell}"
                for cell in sorted(contents)
                if are_false(_contents(real, cell), _contents(contents, cell) or _NONE)
            )

    def _poses(self) -> list[_WrongElements]:
        table, poses = self._forest.table, self._forest.poses
        pose_id, feet = table.nodes().pose, poses.arrays().feet
        is_known = pose_id >= 0
        if not len(feet):
            return [() for _ in self._numbers]
        moved = are_elsewhere(feet[pose_id[0]], feet[pose_id])
        apart = is_known & (moved | ~is_known[0])
        names_by_node: list[list[str]] = [[] for _ in self._numbers]
        for at, agent in np.argwhere(apart[self._numbers]).tolist():
            names_by_node[at].append(f"agent-{agent}")
        return [tuple(things) for things in names_by_node]

    def _inventories(self, number: int) -> _WrongElements:
        forest = self._forest
        things = []
        for agent in range(len(forest.context.agents)):
            real, mine = (Contents(*forest.holdings.inventory(node, agent)) for node in (0, number))
            if are_false(real, mine):
                things.append(f"inventory-{agent}")
        return tuple(things)


def _things_at(cells: set[int]) -> _WrongElements:
    return tuple(f"block-{cell}" for cell in sorted(cells))


_NONE = Contents({}, complete=False)


def _contents(containers: Mapping[int, Any], cell: int) -> Contents | None:
    content = containers.get(cell)
    return None if content is None else Contents(content.items, content.complete)


def _told(containers: Mapping[int, Any]) -> dict[int, tuple[Any, bool]]:
    return {cell: (content.items, content.complete) for cell, content in containers.items()}
