"""What a run notes beside its timelines: selected branches, programs, requests to models."""

from collections.abc import Mapping, Sequence
from typing import Protocol

from beliefnest.timeline.journal import Journal
from beliefnest.timeline.records import ProgramRecord, PromptRecord

__all__ = ["RunJournal", "RunLog"]

Path = tuple[str, ...]


class RunLog(Protocol):
    """Notes of a run; they follow the timelines of its journal that are renamed or deleted."""

    def put_state(self, name: str, value: bytes) -> None:
        """Keep bytes under a name, in place of what was there."""

    def state(self, name: str) -> bytes | None:
        """The bytes last put under a name; None if there are none."""

    def select(self, path: Path, branch: str) -> None:
        """Note which branch a simulator is on."""

    def selected(self) -> Mapping[Path, str]:
        """The branch each simulator is on, of those that were noted."""

    def add_program(self, program: ProgramRecord) -> None:
        """Note a program that has ended."""

    def next_group(self) -> int:
        """A number for programs that run at the same time, which none before has had."""

    def programs(self) -> Sequence[ProgramRecord]:
        """All programs of branches that are there, in order of their end."""

    def add_prompt(self, prompt: PromptRecord) -> None:
        """Note a request to a model and what came of it."""

    def prompts(self) -> Sequence[PromptRecord]:
        """All requests to models from branches that are there, in order."""

    def add_versions(self, versions: Mapping[str, str]) -> None:
        """Note what runs from now on, if it is not what ran before."""

    def versions(self) -> Sequence[Mapping[str, str]]:
        """Program to version, when the run began and whenever it went on with others."""


class RunJournal(Journal, Protocol):
    """A journal that keeps the run's notes together with its timelines."""

    @property
    def records(self) -> RunLog:
        """The notes."""
