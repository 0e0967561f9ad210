"""Checkpoints: forests of a journal's timelines, saved as bytes, from which later folds begin.

A checkpoint is a cache. Beliefs are a pure function of the recorded timelines (semantics, section
6), so every answer is the same without any. A forest depends on the journal, the setting and the
program that folds. The journal only grows and a checkpoint has a position in it, so it stays true.
The name of a checkpoint carries a digest of the setting and of the source files that fold: another
setting or another version looks under another name and never finds it.
"""

from collections.abc import Iterator, Sequence
from contextlib import suppress
from functools import cache, cached_property
from hashlib import blake2b
from importlib.resources import files
from importlib.resources.abc import Traversable

import msgspec
from msgspec.structs import replace

from beliefnest.belief.context import BeliefContext
from beliefnest.belief.forest import EventHistory, Forest, ForestState, NodeState
from beliefnest.errors import StoreError
from beliefnest.nest.past.setting import Setting
from beliefnest.nest.past.setting_codec import encode_start
from beliefnest.timeline import codec
from beliefnest.timeline.journal import TimelineKey
from beliefnest.timeline.store import Journal
from beliefnest.version import VERSION
from beliefnest.world.compression import compressed, decompressed
from beliefnest.world.paths import BeliefPath

_ROOMS = ("world", "perception", "belief", "nest/past")
"""Folders of the package whose source code determines forests."""


class Pace(msgspec.Struct, frozen=True):
    """Intervals of folding and saving, in entries of a timeline.

    Attributes:
        every: Least number of entries between two checkpoints.
        lag: Number of entries up to which folding is cheaper than looking for a checkpoint.
        stretch: Number of entries held in columns at once.
        budget: Greatest number of bytes of checkpoints for each entry. It bounds what large forests
            add to a run file.
    """

    every: int = 2048
    lag: int = 256
    stretch: int = 1024
    budget: int = 128


class _Kept(msgspec.Struct, frozen=True):
    """Last checkpoint of a timeline: its position, its size in bytes and its number of nodes."""

    place: int = 0
    size: int = 0
    nodes: int = 0


