"""History of a nest: any node, at any entry of any timeline, computed from the journal alone.

Follow-mode beliefs are pure functions of the control timelines (semantics, section 6).
`StateHistory` keeps one forest at the head of every timeline, with the nodes that somebody has
asked for; of many timelines, those used last. Every few thousand entries it saves this forest as a
checkpoint. Forests of the past are folded from the last checkpoint before the wanted entry, or from
the beginning of the timeline. All of these are caches: an answer does not depend
on the forest that it comes from.
"""

import functools
from collections.abc import Container, Iterable, Iterator, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, field
from itertools import accumulate, islice, takewhile

from msgspec.structs import replace

from beliefnest.belief.columns import Columns, cell_of
from beliefnest.belief.context import BeliefContext
from beliefnest.belief.first_perceptions import FirstPerceptions
from beliefnest.belief.forest import Forest
from beliefnest.belief.grounds import Basis, PerceivedEvent
from beliefnest.belief.initial import Beginning, forked_forest, initial_forest
from beliefnest.belief.node_memory import most_nodes
from beliefnest.nest.past.checkpoints import Checkpoints, Pace
from beliefnest.nest.past.claimed_blocks import ClaimedBlocks
from beliefnest.nest.past.event_log import EventLog
from beliefnest.nest.past.heads import Heads
from beliefnest.nest.past.setting import Setting
from beliefnest.nest.past.timeline_state import TimelineState
from beliefnest.perception.sight import Sight
from beliefnest.timeline.journal import Edit, Entry, EntryFilter, ForkPoint, TimelineKey
from beliefnest.timeline.store import Journal
from beliefnest.world.event_kinds import EventKind
from beliefnest.world.frames import Frame
from beliefnest.world.paths import BeliefPath
from beliefnest.world.registry import Registry
from beliefnest.world.values import Sign

_PASTS = 4
"""Number of forests of the past that are kept."""
_PAST_BYTES = 64_000_000
"""Bytes that they may take together, unless one alone takes more."""
_STRETCHES = 8
_CALLS = 8
"""Number of forks, each the base of the next, that are folded by calls within calls."""


def context_of(setting: Setting) -> BeliefContext:
    """Return the part that all nodes of a nest with this setting share."""
    options = setting.perception
    sight, first = _seeing(
        options.max_visible_distance, options.field_of_view, tuple(options.transparent_blocks)
    )
    agents = tuple(sorted({*setting.snapshot.agents, *setting.absent}))
    return BeliefContext(
        setting.snapshot.box,
        agents,
        options,
        sight.registry,
        sight,
        first,
        tuple(sorted(setting.unique)),
    )


@functools.lru_cache(maxsize=8)
def _seeing(
    far: float | None, field: float, transparent: tuple[str, ...]
) -> tuple[Sight, FirstPerceptions]:
    """Return sight and the cache of first perceptions, shared by nests with the same options."""
    return Sight(Registry.load(), far, field, transparent), FirstPerceptions()


@dataclass
class _Stretch:
    """Stretch of a timeline: its entries in columns, and the edits among them by number."""

    columns: Columns
    edits: dict[int, Edit] = field(default_factory=dict)

    def add(self, entry: Frame | Edit) -> None:
        if isinstance(entry, Edit):
            self.edits[self.columns.end] = entry
            self.columns.add_quiet(entry.tick)
        else:
            self.columns.add(entry)

    def fold(self, forest: Forest, stop: int) -> None:
        """Fold entries up to number `stop` (excluded) into a forest that is in this stretch."""
        box = forest.context.box
        for number in sorted(n for n in self.edits if forest.position <= n < stop):
            forest.advance(number)
            edit = self.edits[number]
            if edit.path not in forest:
                forest.skip(edit.tick)
            else:
                number_of = forest.context.number
                blocks = {cell_of(box, at): number_of(block) for at, block in edit.blocks.items()}
                signs = (at for at, block in edit.blocks.items() if isinstance(block, Sign))
                forest.context.note_signs(cell_of(box, at) for at in signs)
                contents = {cell_of(box, place): items for place, items in edit.containers.items()}
                forest.edit(forest.node(edit.path), blocks, contents, edit.tick)
        forest.advance(stop)


