"""Inference of other agents' goals from traces of unseen actions.

A trace is a block, or contents, that the agent finds changed without having perceived the change.
If there is one, the agent imagines what the others did since the beginning, once for each
combination of their possible goals, with the planner of `search`. Goals that would have left the
world as the agent found it are more probable (Jara-Ettinger and Schachner 2024).
"""

from collections.abc import Collection, Mapping, Sequence

import msgspec

from beliefnest.belief.grounds import ContainerBelief, Source
from beliefnest.belief.view import State
from beliefnest.episodes.agent_view import AgentView
from beliefnest.episodes.imagination import Imagination, Performer
from beliefnest.episodes.policies.course_planner import Planner, SearchBounds
from beliefnest.world.registry import Registry
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import Items, Position

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
