"""Policy `infer:ORDER`: infer goals of others from their actions, claims and traces.

Inverse planning (`Simulator.infer`) explains actions in the agent's belief about the other's
belief; of order 0 in the agent's own belief. A goal that the planner cannot express, such as one
about beliefs or another agent's items, keeps its prior probability.

A trace is a block, or contents, that the agent finds changed without having perceived the change.
If there is one, the agent imagines what the others did since the beginning, once for each
combination of their possible goals, with the planner of `search`. Goals that would have left the
world as the agent found it are more probable (Jara-Ettinger and Schachner 2024).
"""

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass

import msgspec
import numpy as np

from beliefnest.belief.grounds import ContainerBelief, Source
from beliefnest.belief.node_view import NodeView
from beliefnest.belief.view import State
from beliefnest.episodes.agent_view import AgentView
from beliefnest.episodes.imagination import Imagination, Performer
from beliefnest.episodes.policies.course_planner import USUAL, Planner, SearchBounds
from beliefnest.episodes.policies.expecting import Expecting, GoalShares, combinations, uniform
from beliefnest.episodes.policies.search import Search
from beliefnest.errors import InputError, TooLargeError
from beliefnest.facts.kinds import Pursuit
from beliefnest.geometry.free_lines import can_use, eye_in
from beliefnest.minds.mind_model import MindModel
from beliefnest.minds.ways import Floor
from beliefnest.scenarios.goals import Goal
from beliefnest.world.claims import ClaimKind
from beliefnest.world.event_kinds import EventKind
from beliefnest.world.registry import Registry
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import Items, Position
from beliefnest.worlds.scripted.footpaths import InReach
from beliefnest.worlds.scripted.hand import REACH

_WORTH = 100.0
"""Utility of a goal, in steps."""

_HONEST = 0.9
"""Probability that a claim is true if the speaker's goal fits the hearer's, false if it does not.
"""

_WANTED = 0.9
"""Probability that an item which an agent is seen to take is part of its goal.

The planner reaches one cell far and hands four, so that a taking may have no place in its course.
"""

_RATIONALITY = 1.0


@dataclass(frozen=True)
class Infer:
    """Policy that plans by trying, and infers the goals of others from actions and claims.

    Attributes:
        order: Order of Theory of Mind.
        bounds: Limits of the planner.
    """

    order: int
    bounds: SearchBounds = USUAL

    def act(self, view: AgentView) -> str:
        """Return the calls of the course with the best expected outcome, as a program."""
        if not view.brief.hides_goals:
            return Search(self.order, self.bounds).act(view)
        shares = posterior(view, self.order, self.bounds)
        # Only an agent in sight can show its goal in the next round.
        learns = any(view.state.agents[name].current for name in shares)
        return Expecting(view, self.order, self.bounds).program(shares, learns=learns)


def posterior(view: AgentView, order: int, bounds: SearchBounds = USUAL) -> GoalShares:
    """Return the probabilities of the others' possible goals, given the agent's percepts.

    Args:
        view: View of the agent.
        order: Order of Theory of Mind; 0: others are assumed to share the agent's belief.
        bounds: Limits of the planner that explains traces.
    """
    start = view.imagine(order, tick=0)
    shares_of = {}
    for other, prior in uniform(view.brief).items():
        goals = view.brief.possible_goals[other]
        first = start.view((other,) if order else ())
        weights = dict(_by_deeds(view, order, other, goals, prior, first))
        for is_true in _judged_claims(view, other):
            for name, goal in goals.items():
                supposed = view.brief.supposing({other: goal}).goals
                is_opposed = supposed[other].differs(supposed[view.agent])
                weights[name] *= _HONEST if is_true != is_opposed else 1 - _HONEST
        for item in _taken(view.state, other):
            for name, goal in goals.items():
                is_wanted = any(item in one.fact.items for one in goal.reach)
                weights[name] *= _WANTED if is_wanted else 1 - _WANTED
        total = sum(weights.values())
        shares_of[other] = {name: weight / total for name, weight in weights.items()}
    return _by_traces(view, start, order, bounds, shares_of)


