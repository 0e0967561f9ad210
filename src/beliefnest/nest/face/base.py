"""What live and recorded nests have in common."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Self

from beliefnest.nest.face.reader import Reader
from beliefnest.nest.face.shown import ShownNest
from beliefnest.nest.face.turns import in_turn
from beliefnest.nest.past.setting import Setting
from beliefnest.timeline.journal import TimelineKey, lineage
from beliefnest.timeline.records import ProgramRecord, PromptRecord
from beliefnest.world.paths import parse_path

if TYPE_CHECKING:  # The page lies above; see `view`.
    from beliefnest.viewer.page.notebook import PageView

__all__ = ["NestBase"]


class NestBase(ShownNest, ABC):
    """A nest whose simulators are read at the latest tick of the branch they are on."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @abstractmethod
    def close(self) -> None:
        """Close the run file, and end the world if there is one."""

    @property
    def setting(self) -> Setting:
        """What the nest started from."""
        return self._recording.setting

    @property
    def seed(self) -> int:
        """Drives every random number."""
        return self._recording.seed

    @property
    def agents(self) -> tuple[str, ...]:
        """Names of all agents, sorted."""
        return self._recording.agents

    @property
    def reader(self) -> Reader:
        """What viewers read of the nest, on any of its timelines."""
        return Reader(self._recording)

    @in_turn
    def versions(self) -> Sequence[Mapping[str, str]]:
        """Program to version, when the run began and whenever it was resumed with others."""
        return self._recording.records.versions()

    @in_turn
    def programs(self, path: str | None = None) -> tuple[ProgramRecord, ...]:
        """Return programs that ran, on branches that were not deleted, in order of their end.

        Args:
            path: Those that ran in this simulator on the branch it is on: in follow mode there are
                none, and those that ran before the fork belong to another branch. None: all.
        """
        programs = tuple(self._recording.records.programs())
        if path is None:
            return programs
        key = self._recording.selected.get(parse_path(path, self.agents))
        return tuple(p for p in programs if TimelineKey(p.path, p.branch) == key)

    @in_turn
    def prompts(self, path: str | None = None) -> tuple[PromptRecord, ...]:
        """Requests to models that `Simulator.noting` kept, with what came of them, in order.

        Args:
            path: Those made from this simulator, in the past of the branch it is on or follows;
                None: all.
        """
        prompts = tuple(self._recording.records.prompts())
        if path is None:
            return prompts
        names = parse_path(path, self.agents)
        until = dict(lineage(self._recording.journal, self._recording.controller(names)))
        return tuple(p for p in prompts if p.path == names and p.tick <= until.get(p.timeline, -1))

    @in_turn
    def kept(self, name: str) -> bytes | None:
        """Return the bytes that `Nest.keep` kept last under a name; None if there are none."""
        return self._recording.records.state(f"kept {name}")

    def view(self, depth: int = 2, height: int = 720) -> "PageView":
        """Return the page of the nest as it is when it is first shown, for a notebook's cell.

        An episode's rounds are in it.

        Args:
            depth: How deep all beliefs go, 0 to 4.
            height: Of the page, pixels.
        """
        # The one way up: a page reads nests, with the rounds of an episode.
        from beliefnest.episodes.telling import told_episode
        from beliefnest.viewer.page.notebook import PageView

        return PageView(self.reader, depth, height, lambda: told_episode(self))
