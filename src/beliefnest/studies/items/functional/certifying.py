"""Certificates of functional items: what order of Theory of Mind their episodes need.

Instances that differ in one parameter and look the same to an agent of one order less are
*siblings*: whatever does not see the belief of the order acts alike in all of them, and wins at
most those in which one and the same course wins.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from itertools import product
from pathlib import Path
from typing import Any

from beliefnest.episodes.agent_view import GO_ON, AgentView, Policy
from beliefnest.episodes.episode import Episode
from beliefnest.episodes.policies.candidates import calls_of, claims_of_mind, said
from beliefnest.episodes.policies.search import Search
from beliefnest.episodes.shortcuts import CHANCE, rules_of, trained_rule
from beliefnest.episodes.task import Task
from beliefnest.errors import InputError, ModelError
from beliefnest.plan.jobs import OnStudyProgress
from beliefnest.scenarios.document import Document
from beliefnest.scenarios.instances import drawn_instance, has_instances
from beliefnest.scenarios.loading import condition_numbers
from beliefnest.scenarios.parameters import choices, declared_in
from beliefnest.scenarios.scenario import Scenario
from beliefnest.scenarios.scoring import wilson_interval
from beliefnest.skills.calls import program_of
from beliefnest.studies.episode_design import EpisodeDesign
from beliefnest.studies.study import Study
from beliefnest.world.texts import quoted

_EXACT = 2
"""Greatest number of groups of siblings in which all courses are tried."""
_MOST = 0.5
"""Greatest rate at which one course may win among instances that look the same."""
_TRAINED, _TRAINING = 10_000, 3
"""First instance on which linear rules are tried, apart from those that are judged; how many."""

Tally = tuple[int, int]
"""Number of won episodes, and of all."""


@dataclass(frozen=True, slots=True)
class Certificate:
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
            siblings; at order 0, where rules may win, none is played.
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
    rules: Mapping[str, Tally] = field(default_factory=dict)

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
        for name, (won, played) in {**lower, **self.rules}.items():
            if wilson_interval(won, played)[0] > self.bound:
                faults.append(f"{name} wins {won} of {played}, above {self.bound:.0%}")
        return faults

    def plain(self) -> dict[str, Any]:
        """Return the values by name, with intervals of the rules."""
        rules = {
            name: {"won": won, "played": played, "interval": wilson_interval(won, played)}
            for name, (won, played) in self.rules.items()
        }
        values = {name: getattr(self, name) for name in self.__slots__}
        return {**values, "rules": rules, "certified": not self.faults, "faults": self.faults}


@dataclass(frozen=True)
class TaskFamily:
    """A task file under one condition.

    Attributes:
        name: Name or path of the file.
        document: Its document.
        condition: Number of the condition; None: the scenario as written.
    """

    name: str
    document: Document
    condition: int | None

    @property
    def folder(self) -> str:
        """Return a name for the folder of its episodes."""
        return f"{Path(self.name).stem}-{self.condition or 0}"

    def instance(self, seed: int, **values: Any) -> Task:
        """Return an instance, with some values in place of those that are drawn."""
        return Task.instance_of(self.document, seed, self.condition, values)

    def values(self, seed: int) -> dict[str, Any]:
        """Return the values that an instance draws."""
        return drawn_instance(self.document, seed, {})

    def siblings(self, seed: int, name: str) -> list[Task]:
        """Return the instances that differ from one in a parameter alone, itself included."""
        drawn, make = self.values(seed), partial(Scenario.varied, self.document, self.condition)
        return [Task.of(make({**drawn, name: value})) for value in self.choices(name)]

    def choices(self, name: str) -> list[Any]:
        """Return the values that a parameter may have; empty: too many to list."""
        return list(choices(declared_in(self.document)[name]) or ())

    def hidden(self, seed: int, order: int) -> str:
        """Return the parameter whose values an agent of one order less cannot tell apart.

        Returns:
            Of such parameters that are drawn the one with the fewest values; empty: there is none.
        """
        names = sorted(self.values(seed), key=lambda name: len(self.choices(name)))
        for name in names:
            seen = [_seen(task, order - 1) for task in self.siblings(seed, name)]
            if len(seen) > 1 and all(each == seen[0] for each in seen):
                return name
        return ""


def families_of(design: EpisodeDesign) -> Iterator[TaskFamily]:
    """Yield the families of a study of episodes: each file under each of its conditions.

    Raises:
        InputError: A task has no random instances.
    """
    for name in design.tasks:
        document = Task.scenario_document(name)
        if document is None or not has_instances(document):
            raise InputError(
                f"{name} has no `instances`; give a scenario file with `episode` and `instances`"
            )
        there = condition_numbers(document)
        for condition in there if there == (None,) else design.conditions or there:
            yield TaskFamily(name, document, condition)


def certified(
    family: TaskFamily, seeds: Sequence[int], folder: Path, jobs: int, on_progress: OnStudyProgress
) -> Certificate:
    """Play a family by search, by rules and by all courses, and return its certificate.

    Args:
        family: The family.
        seeds: Instances that `search` plays. Rules play as many, in whole groups of siblings.
        folder: Folder of the episodes; what is in it is not played again.
        jobs: Number of processes.
        on_progress: Function that receives the progress.

    Raises:
        BeliefNestError: The task is wrong, or an episode has no result.
    """
    first = family.instance(seeds[0])
    order = first.order
    play = partial(_tallies, family, jobs=jobs, on_progress=on_progress)
    names = [f"search:{each}" for each in range(max(0, order - 1), order + 1)]
    won = play(names, seeds, folder / "search")
    certificate = partial(Certificate, first.name, family.condition, order, won[names[-1]])
    hidden = family.hidden(seeds[0], order)
    if not hidden:
        return certificate()
    values = family.choices(hidden)
    count = len(values)
    groups = seeds[: -(-len(seeds) // count)]
    wins: Mapping[str, Tally] = {}
    if order:
        trained = trained_rule(family.instance, range(_TRAINED, _TRAINED + _TRAINING))
        rules = list(dict.fromkeys((*rules_of(first), trained)))
        wins = play(rules, groups, folder / "rules", {hidden: values})
    exact = groups[:_EXACT]
    best = [best_course(family.siblings(seed, hidden), order) for seed in exact]
    return certificate(
        lower=won[names[0]] if order else None,
        hidden=hidden,
        siblings=count,
        groups=len(exact),
        bound=sum(best) / (count * len(exact)),
        rules=wins,
    )


def _tallies(
    family: TaskFamily,
    policies: Sequence[str],
    seeds: Sequence[int],
    folder: Path,
    variations: Mapping[str, Sequence[Any]] | None = None,
    *,
    jobs: int,
    on_progress: OnStudyProgress,
) -> dict[str, Tally]:
    """Return how many episodes each policy won."""
    study = Study(
        tasks=[family.name],
        policies=list(policies),
        seeds=list(seeds),
        conditions=None if family.condition is None else [family.condition],
        variations=variations,
    )
    result = study.run(folder, jobs, on_progress=on_progress)
    for why in result.failed.values():
        raise ModelError(f"an episode of {family.name} has no result: {why}")
    return {each["policy"]: (each["right"], each["judged"]) for each in result.counted(["policy"])}


def best_course(siblings: Sequence[Task], order: int) -> int:
    """Return in how many of some instances the best single course of the players wins.

    Courses are each call and each utterance, also untrue ones, that concerns a goal, doing nothing,
    and what `search` of the order does in each of the instances.
    """
    lists = [_Listing(order) for _ in siblings]
    for task, listing in zip(siblings, lists, strict=True):
        _play(task, listing)
    programs = dict.fromkeys(("", *lists[0].programs, *(each.course for each in lists)))
    return max(sum(_play(task, _Course(program)) for task in siblings) for program in programs)


def _play(task: Task, policy: Policy) -> bool:
    with Episode(task, dict.fromkeys(task.players, policy)) as episode:
        return episode.play().success


@dataclass
class _Listing:
    """Policy that acts as search does, and keeps the courses that were open at the beginning."""

    order: int
    programs: Sequence[str] = ()
    course: str = ""

    def act(self, view: AgentView) -> str:
        program = Search(self.order).act(view)
        if view.round == 0:
            mind, goals = view.imagine(self.order), [view.goal]
            claims = claims_of_mind(mind, goals, lies=True) if view.may_speak else ()
            calls = [*calls_of(mind, view.agent, goals), *map(said, claims)]
            self.programs, self.course = [program_of([each]) for each in calls], program
        return program


@dataclass(frozen=True)
class _Course:
    """Policy that plays one program to its end."""

    program: str

    def act(self, view: AgentView) -> str:
        if view.round == 0:
            return self.program
        return GO_ON if view.last.how == "cut" else ""


def _seen(task: Task, depth: int) -> dict[tuple[str, ...], Any]:
    """Return what players believe at the beginning, and believe others to believe.

    Args:
        task: The instance.
        depth: Greatest number of agents below a player.
    """
    watching = _Watching(depth)
    with Episode(task, dict.fromkeys(task.players, watching)) as episode:
        episode.play(1)
    return watching.seen


@dataclass
class _Watching:
    """Policy that does nothing but keep what its agent believes at the beginning."""

    depth: int
    seen: dict[tuple[str, ...], Any] = field(default_factory=dict)

    def act(self, view: AgentView) -> str:
        if view.round:
            return ""
        for length in range(self.depth + 1):
            for path in product(view.brief.agents, repeat=length):
                whole = (view.agent, *path)
                if any(one == other for one, other in zip(whole, path, strict=False)):
                    continue
                state = view.about(*path) if path else view.state
                self.seen[whole] = (
                    {at: (dict(c.items), c.complete) for at, c in state.containers.items()},
                    {
                        name: (each.position, dict(each.inventory))
                        for name, each in state.agents.items()
                    },
                    state.blocks.grid.tobytes(),
                    dict(state.signs),
                )
        return ""


def chance_of(rules: Mapping[str, Tally]) -> Tally:
    """Return the episodes won by the rule that draws among the places."""
    return next(tally for name, tally in reversed(list(rules.items())) if CHANCE in name)


def check_functional(design: object, name: str) -> EpisodeDesign:
    """Return a design as one of episodes.

    Raises:
        InputError: It is a study of scenarios.
    """
    if not isinstance(design, EpisodeDesign):
        raise InputError(f"{quoted(name)} is a study of scenarios; name the files under `tasks`")
    return design