def _by_traces(
    view: AgentView, start: Imagination, order: int, bounds: SearchBounds, prior: GoalShares
) -> GoalShares:
    """Update the probabilities of goals by the traces that the others left."""
    combined = list(combinations(prior))
    likely = likelihoods_of_traces(view, start, order, bounds, [goals for _, goals in combined])
    weights = [share * each for (share, _), each in zip(combined, likely, strict=True)]
    total = math.fsum(weights)
    return {
        other: {
            name: math.fsum(
                weight
                for weight, (_, chosen) in zip(weights, combined, strict=True)
                if chosen[other] == name
            )
            / total
            for name in goals
        }
        for other, goals in prior.items()
    }


def goals_of_planner(
    goal: Goal, agent: str, state: State, first: State | NodeView
) -> list[Mapping[str, object]]:
    """Return the parts of a goal that the planner of `MindModel` can pursue; empty: none.

    Args:
        goal: Possible goal of the agent.
        agent: The agent.
        state: Its assumed belief.
        first: Its assumed belief in the beginning, before it took anything.
    """
    mine = first.agents[agent].inventory
    return [
        each
        for one in goal.reach
        if not one.path
        for each in _pursued(one.fact.pursuit(agent, mine), state, first)
    ]


def _pursued(
    pursuit: Pursuit, state: State, first: State | NodeView
) -> Iterator[Mapping[str, object]]:
    near = {at for place in pursuit.near for at in _in_reach(place, state)}
    yield from ({"at": at} for at in (*pursuit.at, *sorted(near)))
    for item in pursuit.items:
        if _is_somewhere(item, first) or _is_somewhere(item, state):
            yield {"item": item}


def _is_missed(item: str, state: State) -> bool:
    is_carried = any(agent.inventory.get(item, 0) for agent in state.agents.values())
    return not is_carried and not _is_somewhere(item, state)


def _is_somewhere(item: str, state: State | NodeView) -> bool:
    dropped = any(each.name == item for each in state.items.values())
    return dropped or any(content.items.get(item, 0) for content in state.containers.values())


def _in_reach(place: Position, state: State) -> list[Position]:
    """Return cells on the level of a block from which it is in reach."""
    x, y, z = place
    span = range(-math.ceil(REACH), math.ceil(REACH) + 1)
    met, box, blocks = InReach(place, REACH, beside=True), state.box, state.blocks.terrain
    around = [(x + dx, y, z + dz) for dx in span for dz in span]
    near = [at for at in around if at in box and met.is_met(at)]
    cells = np.array([box.index(at) for at in near], dtype=np.int64).reshape(-1, 3)
    stands = Floor(Registry.load(), blocks).stands(cells)
    standable = [at for at, is_standing in zip(near, stands, strict=True) if is_standing]
    return [at for at in standable if can_use(box, blocks, eye_in(at), place)]


