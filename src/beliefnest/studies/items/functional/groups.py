"""Groups of siblings as cells: search, rules and single courses play them from one beginning."""

import json
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import msgspec

from beliefnest.episodes.agent_view import AgentView
from beliefnest.episodes.policies.candidates import calls_of, claims_of_mind, said
from beliefnest.episodes.policies.search import Search
from beliefnest.episodes.policies.simple import Program
from beliefnest.episodes.task import Task
from beliefnest.episodes.trials import Trials
from beliefnest.files import replace_file
from beliefnest.plan.cells import Key
from beliefnest.plan.terms import PlayStage
from beliefnest.scenarios.record_forms import checked_form, read_json
from beliefnest.skills.calls import program_of
from beliefnest.studies.forms import FailedCell

_AGAIN = "delete it to certify it again"


@dataclass(frozen=True, slots=True)
class GroupKey(Key):
    """Identity of a cell.

    Attributes:
        task: Name of the task.
        content: Hash of the instances.
        instance: Number of the first instance.
        order: Order that the task states.
        rules: Names of the rules that play.
        courses: True if all single courses are tried.
    """

    task: str
    content: str
    instance: int
    order: int
    rules: Sequence[str]
    courses: bool

    @property
    def seed(self) -> int:
        """Return the seed of all random numbers, which is the same for all siblings."""
        return self.instance


class GroupCell(msgspec.Struct, frozen=True):
    """Group of siblings, to be played by all that a certificate compares.

    `search` of the order and of one order less play the first instance; rules and courses play
    all.

    Attributes:
        key: Identity of the cell.
        siblings: The instances.
    """

    key: GroupKey
    siblings: Sequence[Task]
    world: ClassVar[str] = ""
    is_quick: ClassVar[bool] = False

    def plain(self) -> dict[str, Any]:
        """Return the cell as plain values."""
        return {"name": self.key.name, "key": self.key.content_json()}

    def play(self, stage: PlayStage) -> dict[str, Any]:
        """Play all episodes of the group.

        Returns:
            `search`: outcome of each order, the greatest last; `rules`: outcomes in the instances,
            by rule; `best`: number of instances that the best single course wins, None: not tried.
        """
        key = self.key
        orders = range(max(0, key.order - 1), key.order + 1)
        with ExitStack() as stack:
            group = [stack.enter_context(Trials(each, key.seed)) for each in self.siblings]
            played = [each.won(key.rules) for each in group]
            return {
                "error": None,
                "search": group[0].won([f"search:{order}" for order in orders]),
                "rules": dict(zip(key.rules, zip(*played, strict=True), strict=False)),
                "best": best_course(group, self.siblings[0].players, key.order)
                if key.courses
                else None,
            }


class _PlayedGroup(msgspec.Struct):
    """Result of `GroupCell.play`."""

    error: None
    search: list[bool]
    rules: dict[str, list[bool]]
    best: int | None


def best_course(group: Sequence[Trials], players: Sequence[str], order: int) -> int:
    """Return in how many of some instances the best single course of the players wins.

    Courses are each call and each utterance, also untrue ones, that concerns a goal, doing nothing,
    and what `search` of the order does in each of the instances.
    """
    searched = [Search(order).act(each.view(name)) for each in group for name in players]
    listed = [program for name in players for program in _open(group[0].view(name), order)]
    courses = [Program(program) for program in dict.fromkeys(("", *listed, *searched))]
    return max(map(sum, zip(*(each.won(courses) for each in group), strict=True)))


def _open(view: AgentView, order: int) -> Iterator[str]:
    """Yield the courses of one call that are open to an agent at the beginning."""
    mind, goals = view.imagine(order), [view.goal]
    claims = claims_of_mind(mind, goals, lies=True) if view.may_speak else ()
    for call in (*calls_of(mind, view.agent, goals), *map(said, claims)):
        yield program_of([call])


class GroupFolder(msgspec.Struct, frozen=True):
    """Folder with a file for the results of each cell.

    Attributes:
        path: The folder.
    """

    path: Path

    @property
    def ledger(self) -> Path:
        """File with the usage of answers; there is none, as no model plays."""
        return self.path / "spent.jsonl"

    def cell(self, name: str) -> dict[str, Any] | None:
        """Return the result of a cell; None: it has none.

        Raises:
            InputError: Its file is damaged.
        """
        file = self._file(name)
        if not file.exists():
            return None
        content = read_json(file, _AGAIN)
        form = _PlayedGroup if content.get("error") is None else FailedCell
        checked_form(content, form, file, _AGAIN)
        return content

    def write_cell(self, name: str, content: Mapping[str, Any]) -> None:
        """Write the result of a cell, completely or not at all."""
        replace_file(self._file(name), json.dumps(content))

    def note_seconds(self, name: str, seconds: float) -> None:
        """Note nothing: certificates have no times."""

    def _file(self, name: str) -> Path:
        return self.path / f"{name}.json"
