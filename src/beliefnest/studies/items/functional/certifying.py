"""Certificates of functional items: what order of Theory of Mind their episodes need.

Instances that differ in one parameter and look the same to an agent of one order less are
*siblings*: whatever does not see the belief of the order acts alike in all of them, and wins at
most those in which one and the same course wins. Groups of siblings are cells: search, rules and
single courses play them from one beginning.
"""

import json
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, ClassVar

import msgspec
from msgspec.structs import asdict

from beliefnest.episodes.agent_view import AgentView
from beliefnest.episodes.policies.candidates import calls_of, claims_of_mind, said
from beliefnest.episodes.policies.search import Search
from beliefnest.episodes.policies.simple import Program
from beliefnest.episodes.shortcuts import policy_of, rules_of, trained_rule
from beliefnest.episodes.task import Task
from beliefnest.episodes.trials import Trials
from beliefnest.errors import ModelError
from beliefnest.files import replace_file
from beliefnest.llm.budget import RunLimits
from beliefnest.locking import holding
from beliefnest.plan.cells import Key, digest
from beliefnest.plan.jobs import OnStudyProgress, run_cells
from beliefnest.plan.terms import PlayStage, Terms
from beliefnest.scenarios.record_forms import checked_form, read_json
from beliefnest.scenarios.scoring import wilson_interval
from beliefnest.skills.calls import program_of
from beliefnest.studies.forms import FailedCell
from beliefnest.studies.items.functional.siblings import TaskFamily
from beliefnest.worlds.minecraft.launching import ahead

_AGAIN = "delete it to certify it again"


@dataclass(frozen=True, slots=True)
class _GroupKey(Key):
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


class _GroupCell(msgspec.Struct, frozen=True):
    """Group of siblings, to be played by all that a certificate compares.

    `search` of the order and of one order less play the first instance; rules and courses play
    all.

    Attributes:
        key: Identity of the cell.
        siblings: The instances.
    """

    key: _GroupKey
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
                "best": _best_course(group, self.siblings[0].players, key.order)
                if key.courses
                else None,
            }


class _PlayedGroup(msgspec.Struct):
    """Result of `GroupCell.play`."""

    error: None
    search: list[bool]
    rules: dict[str, list[bool]]
    best: int | None


def _best_course(group: Sequence[Trials], players: Sequence[str], order: int) -> int:
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


_EXACT = 2
"""Greatest number of groups of siblings in which all courses are tried."""
_MOST = 0.5
"""Greatest rate at which one course may win among instances that look the same."""
_TRAINED, _TRAINING = 10_000, 3
"""First instance on which linear rules are tried, apart from those that are judged; how many."""

Tally = tuple[int, int]
"""Number of won episodes, and of all."""


class Certificate(msgspec.Struct, frozen=True):
    """Results of a family at one order.

    Attributes:
        family: Name of the task's scenario.
        condition: Number of the condition; None: the scenario as written.
        order: Order that the task states.
        solved: Episodes that `search` of the order won.
        lower: Episodes that `search` of one order less won; None: the order is 0.
        hidden: Parameter whose values look the same to one order less; empty: there is none. An
            agent of less than order 0 sees nothing.
        siblings: Number of these values.
        groups: Number of groups of siblings in which all courses were tried.
        bound: Greatest rate at which one course for all siblings of a group wins; None: none tried.
        rules: Episodes that each rule without beliefs about others won, on whole groups of
            siblings, the one that draws and the trained one last; at order 0, where rules may win,
            none is played.
    """

    family: str
    condition: int | None
    order: int
    solved: Tally
    lower: Tally | None = None
    hidden: str = ""
    siblings: int = 0
    groups: int = 0
    bound: float | None = None
    rules: Mapping[str, Tally] = msgspec.field(default_factory=dict)

    @property
    def faults(self) -> list[str]:
        """Return why the order is not certified; empty: it is."""
        faults = []
        won, played = self.solved
        if won < played:
            faults.append(f"search:{self.order} wins {won} of {played}")
        if self.bound is None:
            less = self.order - 1
            return [*faults, f"every parameter that is drawn shows in beliefs of order {less}"]
        if self.bound > _MOST:
            faults.append(f"one course wins {self.bound:.0%} of the instances that look the same")
        lower = {} if self.lower is None else {f"search:{self.order - 1}": self.lower}
        ruled = {policy_of(rule): tally for rule, tally in self.rules.items()}
        for name, (won, played) in {**lower, **ruled}.items():
            if wilson_interval(won, played)[0] > self.bound:
                faults.append(f"{name} wins {won} of {played}, above {self.bound:.0%}")
        return faults

    @property
    def chance(self) -> Tally | None:
        """Return the episodes won by the rule that draws among the places; None: none played."""
        return list(self.rules.values())[-2] if self.rules else None

    def plain(self) -> dict[str, Any]:
        """Return the values by name, with intervals of the rules."""
        rules = {
            policy_of(rule): {"won": w, "played": played, "interval": wilson_interval(w, played)}
            for rule, (w, played) in self.rules.items()
        }
        return {**asdict(self), "rules": rules, "certified": not self.faults, "faults": self.faults}


