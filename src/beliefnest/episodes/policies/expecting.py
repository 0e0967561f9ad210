"""Courses with the best expected outcome, if the goals of others are not known.

A supposition assigns a goal to each other agent, and a place to each item whose place the agent
must know and does not. `search` finds a course for each; each course is tried in all of
them, and the one with the best expected outcome is chosen.
"""

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence

import msgspec
from msgspec.structs import replace

from beliefnest.episodes.agent_view import AgentView, Brief
from beliefnest.episodes.considered import SearchTrace, TriedCourse
from beliefnest.episodes.imagination import Imagination
from beliefnest.episodes.policies.candidates import items_of
from beliefnest.episodes.policies.course_planner import (
    OPEN,
    REACHED,
    VIOLATED,
    CourseScore,
    Planner,
    Planning,
    SearchBounds,
)
from beliefnest.skills.calls import Call, program_of
from beliefnest.world.values import Position

GoalShares = Mapping[str, Mapping[str, float]]
"""Probability of each possible goal, by agent and name of the goal."""

_LEAST = 0.02
"""Probability below which combinations of goals are ignored."""

_PER_DEED = 10.0
"""Penalty of an open goal for each missing action, in ticks."""


class _Supposition(msgspec.Struct, frozen=True, eq=False):
    """Assumed goals of others and places of items.

    Attributes:
        weight: Its probability.
        planner: Planner for agents that all know the supposed goals.
        brief: The task with these goals.
        mind: World of the supposition.
    """

    weight: float
    planner: Planner
    brief: Brief
    mind: Imagination


class Expecting:
    """Choice of a course for one round.

    Args:
        view: View of the agent.
        order: Its order of Theory of Mind.
        bounds: How much it looks at.
    """

    def __init__(self, view: AgentView, order: int, bounds: SearchBounds) -> None:
        self._view, self._order, self._bounds = view, order, bounds

    def program(self, shares: GoalShares, *, learns: bool = False) -> str:
        """Return the course with the best expected outcome, as a program.

        Args:
            shares: How likely the goals of the others are.
            learns: True if the agent reckons with learning. A course is then worth what the best
                courses reach after its first round, if that tells which supposition holds.
        """
        supposed = sorted(self._suppositions(shares), key=lambda each: -each.weight)
        if len(supposed) == 1:
            return program_of(self._course(supposed[0]))
        courses: dict[str, tuple[Call, ...]] = {}
        for calls in [*map(self._course, supposed), ()]:
            courses.setdefault(program_of(calls), calls)
        worth = self._learning if learns else self._expected
        values = {text: worth(supposed, calls) for text, calls in courses.items()}
        ranked = sorted(values.items(), key=lambda each: each[1])
        tried = sum(each.planner.tried for each in supposed)
        self._view.note_considered(
            SearchTrace(
                tuple(TriedCourse(text, "expected", tuple(score)) for text, score in ranked),
                tried=tried,
            )
        )
        return ranked[0][0]

    def _suppositions(self, shares: GoalShares) -> Iterator[_Supposition]:
        brief, mind = self._view.brief, self._view.imagine(self._order)
        cases = list(combinations(shares))
        cases = [(share, names) for share, names in cases if share >= _LEAST] or cases
        total = math.fsum(share for share, _ in cases)
        for share, names in cases:
            goals = {agent: brief.possible_goals[agent][name] for agent, name in names.items()}
            supposed = brief.supposing(goals)
            planner = Planner(supposed, self._view.spoken)
            minds = _completed(mind, supposed, self._view.agent, self._order)
            for each in minds:
                yield _Supposition(share / total / len(minds), planner, supposed, each)

    def _planning(self, each: _Supposition) -> Planning:
        agent = self._view.agent
        # Imagined is a scripted world, in which a block on foot takes one tick.
        ticks = self._view.ticks_left_for(each.brief.goals[agent]) // each.brief.pace
        return each.planner.planning(agent, self._order, ticks, self._bounds)

    def _course(self, each: _Supposition) -> tuple[Call, ...]:
        return self._planning(each).best(each.mind).calls

    def _expected(self, supposed: Sequence[_Supposition], calls: tuple[Call, ...]) -> CourseScore:
        scores = ((each, self._planning(each).outcome(each.mind, calls)) for each in supposed)
        return _mean((each.weight, self._judged(each, calls, score)) for each, score in scores)

    def _learning(self, supposed: Sequence[_Supposition], calls: tuple[Call, ...]) -> CourseScore:
        plans = ((each, self._planning(each).best(each.mind, calls)) for each in supposed)
        return _mean(
            (each.weight, self._judged(each, (*calls, *plan.calls), plan.score))
            for each, plan in plans
        )

    def _judged(self, each: _Supposition, calls: Sequence[Call], score: CourseScore) -> CourseScore:
        """Return a score with the utterances counted that the goal allows."""
        view, most = self._view, each.brief.goals[self._view.agent].messages
        own = sum(call.skill == "say" for call in calls) if view.agent in each.brief.players else 0
        return score if most is None or view.messages + own <= most else (VIOLATED, 0.0)


