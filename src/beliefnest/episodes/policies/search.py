"""Policies that plan without a language model: `search:ORDER` and its upper bound."""

from dataclasses import dataclass

from beliefnest.episodes.agent_view import AgentView
from beliefnest.episodes.policies.course_planner import USUAL, Bounds, Planner
from beliefnest.episodes.policies.expecting import Expecting, uniform
from beliefnest.skills.calls import program_of

__all__ = ["Omniscient", "Search"]


@dataclass(frozen=True)
class Search:
    """Policy that plans by search, with beliefs of others down to its order.

    Attributes:
        order: Order of Theory of Mind.
        bounds: Bounds of the search.
    """

    order: int
    bounds: Bounds = USUAL

    def act(self, view: AgentView) -> str:
        """Return the calls of its plan, as a program."""
        if view.brief.hides_goals:
            return Expecting(view, self.order, self.bounds).program(uniform(view.brief))
        mind = view.imagine(self.order)
        planner = Planner(view.brief)
        # The search imagines a scripted world, in which a block on foot takes one tick.
        ticks = view.ticks_left // view.brief.pace
        plan = planner.plan(mind, view.agent, self.order, ticks, self.bounds)
        return program_of(plan.calls)


@dataclass(frozen=True)
class Omniscient:
    """Policy that plans in reality and knows the true beliefs of others: an upper bound.

    Attributes:
        order: Order of Theory of Mind.
        bounds: Bounds of the search.
    """

    order: int = 2
    bounds: Bounds = USUAL
    sees_all: bool = True

    def act(self, view: AgentView) -> str:
        """Return the calls of its plan, as a program."""
        return Search(self.order, self.bounds).act(view)