class StateHistory:
    """States of any node, at any entry of any timeline of a journal.

    Args:
        journal: The journal.
        setting: The setting that the nest began with.
        turn: Lock of the thread that reads the timelines; None: there is only one thread.

    Attributes:
        turn: The lock above.
        generation: Counter that grows whenever states read before may have become invalid, for
            example because a timeline was renamed.
    """

    def __init__(
        self, journal: Journal, setting: Setting, turn: AbstractContextManager[object] | None = None
    ) -> None:
        self.turn = nullcontext() if turn is None else turn
        self._journal = journal
        self._setting = setting
        self._pace = Pace()
        self.context = context_of(setting)
        self._claimed = ClaimedBlocks(journal, self.context, setting.snapshot)
        self._checkpoints = Checkpoints(journal, setting, self.context, self._pace)
        self._stretches: dict[tuple[TimelineKey, int], _Stretch] = {}
        self._logs: dict[TimelineKey, EventLog] = {}
        self._heads = Heads(self._checkpoints.keep_last)
        self._pasts: list[tuple[TimelineKey, Forest]] = []
        self.generation = 0

    def state(
        self,
        key: TimelineKey,
        path: BeliefPath,
        position: int | None = None,
        tick: int | None = None,
    ) -> TimelineState:
        """Return the state of a node after some entries of a timeline.

        Args:
            key: The timeline.
            path: The timeline's own simulator, or a node below it that follows it.
            position: Number of entries; None: all of them.
            tick: Tick of the view, before that of the next entry; None: that of the last entry.
        """
        if position is None:
            position = self._journal.info(key).entries
        return TimelineState(self.shared(key, path, position), path, tick, key, self)

    def shared(self, key: TimelineKey, path: BeliefPath, position: int) -> Forest:
        """Return a forest with a node, after some entries of a timeline.

        The forest is shared: read it before the next call, which may fold it further.
        """
        self._keep_up(key)
        if position == self._journal.info(key).entries:
            return self._head(key, path, position)
        beside = self._beside(key, position)
        paths = self.company(key, path, () if beside is None else beside.paths)
        forest = self._past(key, path, position)
        after = 0 if forest is None else forest.position
        saved = self._saved(key, position, paths, after)
        forest = saved or forest or self._begun_together(key, paths)
        self._keep_past(key, forest)
        self.advance(key, forest, position)
        if beside is None or beside is forest or beside.bytes + forest.bytes > _PAST_BYTES:
            return forest
        # One forest of all nodes is folded further at once; many would push each other out.
        beside.adopt(forest, [folded for folded in forest.paths if folded not in beside])
        self._pasts = [past for past in self._pasts if past[1] is not forest]
        self._keep_past(key, beside)
        return beside

    def _keep_past(self, key: TimelineKey, forest: Forest) -> None:
        """Keep a forest of the past as the one used last, and drop others to stay within bounds."""
        pasts = [past for past in self._pasts if past[1] is not forest]
        sizes, room = accumulate(past[1].bytes for past in pasts), _PAST_BYTES - forest.bytes
        within = sum(1 for size in sizes if size <= room)
        self._pasts = [(key, forest), *pasts[:within]][:_PASTS]

    def _beside(self, key: TimelineKey, position: int) -> Forest | None:
        """Return the kept forest with beliefs that is at a position of a timeline."""
        at_hand = (f for other, f in self._pasts if other == key and f.position == position)
        return next((forest for forest in at_hand if forest.has_beliefs), None)

    def _is_far(self, key: TimelineKey) -> bool:
        """Return True if more forks lead to a timeline than `walk` may follow by calls in calls."""
        return len(list(islice(self._bases(self._journal.info(key).base), _CALLS))) == _CALLS

    def company(
        self, key: TimelineKey, path: BeliefPath, present: Container[BeliefPath]
    ) -> Sequence[BeliefPath]:
        """Return a node, and those next to it that a caller will probably ask for, too.

        A caller that asks for several beliefs of an owner one after the other goes on with the next
        agents. To fold them together costs less than one by one. There are as many as were asked
        for already, so that at most half of all nodes are folded in vain.

        Args:
            key: The timeline.
            path: The node.
            present: Paths that were asked for at this moment of the timeline.
        """
        if path == key.path or path in present or self._is_far(key):
            return [path]
        agents = self.context.agents
        first = agents.index(path[-1])
        order = (*agents[first + 1 :], *agents[:first])
        others = [(*path[:-1], name) for name in order if path[-2:-1] != (name,)]
        missing = [other for other in others if other not in present]
        most, count = most_nodes(self.context), len(others) - len(missing)
        if most is not None and 4 * (len(path) + count) > most:
            return [path]
        return [path, *missing[:count]]

    def passed(self, key: TimelineKey, paths: Sequence[BeliefPath], entry: int) -> Forest:
        """Return a forest with some nodes that has just folded an entry of a timeline.

        It belongs to the caller, and has the verdicts on the claims of this entry.
        """
        self._keep_up(key)
        forest = self._saved(key, entry, paths)
        if forest is None or not all(path in forest for path in paths):
            forest = self._begun_together(key, paths)
        self.advance(key, forest, entry + 1)
        return forest

    def steps(
        self, key: TimelineKey, path: BeliefPath, first: int, last: int, extra: Sequence[int] = ()
    ) -> Iterator[Forest]:
        """Yield a forest with a node after `first` entries of a timeline, then after each further.

        The same object is yielded each time, folded by one more entry. It belongs to the caller.

        Args:
            key: The timeline.
            path: The node.
            first: Number of entries at the first yield.
            last: Number of entries at the last yield.
            extra: Cells whose basis is to be tracked. For these the timeline is folded from its
                beginning.
        """
        forest = self._folded(key, path, first, extra)
        yield forest
        for position in range(first + 1, last + 1):
            self.advance(key, forest, position)
            yield forest

    def walk(self, key: TimelineKey, paths: Sequence[BeliefPath]) -> Forest:
        """Return a forest with several nodes at a timeline's beginning.

        It belongs to the caller. `advance` folds entries into it.
        """
        self._keep_up(key)
        base = self._journal.info(key).base
        if base is None:
            return self._initial(key, paths)
        self._have(base, paths)
        first, *others = paths
        forest = self._begun(key, first)
        for path in others:
            if path not in forest:
                _adopt(forest, self._begun(key, path), key.path, path)
        return forest

    def _have(self, fork: ForkPoint, paths: Sequence[BeliefPath]) -> None:
        """Fold several nodes together up to a fork, and keep the forest for later calls."""
        key, position = fork.timeline, fork.entries
        if position == self._journal.info(key).entries:
            self.expect(key, paths)
            head = self._head(key, paths[-1], position)
            late = [path for path in paths if path not in head]
            if len(late) > 1:
                other = self._together(key, late, position)
                for path in late:
                    _adopt(head, other, key.path, path)
            return
        at_hand = [forest for other, forest in self._pasts if other == key]
        if not any(
            forest.position == position and all(path in forest for path in paths)
            for forest in at_hand
        ):
            self._keep_past(key, self._together(key, paths, position))

    def _together(self, key: TimelineKey, paths: Sequence[BeliefPath], position: int) -> Forest:
        """Return a new forest of several nodes and their ancestors, after some entries."""
        forest = self.walk(key, paths)
        self.advance(key, forest, position)
        return forest

    def advance(self, key: TimelineKey, forest: Forest, position: int) -> None:
        """Fold entries of a timeline into a forest until it has folded `position` of them."""
        if not forest.has_beliefs and position - forest.position > self._pace.lag:
            self._leap(key, forest, position)
        while forest.position < position:
            stretch = self._stretch(key, forest.position, position)
            if forest.columns is not stretch.columns:
                forest.enter(stretch.columns)
            stretch.fold(forest, min(position, stretch.columns.end))

    def note(self, key: TimelineKey) -> None:
        """Fold new entries of a timeline at its head if enough have come since the last time.

        Queries of beliefs are then never more than `Pace.lag` entries behind.
        """
        self._keep_up(key)
        head, count = self._heads.get(key), self._journal.info(key).entries
        if count - (0 if head is None else head.position) >= self._pace.lag:
            self._head(key, key.path, count)

    def expect(self, key: TimelineKey, paths: Sequence[BeliefPath]) -> None:
        """Prepare the head of a timeline for queries of several nodes.

        Nodes that are asked for one after the other would each be folded from the beginning, with
        all their ancestors.
        """
        below = [path for path in paths if path != key.path]
        head = self._heads.get(key) or self._saved(key, self._journal.info(key).entries)
        if below and (head is None or not head.has_beliefs):
            head = self.walk(key, below)
        if head is not None:
            self._heads.put(key, head)
            self._fold_into(key, head, [path for path in below if path not in head])

    def _fold_into(self, key: TimelineKey, head: Forest, missing: Sequence[BeliefPath]) -> None:
        """Add several nodes to a head at once, unless a checkpoint holds them."""
        if len(missing) > 1 and self._saved(key, head.position, missing[-1:]) is None:
            folded = self.walk(key, missing)
            self.advance(key, folded, head.position)
            for path in missing:
                _adopt(head, folded, key.path, path)

    def close(self) -> None:
        """Save checkpoints at the heads of timelines, so that a resumed run begins there."""
        for key, head in self._heads.items() if self._journal.writable else ():
            self.advance(key, head, self._journal.info(key).entries)
            self._checkpoints.keep_last(key, head)

    def block_bases(
        self, moment: ForkPoint, path: BeliefPath, cells: Sequence[int]
    ) -> dict[int, Basis | None]:
        """Return the bases of a node's blocks at some cells; None where a block is unknown.

        Folding keeps bases of tracked cells only, so the timeline is folded again from its start.
        """
        forest = self._folded(moment.timeline, path, moment.entries, cells)
        return forest.table.bases(forest.node(path), cells, moment.tick)

    def current_blocks(self, moment: ForkPoint, path: BeliefPath, cells: Iterable[int]) -> set[int]:
        """Return the cells whose block in a node is current."""
        while (base := self._journal.info(moment.timeline).base) is not None:
            edited = self._edited_at_first(moment.timeline, path, moment.entries)
            if edited is None:
                break
            # The timeline is unchanged since the fork, so beliefs are as there (section 6).
            cells, moment = [cell for cell in cells if cell not in edited], base
        forest = self.shared(moment.timeline, path, moment.entries)
        return forest.current_blocks(path, cells)

    def _edited_at_first(
        self, key: TimelineKey, path: BeliefPath, position: int
    ) -> set[int] | None:
        """Return the cells of a node that were edited in the first entries of a fork.

        None if the node has perceived since the fork: it does when a tick happens, and when a
        simulator above it is edited (semantics, section 6).
        """
        edited: set[int] = set()
        if path == key.path:
            return None
        for entry in self._journal.entries(key, 0, position):
            if not isinstance(entry, Edit):
                return None
            above = len(entry.path) < len(path)
            if above and path[: len(entry.path)] == entry.path:
                return None
            if entry.path == path:
                edited.update(cell_of(self.context.box, place) for place in entry.blocks)
        return edited

    def forget(self, key: TimelineKey) -> None:
        """Drop everything cached for a timeline that was deleted or renamed."""
        self.generation += 1
        self._stretches = {at: kept for at, kept in self._stretches.items() if at[0] != key}
        self._logs.pop(key, None)
        self._heads.pop(key)
        self._checkpoints.forget(key)
        self._claimed.forget(key)
        self._pasts = [(other, forest) for other, forest in self._pasts if other != key]

    def forget_all(self) -> None:
        """Drop everything cached for all timelines."""
        self.generation += 1
        self._stretches, self._logs, self._pasts = {}, {}, []
        self._heads.clear()
        self._checkpoints.forget_all()
        self._claimed.forget_all()

    def _keep_up(self, key: TimelineKey) -> None:
        """Drop all forests if new entries claim something of cells that were not tracked so far.

        Such cells must be tracked from the beginning; see `claimed_blocks`.
        """
        if self._claimed.read(key):
            self.generation += 1
            self._heads.clear()
            self._pasts.clear()

    def _past(self, key: TimelineKey, path: BeliefPath, position: int) -> Forest | None:
        """Return the cached forest with a node that is nearest before a position."""
        nearest = None
        for other, forest in self._pasts:
            if other == key and path in forest and forest.position <= position:
                # For the timeline's own simulator a forest without beliefs is better if it is far
                # back: it can leap over the entries between (see `_leap`).
                near = position - forest.position <= self._pace.lag
                fits = near or path != key.path or not forest.has_beliefs
                if fits and (nearest is None or forest.position > nearest.position):
                    nearest = forest
        return nearest

    def _head(self, key: TimelineKey, path: BeliefPath, count: int) -> Forest:
        head = former = self._heads.get(key)
        if head is not None and head.position == count and path in head:
            return head
        if head is None:
            head = self._saved(key, count)
        if head is None or (not head.has_beliefs and path != key.path):
            # Fold the new node as the head, which leaves checkpoints on the way. A node that is
            # added to a head later (below) is folded without any.
            head = self._begun(key, path)
        if head is not former:
            self._heads.put(key, head)
        while head.position < count:
            far = count if not head.has_beliefs else head.position + self._pace.every
            self.advance(key, head, min(count, far))
            # Checkpoint long folds so that later queries of the past are cheap.
            self._checkpoints.keep(key, head)
        if path not in head:
            paths = self.company(key, path, head.paths)
            _adopt(head, self._ahead(key, paths, count), key.path, path)
        return head

    def _ahead(self, key: TimelineKey, paths: Sequence[BeliefPath], count: int) -> Forest:
        """Return a forest at the head of a timeline with a node that its head lacks.

        The head takes over this node alone. The others wait among the forests of the past.

        Args:
            key: The timeline.
            paths: The node, then those that will probably be asked for.
            count: Number of entries of the timeline.
        """
        if len(paths) == 1:
            return self._folded(key, paths[0], count)
        ahead = self._beside(key, count)
        if ahead is None or paths[0] not in ahead:
            ahead = self._saved(key, count, paths) or self._begun_together(key, paths)
            self.advance(key, ahead, count)
            self._keep_past(key, ahead)
        return ahead

    def _folded(
        self, key: TimelineKey, path: BeliefPath, position: int, extra: Sequence[int] = ()
    ) -> Forest:
        """Return a new forest of a node and its ancestors, after some entries of a timeline."""
        self._keep_up(key)
        forest = None
        if not extra:
            forest = self._saved(key, position, [path])
        forest = forest or self._begun(key, path, extra)
        self.advance(key, forest, position)
        return forest

    def _saved(
        self,
        key: TimelineKey,
        position: int,
        paths: Sequence[BeliefPath] | None = None,
        after: int = 0,
    ) -> Forest | None:
        """Return the forest of the last usable checkpoint; see `Checkpoints.before`.

        A checkpoint is of no use if a cell that claims are about was not tracked in it from the
        beginning.
        """
        saved = self._checkpoints.before(key, position, self._log(key), paths, after)
        return saved if saved is None or self._claimed.cells <= saved.since else None

    def _begun_together(self, key: TimelineKey, paths: Sequence[BeliefPath]) -> Forest:
        """Return a forest of nodes and their ancestors, at a timeline's beginning."""
        return self._begun(key, paths[0]) if len(paths) == 1 else self.walk(key, paths)

    def _begun(self, key: TimelineKey, path: BeliefPath, extra: Sequence[int] = ()) -> Forest:
        """Return a forest of a node and its ancestors, at a timeline's beginning."""
        base = self._journal.info(key).base
        if base is None:
            return self._initial(key, (path,), extra)
        if extra:
            return self._begun_with(key, path, extra)
        self._fold_bases(base, path)
        source = self.shared(base.timeline, path, base.entries)
        return forked_forest(source, self._log(key), key.path, path, base.tick)

    def _begun_with(self, key: TimelineKey, path: BeliefPath, extra: Sequence[int]) -> Forest:
        """Return a forest at a timeline's beginning that tracks further cells.

        It is folded from where the real world begins.
        """
        bases = list(self._bases(self._journal.info(key).base))
        for base in bases:
            self._keep_up(base.timeline)
        timelines = [key, *(base.timeline for base in bases)]
        forest = self._initial(timelines[-1], (path,), extra)
        for base, forked in zip(reversed(bases), timelines[-2::-1], strict=True):
            self.advance(base.timeline, forest, base.entries)
            log = self._log(forked)
            forest = forked_forest(forest, log, forked.path, path, base.tick, extra)
        return forest

    def _bases(self, base: ForkPoint | None) -> Iterator[ForkPoint]:
        """Yield a fork, and those that lead to it, the latest first."""
        while base is not None:
            yield base
            base = self._journal.info(base.timeline).base

    def _fold_bases(self, base: ForkPoint, path: BeliefPath) -> None:
        """Fold a node at every few of the forks that lead to one, oldest first.

        `shared` calls itself for the timeline below. Branches of branches may be more than Python
        allows calls within calls.
        """
        missing = list(takewhile(lambda fork: not self._is_folded(fork, path), self._bases(base)))
        for fork in reversed(missing[_CALLS::_CALLS]):
            self.shared(fork.timeline, path, fork.entries)

    def _is_folded(self, fork: ForkPoint, path: BeliefPath) -> bool:
        """Return True if a forest with a node, at a fork or before it, is at hand."""
        if fork.entries == self._journal.info(fork.timeline).entries:
            head = self._heads.get(fork.timeline)
            return head is not None and path in head
        return self._past(fork.timeline, path, fork.entries) is not None

    def _initial(
        self, key: TimelineKey, paths: Sequence[BeliefPath], extra: Sequence[int] = ()
    ) -> Forest:
        """Return a forest of some nodes and their ancestors, where the real world begins."""
        beginning, initial = self._beginning, self._setting.initial_beliefs
        return initial_forest(self.context, self._log(key), beginning, initial, paths, extra)

    @functools.cached_property
    def _beginning(self) -> Beginning:
        setting = self._setting
        return Beginning(self.context, setting.snapshot, setting.static_blocks)

    def _log(self, key: TimelineKey) -> EventLog:
        if key not in self._logs:
            # Read the base now, because events may be listed after the journal was closed.
            base = self._journal.info(key).base
            self._logs[key] = EventLog(self._journal, key, lambda path: self._before(base, path))
        return self._logs[key]

    def _before(self, base: ForkPoint | None, path: BeliefPath) -> Sequence[PerceivedEvent]:
        """Return the events that a node perceived before the fork from a base, oldest first."""
        if base is None:
            return ()
        # Lists are kept, so that further ones need no more calls within calls; see `_fold_bases`.
        logs = (self._log(fork.timeline) for fork in self._bases(base))
        missing = list(takewhile(lambda log: not log.has_before(path), logs))
        for log in reversed(missing[_CALLS::_CALLS]):
            log.before(path)
        return self.state(base.timeline, path, base.entries).perceived

    def _leap(self, key: TimelineKey, forest: Forest, position: int) -> None:
        """Fold a forest that has node 0 alone, without most entries on the way.

        Node 0 perceives nothing: its state is the sum of all changes. Only the last state of an
        agent matters, and the journal can look it up. So the stretch has the entries that change
        blocks, contents or dropped items, without agents and without events that do not concern
        signs, and then one frame with all agents. Edits at the very end are folded as they are.
        """
        first, last = forest.position, position
        while last > first and isinstance(self._entry(key, last - 1), Edit):
            last -= 1
        stretch = _Stretch(Columns(self.context, first, forest.count_of_events))
        for _, entry in self._journal.filtered(key, first, last, EntryFilter.CHANGES):
            bare = entry
            if isinstance(entry, Frame):
                # Writers and claims of signs are in the events.
                written = tuple(event for event in entry.events if "text" in event.detail)
                signs = (event for event in written if event.kind is EventKind.BLOCK_UPDATE)
                bare = replace(entry, agents={}, events=tuple(signs))
            stretch.add(bare)
        if last > first:
            agents = self._journal.agents_after(key, last)
            stretch.add(Frame(self._entry(key, last - 1).tick, agents))
        for entry in self._journal.entries(key, last, position):
            stretch.add(entry)
        self.context.track(stretch.columns.held)
        forest.enter(stretch.columns)
        stretch.fold(forest, stretch.columns.end)
        forest.leap(position, self._journal.events_until(key, position))

    def _entry(self, key: TimelineKey, number: int) -> Entry:
        return next(self._journal.entries(key, number, number + 1))

    def _stretch(self, key: TimelineKey, position: int, wanted: int) -> _Stretch:
        """Return the stretch that holds an entry, read from the journal up to entry `wanted`."""
        number = position // self._pace.stretch
        first, end = number * self._pace.stretch, (number + 1) * self._pace.stretch
        stretch = self._stretches.pop((key, number), None)
        if stretch is None:
            before = self._journal.events_until(key, first)
            stretch = _Stretch(Columns(self.context, first, before))
        self._stretches[key, number] = stretch
        while len(self._stretches) > _STRETCHES:
            del self._stretches[next(iter(self._stretches))]
        columns = stretch.columns
        count_before = len(columns.held)
        for entry in self._journal.entries(key, columns.end, min(end, wanted)):
            stretch.add(entry)
        self.context.track(columns.held[count_before:])
        self._log(key).take(columns)
        return stretch


def _adopt(forest: Forest, other: Forest, own: BeliefPath, path: BeliefPath) -> None:
    """Copy a node and its missing ancestors from a forest that has folded the same entries.

    Args:
        forest: Forest that receives the nodes.
        other: Forest to copy from.
        own: Path of the timeline's own simulator, the first of the ancestors.
        path: Path of the node.
    """
    chain = [path[:depth] for depth in range(len(own), len(path) + 1)]
    missing = [node for node in chain if node not in forest]
    if missing:
        forest.adopt(other, missing)