class Checkpoints:
    """Checkpoints of the timelines of one journal. None are written if it is read-only.

    Forests with beliefs and forests of the timeline's own simulator alone are saved under different
    names. The latter are small and cheap to continue, so they serve where no belief is wanted.
    """

    def __init__(
        self, journal: Journal, setting: Setting, context: BeliefContext, pace: Pace
    ) -> None:
        self._journal = journal
        self._setting = setting
        self._context = context
        self._pace = pace
        self._kept: dict[tuple[TimelineKey, bool], _Kept] = {}

    def before(
        self,
        key: TimelineKey,
        position: int,
        events: EventHistory,
        paths: Sequence[BeliefPath] | None = None,
        after: int = 0,
    ) -> Forest | None:
        """Return the last saved forest of a timeline that helps to get to a position.

        Args:
            key: The timeline.
            position: Number of entries that are to be folded; the checkpoint lies at or before it.
            events: Events of the timeline.
            paths: Node that the forest must hold, then nodes that it should hold; only these and
                their ancestors are restored. None: all saved nodes are.
            after: Position of a forest that the caller has; earlier checkpoints do not help.

        Returns:
            The forest. None if there is none, or if it would spare less than `Pace.lag` entries.
        """
        if position - after <= self._pace.lag:
            return None
        checkpoint = self._journal.nearest_checkpoint(key, self._name(beliefs=True), position)
        if checkpoint is None if paths is None else paths[0] == key.path:
            world = self._journal.nearest_checkpoint(key, self._name(beliefs=False), position)
            if checkpoint is None or (world is not None and world[0] > checkpoint[0]):
                checkpoint = world
        if checkpoint is None or checkpoint[0] <= after:
            return None
        forest = restored(self._context, events, checkpoint[1], paths)
        if forest is not None and paths is None:
            self._note(key, forest, checkpoint[1])
        return forest

    def keep(self, key: TimelineKey, forest: Forest) -> None:
        """Save a forest if enough entries were folded since the last checkpoint.

        The interval grows with the size of the last checkpoint, to stay within `Pace.budget`.
        """
        kept = self._last(key, forest)
        due = max(self._pace.every, kept.size // self._pace.budget)
        if forest.position - kept.place >= due:
            self._save(key, forest)

    def keep_last(self, key: TimelineKey, forest: Forest) -> None:
        """Save the last forest of a timeline, unless it is cheap to fold from what is saved."""
        kept = self._last(key, forest)
        news = forest.position - kept.place > self._pace.lag or forest.count_of_nodes != kept.nodes
        if forest.position > self._pace.lag and news:
            self._save(key, forest)

    def forget(self, key: TimelineKey) -> None:
        """Forget the last checkpoint of a timeline that was deleted or renamed."""
        self._kept = {at: kept for at, kept in self._kept.items() if at[0] != key}

    def forget_all(self) -> None:
        """Forget the last checkpoints of all timelines."""
        self._kept = {}

    def _save(self, key: TimelineKey, forest: Forest) -> None:
        if self._journal.writable:
            body = saved(forest)
            # A failed write loses nothing but time: the entries themselves are recorded.
            with suppress(StoreError):
                name = self._name(beliefs=forest.has_beliefs)
                self._journal.put_checkpoint(key, name, forest.position, body)
            self._note(key, forest, body)

    def _note(self, key: TimelineKey, forest: Forest, body: bytes) -> None:
        count = forest.count_of_nodes
        self._kept[key, count > 1] = _Kept(forest.position, len(body), count)

    def _last(self, key: TimelineKey, forest: Forest) -> _Kept:
        return self._kept.get((key, forest.has_beliefs), _Kept())

    def _name(self, *, beliefs: bool) -> str:
        """Return the name of checkpoints with beliefs, or without any node below node 0."""
        return f"{'beliefs' if beliefs else 'world'} {self._origin}"

    @cached_property
    def _origin(self) -> str:
        start = encode_start(replace(self._setting, name="", script=()), "")
        return blake2b(start, digest_size=16, key=_program()).hexdigest()


@cache
def _program() -> bytes:
    """Return a digest of the source files that determine forests."""
    digest = blake2b(VERSION.encode(), digest_size=16)
    for room in _ROOMS:
        for source in _sources(files("beliefnest").joinpath(room)):
            digest.update(source.read_bytes())
    return digest.digest()


def _sources(room: Traversable) -> Iterator[Traversable]:
    """Yield the Python files of a folder and of its folders, in order of names."""
    for each in sorted(room.iterdir(), key=lambda each: each.name):
        if each.is_dir():
            yield from _sources(each)
        elif each.name.endswith(".py"):
            yield each


_LEVEL = 1
_LARGEST = 2**30
"""Greatest number of bytes of a node; its grids have some bytes for each cell of the box."""


class _Saved(msgspec.Struct, forbid_unknown_fields=True):
    state: ForestState
    nodes: list[tuple[BeliefPath, bytes]]


def saved(forest: Forest) -> bytes:
    """Return the bytes of a forest; `restored` is the inverse. The forest leaves its stretch."""
    state, nodes = forest.saved()
    # Nodes hold all blocks of the box, so each is compressed by itself to bound the memory in use.
    packed = [(node.row.path, compressed(codec.encode(node), _LEVEL)) for node in nodes]
    return codec.encode(_Saved(state, packed))


def restored(
    context: BeliefContext,
    events: EventHistory,
    data: bytes,
    paths: Sequence[BeliefPath] | None = None,
) -> Forest | None:
    """Return a forest from the bytes of `saved`.

    Args:
        context: The part that all nodes share.
        events: Events of the timeline.
        data: The bytes.
        paths: Nodes to restore, with their ancestors, as far as there are any; None: all nodes.

    Returns:
        The forest. None if it lacks the first of `paths`.

    Raises:
        StoreError: The bytes are not those of a forest.
    """
    body = codec.decode(data, _Saved)
    nodes = body.nodes
    if paths is not None:
        there = {path for path, _ in nodes}
        if paths[0] not in there:
            return None
        wanted = {path[:depth] for path in paths if path in there for depth in range(len(path) + 1)}
        nodes = [node for node in nodes if node[0] in wanted]
    states = (codec.decode(decompressed(packed, _LARGEST), NodeState) for _, packed in nodes)
    return Forest.restored(context, events, body.state, states)