def _by_deeds(
    view: AgentView,
    order: int,
    other: str,
    goals: Mapping[str, Goal],
    prior: Mapping[str, float],
    first: NodeView,
) -> Mapping[str, float]:
    """Return the posterior given another agent's course; the prior if that is no evidence."""
    below = (other,) if order else ()
    state = view.about(*below)
    pursued = {name: goals_of_planner(goal, other, state, first) for name, goal in goals.items()}

    # If the agent misses an item, the other may have taken it unseen and carried it on. The planner
    # cannot explain the rest of this course, because its course ends when the item is taken.
    def is_judged(wants: list[Mapping[str, object]]) -> bool:
        items = [str(each["item"]) for each in wants if "item" in each]
        return bool(wants) and not any(_is_missed(item, view.state) for item in items)

    expressed = [name for name in goals if is_judged(pursued[name])]
    if len(expressed) < 2 or state.agents[other].position is None:
        return prior
    wanted: dict[str, Mapping[str, object]] = {}
    for name in expressed:
        wanted |= {repr(each): each for each in pursued[name]}
    rows = [
        {key: _WORTH if each in pursued[name] else 0.0 for key, each in wanted.items()}
        for name in expressed
    ]
    weights = [[prior[name]] for name in expressed]
    model = MindModel(
        other, wanted, rows, prior=weights, rationality=_RATIONALITY, diagonal=True, stays=False
    )
    try:
        shares_by_goal = view.infer(model, *below).posterior()
    except TooLargeError:
        raise
    except InputError:
        # It cannot reach any of the goals, so its course is no evidence.
        return prior
    shares = shares_by_goal.sum(axis=(0, 1, 3))
    expressible = sum(prior[name] for name in expressed)
    inferred = dict(zip(expressed, (shares / shares.sum() * expressible).tolist(), strict=True))
    return {name: inferred.get(name, share) for name, share in prior.items()}


def _taken(state: State, agent: str) -> list[str]:
    """Return the items that an agent was seen to take, sorted."""
    takings = (
        event.detail["items"]
        for event in state.events
        if event.actor == agent and event.kind is EventKind.GET_ITEM_FROM_CHEST
    )
    return sorted({item for items in takings for item in items})


def _judged_claims(view: AgentView, speaker: str) -> Iterator[bool]:
    """Yield True or False for each claim of a speaker that proved true or false."""
    for tick, who, claim in view.claims:
        if who == speaker and claim.kind in (ClaimKind.LOCATED, ClaimKind.ABSENT):
            was_there = _was_in(view.state, str(claim.item), claim.cell, tick)
            if was_there is not None:
                yield was_there == (claim.kind is ClaimKind.LOCATED)


def _was_in(state: State, item: str, place: Position, tick: int) -> bool | None:
    """Return True if an item was in a container at a tick; None: nobody has looked since."""
    for event in state.events:
        if event.tick <= tick or event.detail.get("position") != place:
            continue
        if item in event.detail.get("items", {}):
            return event.kind is EventKind.GET_ITEM_FROM_CHEST
    content = state.containers.get(place)
    if content is None or not content.complete or content.basis.source is Source.HEARD:
        return None
    return bool(content.items.get(item, 0))


_MISTAKEN = 0.1
"""Probability of a difference between a found block or content and the true course."""

_PERCEIVED = (Source.SEEN, Source.WITNESSED)


class _Moment(msgspec.Struct, frozen=True):
    """World from a tick on."""

    tick: int
    blocks: Terrain
    containers: Mapping[Position, Items]


def likelihoods_of_traces(
    view: AgentView,
    start: Imagination,
    order: int,
    bounds: SearchBounds,
    supposed: Sequence[Mapping[str, str]],
) -> list[float]:
    """Return the likelihood of the found world for combinations of goals; 1 without a trace.

    Args:
        view: View of the agent.
        start: Belief of the agent in the beginning.
        order: Order of Theory of Mind; 0: others are assumed to share the agent's belief.
        bounds: Limits of the planner.
        supposed: Names of the goals of other agents, by agent.
    """
    traces = _Found(view.state, start)
    places = traces.changed(traces.now)
    if not traces.mismatches([traces.first], places):
        return [1.0] * len(supposed)
    courses = [_course(view, start, order, bounds, goals) for goals in supposed]
    places |= {place for course in courses for each in course for place in traces.changed(each)}
    odds = _MISTAKEN / (1 - _MISTAKEN)
    return [odds ** traces.mismatches(course, places) for course in courses]


