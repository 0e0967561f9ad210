"""Common base of live and recorded nests."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Self

from beliefnest.importing import part
from beliefnest.nest.face.reader import Reader
from beliefnest.nest.face.shown import ShownNest
from beliefnest.nest.face.turns import in_turn
from beliefnest.nest.past.setting import Setting
from beliefnest.timeline.journal import TimelineKey
from beliefnest.timeline.run_records import ProgramRecord, PromptRecord
from beliefnest.world.paths import parse_path

if TYPE_CHECKING:  # The page lies above; see `view`.
    from beliefnest.episodes.notebook import PageView
    from beliefnest.minds.inference import Inference


class NestBase(ShownNest, ABC):
    """Nest whose simulators are read at the latest tick of their branches."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @abstractmethod
    def close(self) -> None:
        """Close the run file, and end the world if there is one."""

    @property
    def setting(self) -> Setting:
        """The setting from which the nest started."""
        return self._recording.setting

    @property
    def seed(self) -> int:
        """The seed of every random number."""
        return self._recording.seed

    @property
    def tick(self) -> int:
        """The latest tick of the real world."""
        return self._recording.info(()).head

    @property
    def agents(self) -> tuple[str, ...]:
        """The names of all agents, sorted."""
        return self._recording.agents

    @property
    def reader(self) -> Reader:
        """The reader that viewers use, for any of the nest's timelines."""
        return Reader(self._recording)

    @in_turn
    def versions(self) -> Sequence[Mapping[str, str]]:
        """Return versions by program, for the start and for each resume with other versions."""
        return self._recording.records.versions()

    @in_turn
    def programs(self, path: str | None = None) -> tuple[ProgramRecord, ...]:
        """Return the programs that ran on branches that still exist, in order of their end.

        Args:
            path: Path of a simulator, to return only the programs of its present branch. In follow
                mode there are none; programs before a fork belong to the other branch. None: all.
        """
        programs = tuple(self._recording.records.programs())
        if path is None:
            return programs
        key = self._recording.selected.get(parse_path(path, self.agents))
        return tuple(p for p in programs if TimelineKey(p.path, p.branch) == key)

    @in_turn
    def prompts(self, path: str | None = None) -> tuple[PromptRecord, ...]:
        """Return the requests to models that `Simulator.noting` recorded, with their outcomes.

        Args:
            path: Simulator whose requests are wanted, in the past of the branch that it is on or
                follows; None: all requests.
        """
        prompts = tuple(self._recording.records.prompts())
        if path is None:
            return prompts
        names = parse_path(path, self.agents)
        until = dict(self._recording.journal.lineage(self._recording.controller(names)))
        return tuple(p for p in prompts if p.path == names and p.tick <= until.get(p.timeline, -1))

    @in_turn
    def kept(self, name: str) -> bytes | None:
        """Return the bytes that `Nest.keep` stored last under a name; None if there are none."""
        return self._recording.records.state(f"kept {name}")

    def view(
        self,
        depth: int = 2,
        height: int = 720,
        *,
        inference: "Inference | None" = None,
        steps: int = 5,
    ) -> "PageView":
        """Return the page of the nest for a notebook's cell, with the rounds of an episode.

        The page is made when it is first shown.

        Args:
            depth: Number of levels of beliefs that the page shows, 0 to 4.
            height: Height of the page, pixels.
            inference: A posterior; the page shows it over time, with the movements that changed
                it, and tints the plan by the places that it predicts.
            steps: Number of actions after which places are predicted.
        """
        page: PageView = part("page")(self.reader, self, depth, height, inference, steps)
        return page
