"""Saved forests of a journal's timelines: written now and then, trusted only where they fit.

A checkpoint is a cache: without any, every answer is the same. Its name carries a digest of all
that a forest follows from besides the journal: the setting, and the program that folds; under
another name it is not looked for.
"""

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cache, cached_property
from hashlib import blake2b
from importlib.resources import files
from importlib.resources.abc import Traversable

from beliefnest.belief.context import BeliefContext
from beliefnest.belief.forest import EventHistory, Forest
from beliefnest.errors import StoreError
from beliefnest.nest.past.forest_codec import restored, saved
from beliefnest.nest.past.setting import Setting
from beliefnest.nest.past.setting_codec import encode_start
from beliefnest.timeline.journal import Journal, TimelineKey
from beliefnest.version import VERSION
from beliefnest.world.paths import BeliefPath

__all__ = ["Checkpoints", "Pace"]

_ROOMS = ("world", "perception", "belief", "nest/past")
"""Where the program is that decides what a forest holds."""


@dataclass(frozen=True, slots=True)
class Pace:
    """How often something is done, in entries of a timeline.

    Attributes:
        every: Entries between two checkpoints, at least.
        lag: Entries that are folded on demand, without looking for a checkpoint.
        stretch: Entries that are held in columns at once.
        budget: Bytes of checkpoints for each entry, at most.
    """

    every: int = 2048
    lag: int = 256
    stretch: int = 1024
    budget: int = 128


@dataclass(frozen=True, slots=True)
class _Kept:
    """The last checkpoint of a timeline: its place, its size in bytes, how many nodes it has."""

    place: int = 0
    size: int = 0
    nodes: int = 0


class Checkpoints:
    """Saved forests of the timelines of one journal; one that is not writable is only read."""

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
        path: BeliefPath | None = None,
        after: int = 0,
    ) -> Forest | None:
        """The last saved forest of a timeline after one position, up to another; None: none is.

        It has to hold the node `path`, and holds no more than its ancestors besides; None: all
        nodes that were saved.
        """
        if position - after <= self._pace.lag:
            return None
        found = self._journal.nearest_checkpoint(key, self._name(beliefs=True), position)
        if path == key.path or (path is None and found is None):
            world = self._journal.nearest_checkpoint(key, self._name(beliefs=False), position)
            if found is None or (world is not None and world[0] > found[0]):
                found = world
        if found is None or found[0] <= after:
            return None
        forest = restored(self._context, events, found[1], path)
        if forest is not None and path is None:
            self._note(key, forest, found[1])
        return forest

    def keep(self, key: TimelineKey, forest: Forest) -> None:
        """Save a forest if that is due."""
        kept = self._last(key, forest)
        due = max(self._pace.every, kept.size // self._pace.budget)
        if forest.position - kept.place >= due:
            self._save(key, forest)

    def keep_last(self, key: TimelineKey, forest: Forest) -> None:
        """Save the last forest of a timeline, unless it is as good as saved or soon folded."""
        kept = self._last(key, forest)
        news = forest.position - kept.place > self._pace.lag or forest.count_of_nodes != kept.nodes
        if forest.position > self._pace.lag and news:
            self._save(key, forest)

    def forget(self, key: TimelineKey) -> None:
        """Drop what is remembered of a timeline that was deleted or renamed."""
        self._kept = {at: kept for at, kept in self._kept.items() if at[0] != key}

    def forget_all(self) -> None:
        """Drop what is remembered of all timelines."""
        self._kept = {}

    def _save(self, key: TimelineKey, forest: Forest) -> None:
        if self._journal.writable:
            body = saved(forest)
            # What was recorded is safe; without this one it is folded for longer, that is all.
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
        """Name of checkpoints with beliefs, or with nothing but the timeline's own simulator."""
        return f"{'beliefs' if beliefs else 'world'} {self._origin}"

    @cached_property
    def _origin(self) -> str:
        start = encode_start(replace(self._setting, name="", script=()), "")
        return blake2b(start, digest_size=16, key=_program()).hexdigest()


@cache
def _program() -> bytes:
    """A digest of the program that folds, so that another one does not trust what it left."""
    digest = blake2b(VERSION.encode(), digest_size=16)
    for room in _ROOMS:
        for source in _sources(files("beliefnest").joinpath(room)):
            digest.update(source.read_bytes())
    return digest.digest()


def _sources(room: Traversable) -> Iterator[Traversable]:
    """Python files of a room and of those in it, in order of names."""
    for each in sorted(room.iterdir(), key=lambda each: each.name):
        if each.is_dir():
            yield from _sources(each)
        elif each.name.endswith(".py"):
            yield each