class _Found:
    """Blocks and contents as an agent found them.

    Args:
        state: Present belief of the agent.
        start: Its belief at the start.

    Attributes:
        first: World of its belief at the start.
        now: World of its present belief.
    """

    def __init__(self, state: State, start: Imagination) -> None:
        self._state, first_view = state, start.view()
        self._known = first_view.containers
        self.first = _Moment(start.tick, first_view.terrain, _items(first_view.containers))
        self.now = _Moment(state.tick, state.blocks.terrain, _items(state.containers))
        self._watched = {
            event.detail.get("position")
            for event in state.events
            if event.kind.traits.stores != 0  # To look into a container changes nothing.
        }

    def changed(self, moment: _Moment) -> set[Position]:
        """Return the places at which a moment differs from the agent's first belief."""
        first, (x, y, z) = self.first.blocks, self._state.box.low
        differ = first.differing(moment.blocks, lambda there, _: there >= 0)
        blocks = {
            (x + i, y + j, z + k)
            for i, j, k in differ.tolist()
            # The upper half of a door moves with the lower one.
            if _half(first[i, j, k]) != "upper"
        }
        there = moment.containers
        return blocks | {
            at for at, items in self.first.containers.items() if there.get(at) != items
        }

    def mismatches(self, course: Sequence[_Moment], places: Collection[Position]) -> int:
        """Return the number of blocks and contents that differ from a course."""
        return sum(
            self._block_differs(course, place) + self._content_differs(course, place)
            for place in places
            if place not in self._watched
        )

    def _block_differs(self, course: Sequence[_Moment], place: Position) -> bool:
        basis, index = self._state.blocks.basis(place), self._state.box.index(place)
        if basis is None or basis.source not in _PERCEIVED or self.first.blocks[index] < 0:
            return False
        then = _at(course, basis.observed_at).blocks[index]
        return then != self.now.blocks[index]

    def _content_differs(self, course: Sequence[_Moment], place: Position) -> bool:
        now, before = self._state.containers.get(place), self._known.get(place)
        if now is None or before is None or not now.complete:
            return False
        if now.basis.source not in _PERCEIVED:
            return False
        then = _at(course, now.basis.observed_at).containers.get(place, {})
        # For a container with unknown contents, count only known items and known changes.
        names = now.items.keys() | then.keys() if before.complete else before.items.keys() | then
        return any(now.items.get(name, 0) != then.get(name, 0) for name in names)


def _course(
    view: AgentView,
    start: Imagination,
    order: int,
    bounds: SearchBounds,
    supposed: Mapping[str, str],
) -> list[_Moment]:
    """Return the course of the others from the start until now, given their goals."""
    possible = view.brief.possible_goals
    brief = view.brief.supposing({name: possible[name][goal] for name, goal in supposed.items()})
    planner, ticks = Planner(brief), (view.tick - start.tick) // brief.pace
    performers = {}
    for name in sorted(supposed):
        mind = start.below(name, order - 1) if order else start
        plan = planner.planning(name, max(0, order - 1), ticks, bounds.lower()).best(mind)
        performers[name] = Performer(plan.calls)
    mind, course = start.fork(), [_moment(start, start.tick)]

    def note() -> bool:
        tick = start.tick + (mind.tick - start.tick) * brief.pace
        moment = _moment(mind, tick)
        if moment.blocks is not course[-1].blocks or moment.containers != course[-1].containers:
            course.append(moment)
        return False

    mind.play(performers, ticks, note)
    note()
    return course


def _moment(mind: Imagination, tick: int) -> _Moment:
    contents = {place: dict(items) for place, items in mind.world.containers.items()}
    return _Moment(tick, mind.world.terrain, contents)


def _at(course: Sequence[_Moment], tick: int) -> _Moment:
    """Return the world of a course at a tick."""
    return next(each for each in reversed(course) if each.tick <= max(tick, course[0].tick))


def _items(containers: Mapping[Position, ContainerBelief]) -> dict[Position, Items]:
    return {place: content.items for place, content in containers.items()}


def _half(state: int) -> str:
    return Registry.load().properties(state).get("half", "")