def certified(
    family: TaskFamily, seeds: Sequence[int], folder: Path, jobs: int, on_progress: OnStudyProgress
) -> Certificate:
    """Play a family by search, by rules and by all courses, and return its certificate.

    Args:
        family: The family.
        seeds: Instances that `search` plays. Rules play as many, in whole groups of siblings.
        folder: Folder of the outcomes; what is in it is not played again.
        jobs: Number of processes.
        on_progress: Function that receives the progress.

    Raises:
        BeliefNestError: The task is wrong, or an episode has no result.
    """
    first = family.instance(seeds[0])
    hidden, order = family.hidden(seeds[0], first.order), first.order
    count = len(family.choices(hidden)) if hidden else 1
    # As many instances in groups as `search` plays; without a hidden parameter, there is no group.
    groups = seeds[: -(-len(seeds) // count)] if hidden else ()
    rules: Sequence[str] = ()
    if order and hidden:
        trained = trained_rule(family.instance, range(_TRAINED, _TRAINED + _TRAINING))
        rules = (*rules_of(first), trained)
    cells = [
        _cell(first, seed, family.siblings(seed, hidden), rules, courses=seed in groups[:_EXACT])
        for seed in groups
    ]
    cells += [_cell(first, seed, (family.instance(seed),)) for seed in seeds[len(groups) :]]
    results = _played(cells, folder, jobs, on_progress)
    searched = [(sum(won), len(seeds)) for won in zip(*(r["search"] for r in results), strict=True)]
    certificate = partial(Certificate, first.name, family.condition, order, searched[-1])
    if not hidden:
        return certificate()
    played = count * len(groups)
    best = [result["best"] for result in results if result["best"] is not None]
    return certificate(
        lower=searched[0] if order else None,
        hidden=hidden,
        siblings=count,
        groups=len(best),
        bound=sum(best) / (count * len(best)),
        rules={
            rule: (sum(sum(r["rules"].get(policy_of(rule), ())) for r in results), played)
            for rule in rules
        },
    )


def _cell(
    first: Task,
    seed: int,
    siblings: Sequence[Task],
    rules: Sequence[str] = (),
    *,
    courses: bool = False,
) -> _GroupCell:
    """Return the cell of a group of siblings, or of one instance."""
    content = digest([each.plain() for each in siblings])[:16]
    names = tuple(map(policy_of, rules))
    key = _GroupKey(first.name, content, seed, first.order, names, courses)
    return _GroupCell(key, siblings)


def _played(
    cells: Sequence[_GroupCell], folder: Path, jobs: int, on_progress: OnStudyProgress
) -> list[dict[str, Any]]:
    """Play the cells without a result, and return all results in order.

    Raises:
        ModelError: A cell has no result.
    """
    place = GroupFolder(folder)
    terms = Terms(folder / "answers", place.ledger, None, RunLimits())
    with holding(folder):
        run_cells(cells, place, terms, jobs, "loky", on_progress, ahead)
    results = []
    for cell in cells:
        result = place.cell(cell.key.name)
        if result is None or result["error"] is not None:
            why = "it was not played" if result is None else result["error"]
            raise ModelError(f"an episode of {cell.key.task} has no result: {why}")
        results.append(result)
    return results
