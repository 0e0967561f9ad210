"""Certificates of functional items: what order of Theory of Mind their episodes need.

Instances that differ in one parameter and look the same to an agent of one order less are
*siblings*: whatever does not see the belief of the order acts alike in all of them, and wins at
most those in which one and the same course wins.
"""

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import msgspec
from msgspec.structs import asdict

from beliefnest.episodes.shortcuts import policy_of, rules_of, trained_rule
from beliefnest.episodes.task import Task
from beliefnest.errors import ModelError
from beliefnest.llm.budget import RunLimits
from beliefnest.locking import holding
from beliefnest.plan.cells import digest
from beliefnest.plan.jobs import OnStudyProgress, run_cells
from beliefnest.plan.terms import Terms
from beliefnest.scenarios.scoring import wilson_interval
from beliefnest.studies.items.functional.groups import GroupCell, GroupFolder, GroupKey
from beliefnest.studies.items.functional.siblings import TaskFamily
from beliefnest.worlds.minecraft.launching import ahead

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
) -> GroupCell:
    """Return the cell of a group of siblings, or of one instance."""
    content = digest([each.plain() for each in siblings])[:16]
    names = tuple(map(policy_of, rules))
    key = GroupKey(first.name, content, seed, first.order, names, courses)
    return GroupCell(key, siblings)


def _played(
    cells: Sequence[GroupCell], folder: Path, jobs: int, on_progress: OnStudyProgress
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
