"""Policies that plan without a language model: `search:ORDER` and its upper bound."""

from collections.abc import Mapping

import msgspec

from beliefnest.episodes.agent_view import AgentView
from beliefnest.episodes.considered import CourseOutcome, SearchTrace, TriedCourse
from beliefnest.episodes.policies.course_planner import (
    OPEN,
    REACHED,
    USUAL,
    VIOLATED,
    FoundPlan,
    Planner,
    SearchBounds,
)
from beliefnest.episodes.policies.expecting import Expecting, uniform
from beliefnest.skills.calls import program_of

_MOST_COURSES = 10
_OUTCOMES: Mapping[float, CourseOutcome] = {REACHED: "reached", OPEN: "open", VIOLATED: "violated"}


class Search(msgspec.Struct, frozen=True):
    """Policy that plans by search, with beliefs of others down to its order.

    Attributes:
        order: Order of Theory of Mind.
        bounds: Bounds of the search.
    """

    order: int
    bounds: SearchBounds = USUAL

    def act(self, view: AgentView) -> str:
        """Return the calls of its plan, as a program."""
        if view.brief.hides_goals:
            return Expecting(view, self.order, self.bounds).program(uniform(view.brief))
        mind = view.imagine(self.order)
        # All agents know all goals here, so that their planners have the same brief.
        planner = Planner(view.brief, view.spoken, view.memo)
        # The search imagines a scripted world, in which a block on foot takes one tick.
        ticks = view.ticks_left // view.brief.pace
        search = view.agent, self.order, ticks, self.bounds
        # What has just failed in the same way would fail again.
        avoided = view.last.program.splitlines()[:1] if view.last.has_failed else ()
        plan = planner.planning(*search).best(mind, avoided=avoided)
        if not plan.calls and self.order and _has_waited_in_vain(view):
            plan = planner.planning(*search).best(mind, idle=True)
        view.note_considered(_trace(plan, planner.tried))
        return program_of(plan.calls)


def _trace(plan: FoundPlan, tried: int) -> SearchTrace:
    """Return the record of a search: the best courses, and the one of doing nothing."""
    ranked = sorted(plan.considered, key=lambda each: each[1])
    kept = ranked[:_MOST_COURSES]
    kept += [each for each in ranked[_MOST_COURSES:] if not each[0]]
    return SearchTrace(
        tuple(
            TriedCourse(program_of(calls), _OUTCOMES[score[0]], tuple(score))
            for calls, score in kept
        ),
        {name: program_of(calls) for name, calls in plan.others.items()},
        tried,
        plan.reason,
    )


def _has_waited_in_vain(view: AgentView) -> bool:
    """Return True if an agent let others act in its last round, and perceived no act of theirs.

    Agents that each leave the same task to the others would otherwise wait for one another.
    """
    since = view.tick - view.brief.whole_round
    return (
        bool(view.before)
        and not any(view.before[-1:])
        and not any(event.tick > since and event.actor != view.agent for event in view.state.events)
    )


class Omniscient(msgspec.Struct, frozen=True):
    """Policy that plans in reality and knows the true beliefs of others: an upper bound.

    Attributes:
        order: Order of Theory of Mind.
        bounds: Bounds of the search.
    """

    order: int = 2
    bounds: SearchBounds = USUAL
    sees_all: bool = True

    def act(self, view: AgentView) -> str:
        """Return the calls of its plan, as a program."""
        return Search(self.order, self.bounds).act(view)
