"""From the journal alone to any node of any timeline, at any of its entries.

Follow-mode beliefs are pure functions of the control timelines (semantics, section 6). For
the head of every timeline one forest is kept, with the nodes that someone asked for; a
node asked for late, or for the past, is folded from the timeline's beginning.
"""

from collections.abc import Iterator, Sequence

from beliefnest.belief.columns import Columns, Versions, cell_of
from beliefnest.belief.entries import Basis
from beliefnest.belief.forest import Forest
from beliefnest.belief.ground import Ground
from beliefnest.belief.planting import forked, planted
from beliefnest.belief.reading import Reading
from beliefnest.nest.setting import Setting
from beliefnest.perception.sight import Sight
from beliefnest.timeline.journal import Edit, Journal, TimelineKey
from beliefnest.world.registry import Registry
from beliefnest.world.values import Position

__all__ = ["History", "ground_of"]

Path = tuple[str, ...]

_PASTS = 4


def ground_of(setting: Setting) -> Ground:
    """What the nodes of a nest with this setting stand on."""
    registry = Registry.load()
    options = setting.perception
    sight = Sight(
        registry, options.max_visible_distance, options.field_of_view, options.transparent_blocks
    )
    agents = tuple(sorted({*setting.snapshot.agents, *setting.absent}))
    return Ground(setting.snapshot.box, agents, options, registry, sight, Versions())


class History:
    """States of any node, at any entry of any timeline of a journal.

    Args:
        journal: The timelines.
        setting: What the nest started from.
    """

    def __init__(self, journal: Journal, setting: Setting) -> None:
        self._journal = journal
        self._setting = setting
        self.ground = ground_of(setting)
        self._columns: dict[TimelineKey, Columns] = {}
        self._edits: dict[TimelineKey, dict[int, Edit]] = {}
        self._heads: dict[TimelineKey, Forest] = {}
        self._pasts: list[tuple[TimelineKey, Forest]] = []

    def reading(self, key: TimelineKey, path: Path, position: int | None = None) -> Reading:
        """State of the node `path` after `position` entries of a timeline; None: at its head.

        `path` is the timeline's own simulator or a node below it that follows it.
        """
        count = self._journal.info(key).entries
        return Reading(self._forest(key, path, count if position is None else position), path)

    def steps(
        self, key: TimelineKey, path: Path, first: int, last: int, extra: Sequence[int] = ()
    ) -> Iterator[Forest]:
        """One forest with a node, after `first` entries of a timeline, then one more, to `last`.

        It is the caller's own, and the same object each time. What blocks rest on is known
        in it for cells that hold containers and for those of `extra`.
        """
        forest = self._walk(key, path, first, extra)
        yield forest
        for position in range(first + 1, last + 1):
            self._advance(key, forest, position)
            yield forest

    def note(self, key: TimelineKey) -> None:
        """Read what came to a timeline, so that who asks for a belief need not wait for it."""
        self._load(key)

    def block_bases(
        self, key: TimelineKey, path: Path, position: int, cells: Sequence[int]
    ) -> dict[int, Basis | None]:
        """What a node's blocks at some cells rest on; None where a block is unknown.

        It is not kept while folding, so the timeline is folded anew.
        """
        forest = self._walk(key, path, position, cells)
        return forest.plots.bases(forest.plots.index[path], cells)

    def block_is_current(
        self, key: TimelineKey, path: Path, position: int, place: Position
    ) -> bool:
        """Whether a node's block was backed by a perception in the last of some entries."""
        base = self._journal.info(key).base
        if position == 0 and base is not None and path != key.path:
            # What agents believed at the fork stays as it was until something happens.
            return self.block_is_current(base.timeline, path, base.entries, place)
        forest = self._forest(key, path, position)
        return forest.block_is_current(forest.plots.index[path], cell_of(self.ground.box, place))

    def forget(self, key: TimelineKey) -> None:
        """Drop what is remembered of a timeline that was deleted or renamed."""
        for remembered in (self._columns, self._edits, self._heads):
            remembered.pop(key, None)
        self._pasts = [(other, forest) for other, forest in self._pasts if other != key]

    def _forest(self, key: TimelineKey, path: Path, position: int) -> Forest:
        """A forest with a node, after some entries of a timeline."""
        self._load(key)
        if position == self._journal.info(key).entries:
            return self._head(key, path, position)
        for other, forest in self._pasts:
            if other == key and path in forest.plots.index and forest.position <= position:
                self._advance(key, forest, position)
                return forest
        forest = self._walk(key, path, position)
        self._pasts = [(key, forest), *self._pasts][:_PASTS]
        return forest

    def _head(self, key: TimelineKey, path: Path, count: int) -> Forest:
        head = self._heads.get(key)
        if head is None:
            head = self._heads[key] = self._walk(key, path, count)
            return head
        self._advance(key, head, count)
        if path not in head.plots.index:
            late = self._walk(key, path, count)
            start = len(key.path)
            chain = [path[:depth] for depth in range(start, len(path) + 1)]
            head.adopt(late, [node for node in chain if node not in head.plots.index])
        return head

    def _walk(
        self, key: TimelineKey, path: Path, position: int, extra: Sequence[int] = ()
    ) -> Forest:
        """A forest of a node and those around it, folded from a timeline's beginning."""
        self._load(key)
        base = self._journal.info(key).base
        if base is None:
            setting = self._setting
            forest = planted(
                self.ground,
                self._columns[key],
                setting.snapshot,
                setting.static_blocks,
                setting.initial_beliefs,
                path,
                extra,
            )
        else:
            source = (
                self._walk(base.timeline, path, base.entries, extra)
                if extra
                else self._forest(base.timeline, path, base.entries)
            )
            forest = forked(source, self._columns[key], key.path, path, base.tick, extra)
        self._advance(key, forest, position)
        return forest

    def _load(self, key: TimelineKey) -> None:
        """Read what came to a timeline in the journal."""
        info = self._journal.info(key)
        if key not in self._columns:
            if info.base is not None:
                # Versions at the fork have lower numbers than those of the new timeline.
                self._forest(info.base.timeline, key.path, info.base.entries)
            ground = self.ground
            self._columns[key] = Columns(ground.box, ground.agents, ground.versions, ground.holds)
            self._edits[key] = {}
        columns = self._columns[key]
        if len(columns) == info.entries:
            return
        held = len(columns.held)
        for entry in self._journal.entries(key, len(columns), info.entries):
            if isinstance(entry, Edit):
                self._edits[key][len(columns)] = entry
                columns.add_quiet(entry.tick)
            else:
                columns.extend([entry])
        self.ground.track(columns.held[held:])

    def _advance(self, key: TimelineKey, forest: Forest, position: int) -> None:
        for number in sorted(n for n in self._edits[key] if forest.position <= n < position):
            forest.advance(number)
            edit = self._edits[key][number]
            node = forest.plots.index.get(edit.path)
            if node is None:
                forest.skip(edit.tick)
            else:
                box = self.ground.box
                blocks = {cell_of(box, place): state for place, state in edit.blocks.items()}
                contents = {cell_of(box, place): items for place, items in edit.containers.items()}
                forest.edit(node, blocks, contents, edit.tick)
        forest.advance(position)