def uniform(brief: Brief) -> GoalShares:
    """Return the shares of somebody who learns nothing from what others do."""
    return {
        agent: dict.fromkeys(goals, 1 / len(goals)) for agent, goals in brief.possible_goals.items()
    }


def combinations(shares: GoalShares) -> Iterator[tuple[float, Mapping[str, str]]]:
    """Yield all combinations of goals with their probabilities; agents are independent."""
    for names in itertools.product(*(goals for goals in shares.values())):
        chosen = dict(zip(shares, names, strict=True))
        yield math.prod(shares[agent][name] for agent, name in chosen.items()), chosen


def _completed(mind: Imagination, brief: Brief, agent: str, order: int) -> list[Imagination]:
    """Return a mind with the items that its agent seeks put where they may be, each as likely.

    An item that is known nowhere is where another agent wants it, else in a container into which
    the agent has not looked, and of whose contents no opponent has spoken.
    """
    goal, doubted = brief.goals[agent], frozenset[Position]()
    if order:
        opponents = [name for name, other in brief.goals.items() if other.differs(goal)]
        mind, doubted = mind.doubting(opponents)
    minds = [mind]
    for item in items_of([goal]):
        world = mind.world
        holders = [*world.containers.values(), *(each.inventory for each in world.agents.values())]
        if any(items.get(item, 0) for items in holders):
            continue
        contents = mind.view().containers
        unseen = [at for at, items in contents.items() if not items.complete and at not in doubted]
        wanted = [
            condition.fact.store
            for name, other in brief.goals.items()
            if name != agent
            for condition in other.reach
            if condition.fact.store is not None and item in condition.fact.items
        ]
        places = sorted(set(wanted) & set(unseen)) or sorted(unseen)
        minds = [_with_item(each, at, item) for each in minds for at in places] or minds
    return minds


def _with_item(mind: Imagination, place: Position, item: str) -> Imagination:
    made = mind.fork()
    contents = {at: dict(items) for at, items in made.world.containers.items()}
    contents[place] = {**contents.get(place, {}), item: 1}
    made.world.set_state(replace(made.world.snapshot(), containers=contents))
    return made


def _mean(scores: "Iterator[tuple[float, CourseScore]]") -> CourseScore:
    """Return the expected outcome: how far from success, then in how many ticks."""
    kinds, ticks = [], []
    for weight, score in scores:
        kind, value, *cost = score if len(score) > 1 else (*score, 0.0)
        kinds.append(weight * kind)
        per = _PER_DEED if kind == OPEN else 1.0
        ticks.append(weight * (per * value + (sum(cost) if kind != REACHED else 0.0)))
    return (round(math.fsum(kinds), 9), round(math.fsum(ticks), 6))
