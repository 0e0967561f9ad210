"""Planner without a language model, of any order of Theory of Mind.

The planner is a beam search over sequences of skill calls, tried on forks of the agent's own
belief.

At order 0 it assumes that no other agent acts, and believes what it is told. At order k it assumes
that the others act as planners of order k - 1 in the beliefs that the agent attributes to them. It
takes statements about containers by agents with a different goal for lies. It evaluates conditions
on beliefs down to k levels below its own belief.
"""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field

import msgspec

from beliefnest.episodes.agent_view import Brief
from beliefnest.episodes.imagination import Imagination, Performer
from beliefnest.episodes.policies.candidates import (
    calls_of,
    claims_of_mind,
    is_news,
    items_of,
    said,
)
from beliefnest.episodes.policies.distance import distance, held, is_visible
from beliefnest.scenarios.goals import Goal
from beliefnest.skills.calls import Call
from beliefnest.world.doors import is_door
from beliefnest.world.event_kinds import EventKind
from beliefnest.world.registry import parse_state
from beliefnest.world.values import Event, Position

CourseScore = tuple[float, ...]
"""Score of a plan, compared from left to right; less is better."""

REACHED, OPEN, VIOLATED = 0.0, 1.0, 2.0
"""First part of a score; the second is a tick, a distance, and minus a tick."""


_FEW = 3
"""Greatest number of other agents for which each may replan as often as the bounds say."""
_MOST_CHANGES = 3
"""Greatest number of replans within a plan, of all other agents together, if there are more."""


class SearchBounds(msgspec.Struct, frozen=True):
    """Bounds of the search.

    Attributes:
        beam: Number of plans that are extended at each depth.
        depth: Greatest number of calls in a plan.
        horizon: Greatest number of imagined ticks.
        changes: Greatest number of times that another agent replans within a plan.
    """

    beam: int = 3
    depth: int = 3
    horizon: int = 160
    changes: int = 3

    def lower(self) -> "SearchBounds":
        """Return the smaller bounds for the imagined planners of other agents."""
        return SearchBounds(
            max(1, self.beam - 1), self.depth, self.horizon, max(1, self.changes - 1)
        )


USUAL = SearchBounds()
"""Bounds of policies that are named on the command line."""


class FoundPlan(msgspec.Struct, frozen=True):
    """Result of planning.

    Attributes:
        calls: Calls in order.
        score: Score of the plan.
        considered: All courses that were tried, with their scores.
        others: Calls that the planner assumed of the other agents, by name.
        reason: Reason for calls that are none of the courses; empty: they are the best course.
    """

    calls: tuple[Call, ...]
    score: CourseScore
    considered: Sequence[tuple[tuple[Call, ...], CourseScore]] = ()
    others: Mapping[str, tuple[Call, ...]] = msgspec.field(default_factory=dict)
    reason: str = ""


@dataclass
class _Course:
    """Assumed plan of another agent.

    Attributes:
        performer: Performer of its calls.
        read: Number of events that the agent had perceived when it decided on the calls.
        changes: Number of times that it may still replan.
    """

    performer: Performer
    read: int
    changes: int

    def again(self) -> "_Course":
        return _Course(self.performer.again(), self.read, self.changes)


@dataclass
class _Node:
    """Node of the search: a sequence of calls and the state after it.

    Attributes:
        mind: Imagined state after the calls.
        others: Assumed plans of the other agents at that time.
        elapsed: Ticks since the beginning.
        calls: The calls.
        reached: Tick at which the goal was reached; None: it was not.
        violated: Tick at which the goal was violated; None: it was not.
        changes: Number of times that others together may still replan; None: as often as each may.
    """

    mind: Imagination
    others: dict[str, _Course]
    elapsed: int = 0
    calls: tuple[Call, ...] = ()
    reached: int | None = None
    violated: int | None = None
    changes: int | None = None
    score: CourseScore = field(default=())

    def fork(self) -> "_Node":
        return _Node(
            self.mind.fork(),
            {name: each.again() for name, each in self.others.items()},
            self.elapsed,
            self.calls,
            self.reached,
            self.violated,
            self.changes,
        )


class Planner:
    """Planner for agents of one task.

    Args:
        brief: Common knowledge about the task.
        spoken: Texts that were said so far, by speaker.
        guesses: Cache of the assumed plans of other agents, shared with planners of the same brief;
            None: it has its own.

    Attributes:
        tried: Number of branches tried so far.
        guesses: Cache of the assumed plans of other agents, by their assumed beliefs.
    """

    def __init__(
        self,
        brief: Brief,
        spoken: Mapping[str, Collection[str]] | None = None,
        guesses: dict[object, tuple[Call, ...]] | None = None,
    ) -> None:
        self._brief = brief
        self.spoken = spoken or {}
        self.tried = 0
        self.guesses = {} if guesses is None else guesses

    def planning(self, agent: str, order: int, ticks: int, bounds: SearchBounds) -> "Planning":
        """Return a run of the search.

        Args:
            agent: Name of the planning agent.
            order: Order of Theory of Mind of the agent.
            ticks: Number of ticks left.
            bounds: Bounds of the search.
        """
        horizon = min(ticks, bounds.horizon)
        return Planning(self, self._brief, agent, order, horizon, bounds)


class Planning:
    """One run of the search, see `Planner.planning`."""

    def __init__(
        self,
        planner: Planner,
        brief: Brief,
        agent: str,
        order: int,
        horizon: int,
        bounds: SearchBounds,
    ) -> None:
        self._planner, self._brief = planner, brief
        self._agent, self._order = agent, order
        self._horizon, self._bounds = horizon, bounds
        self._round = max(1, brief.round_ticks // brief.pace)
        self._goal: Goal = brief.goals[agent]
        self._opponents = [n for n, goal in brief.goals.items() if goal.differs(self._goal)]
        self._speaks = agent in brief.talk and order > 0
        self._doubted: frozenset[Position] = frozenset()
        self._avoided: Collection[str] = ()
        conditions = [each for goal in brief.goals.values() for each in goal.conditions]
        self._holders = {each.fact.holder for each in conditions}

    def best(
        self,
        mind: Imagination,
        before: Sequence[Call] | None = None,
        *,
        idle: bool = False,
        avoided: Collection[str] = (),
    ) -> FoundPlan:
        """Return the best plan found; of equal plans, the first and shortest.

        Args:
            mind: Belief of the agent; it is not changed.
            before: Calls of another course that the agent has begun, which it goes on with for a
                round first; None: the plan begins at once.
            idle: True if the others do nothing until they perceive something new.
            avoided: Programs of calls that the plan does not begin with.
        """
        self._avoided = avoided
        mind, first = self._begun(mind, idle=idle)
        if before is not None:
            self._spend_round(first, before)
        self._value(first)
        best, beam, tried = first, [first], [first]
        for _ in range(self._bounds.depth):
            if best.score[0] == REACHED and not best.calls and not best.others:
                break
            nodes = [each for node in beam for each in self._expanded(node)]
            nodes.sort(key=lambda node: node.score)
            tried += nodes
            beam = nodes[: self._bounds.beam]
            if not beam:
                break
            if beam[0].score < best.score:
                best = beam[0]
        calls, reason = best.calls, ""
        if best.score[0] == OPEN:
            if news := self._telling(mind):
                calls, reason = (news,), "somebody does not know this, and may plan better with it"
            elif not calls and (look := self._exploring(mind)):
                calls, reason = look, "a wanted item may be there"
        others = {name: tuple(each.performer.calls) for name, each in first.others.items()}
        considered = [(node.calls, node.score) for node in tried]
        return FoundPlan(calls, best.score, considered, others, reason)

    def outcome(self, mind: Imagination, calls: Sequence[Call]) -> CourseScore:
        """Return the score of a course, which ends with the first call that cannot be done."""
        _, node = self._begun(mind)
        for call in calls:
            if node.reached is not None or node.violated is not None:
                break
            mine = Performer([call])
            self._act(node, mine)
            if mine.failed:
                break
            node.calls = (*node.calls, call)
        self._value(node)
        return node.score

    def _begun(self, mind: Imagination, *, idle: bool = False) -> tuple[Imagination, _Node]:
        """Return the world that the agent believes in, and the course without actions."""
        if self._order and self._opponents:
            # A planner of order 1 or more does not believe what its opponents claim.
            mind, self._doubted = mind.doubting(self._opponents)
        first = _Node(mind.fork() if self._order else mind.bare(), {})
        first.others = {
            name: _Course(
                Performer(() if idle else self._guess(mind, name, 0)), 0, self._bounds.changes
            )
            for name in self._imagined(mind)
        }
        if len(first.others) > _FEW:
            first.changes = _MOST_CHANGES
        if self._is_reached(first.mind):
            first.reached = 0
        return mind, first

    def _spend_round(self, node: _Node, calls: Sequence[Call]) -> None:
        """Let a round pass in which the agent begins a course; a call that fails ends it."""
        end = min(self._horizon, node.elapsed + self._round)
        left = list(calls)
        while node.elapsed < end and node.reached is None and node.violated is None:
            mine = Performer([left.pop(0)]) if left else None
            while node.elapsed < end and not (mine is not None and mine.is_done):
                if not self._pass(node, mine):
                    break
            if mine is None:
                node.mind.world.step(end - node.elapsed)
                node.elapsed = end
            elif mine.failed:
                left.clear()

    def _imagined(self, mind: Imagination) -> list[str]:
        """Return the other agents whose acts the search simulates."""
        if self._order == 0:
            return []
        return [name for name in sorted(mind.world.agents) if name != self._agent]

    def _guess(self, mind: Imagination, other: str, elapsed: int) -> tuple[Call, ...]:
        """Return the assumed plan of another agent, planned in its assumed belief."""
        order, left = self._order - 1, self._horizon - elapsed
        guesses, seen = self._planner.guesses, mind.print_of(other, order)
        # Planners of order 0 do not speak.
        spoken = tuple(sorted(self._planner.spoken.items())) if order else ()
        key = (other, order, left, self._bounds, seen, spoken)
        if seen is None or key not in guesses:
            below = mind.below(other, order)
            plan = self._planner.planning(other, order, left, self._bounds.lower()).best(below)
            guesses[key] = plan.calls
        return guesses[key]

    def _expanded(self, node: _Node) -> list[_Node]:
        """Return the successors of a node: one for each call that can be done next."""
        if node.reached is not None or node.violated is not None or node.elapsed >= self._horizon:
            return []
        nodes = []
        for call in self._calls(node.mind):
            if not node.calls and call.program in self._avoided:
                continue
            following = node.fork()
            mine = Performer([call])
            self._act(following, mine)
            if mine.failed:
                continue
            following.calls = (*node.calls, call)
            self._value(following)
            nodes.append(following)
        return nodes

    def _calls(self, mind: Imagination) -> list[Call]:
        goals = list(self._brief.goals.values())
        calls = calls_of(mind, self._agent, [self._goal])
        if self._speaks:
            claims = claims_of_mind(mind, goals, lies=bool(self._opponents))
            calls += [said(claim) for claim in claims if is_news(mind, claim, self._agent)]
        return calls

    def _act(self, node: _Node, mine: Performer) -> None:
        """Let all agents act until the planning agent has done its calls."""
        while not mine.is_done and node.elapsed < self._horizon:
            if not self._pass(node, mine):
                break

    def _value(self, node: _Node) -> None:
        """Score a node by its state after the others act on and the agent does nothing more."""
        self._planner.tried += 1
        end = node
        if node.others and node.reached is None and node.violated is None:
            end = node.fork()
            while end.elapsed < self._horizon and end.reached is None and end.violated is None:
                if not self._pass(end, None):
                    break
        node.score = self._score(end)

    def _score(self, end: _Node) -> CourseScore:
        messages = sum(call.skill in ("say", "whisper") for call in end.calls)
        cost = 2.0 * messages + 0.5 * len(end.calls)
        if end.violated is not None:
            return (VIOLATED, -end.violated, cost)
        if end.reached is not None:
            return (REACHED, end.reached + cost)
        if not self._goal.reach:
            return (REACHED, cost)
        return (OPEN, round(distance(self._goal, end.mind), 6), cost)

    def _pass(self, node: _Node, mine: Performer | None) -> bool:
        """Let time pass, at most to the end of a round; return False if nobody may act."""
        passed = node.elapsed % self._round
        if not passed:
            self._change_minds(node)
        performers = {name: each.performer for name, each in node.others.items()}
        if mine is not None:
            performers[self._agent] = mine
        performers = dict(sorted(performers.items()))
        ticks = min(self._round - passed, self._horizon - node.elapsed)
        if all(each.is_done for each in performers.values()):
            if not passed or not any(self._may_change(node, name) for name in node.others):
                return False
            # The others decide again when the next round begins.
            node.mind.world.step(ticks)
            node.elapsed += ticks
            return True

        def ends() -> bool:
            over = all(each.is_done for each in performers.values())
            return over or (mine is not None and mine.is_done)

        node.elapsed += node.mind.play(performers, ticks, ends)
        self._judge(node)
        return True

    def _judge(self, node: _Node) -> None:
        mind, goal = node.mind, self._goal
        if node.violated is None and any(
            is_visible(each, mind) and held(each, mind) for each in goal.never
        ):
            node.violated = node.elapsed
        if node.reached is None and node.violated is None and self._is_reached(mind):
            node.reached = node.elapsed

    def _is_reached(self, mind: Imagination) -> bool:
        """Return True if there is something to reach and all of it holds, as far as visible."""
        reach = self._goal.reach
        return bool(reach) and all(is_visible(each, mind) and held(each, mind) for each in reach)

    def _change_minds(self, node: _Node) -> None:
        """Let those other agents replan that are done or may have perceived something new."""
        named = self._holders
        for name in sorted(node.others, key=lambda name: (name not in named, name)):
            course = node.others[name]
            if node.changes == 0 or not self._may_change(node, name):
                continue
            course.read = len(node.mind.happened)
            calls = self._guess(node.mind, name, node.elapsed)
            if node.changes is not None:
                node.changes -= 1
            if calls != tuple(course.performer.calls):
                course.performer = Performer(calls)
                course.changes -= 1

    def _may_change(self, node: _Node, name: str) -> bool:
        course = node.others[name]
        if node.changes == 0:
            return False
        since = node.mind.happened[course.read :]
        news = any(event.actor != name and _is_notable(event) for _, event in since)
        done = course.performer.is_done and bool(since)
        return course.changes > 0 and (news or done or course.performer.failed)

    def _exploring(self, mind: Imagination) -> tuple[Call, ...]:
        """Return a look into the nearest container that may hold a wanted item of unknown place."""
        world = mind.world
        me = world.agents.get(self._agent)
        contents = mind.view().containers
        wanted = [
            item
            for item in items_of([self._goal])
            if not any(
                content.items.get(item, 0)
                for place, content in contents.items()
                if place not in self._doubted
            )
            and not any(each.inventory.get(item, 0) for each in world.agents.values())
        ]
        if me is None or not wanted:
            return ()
        unknown = [
            place
            for place, content in contents.items()
            if not content.complete and place not in self._doubted
        ]
        for place in sorted(unknown, key=lambda at: (_apart(me.position, at), at)):
            calls = (Call("goToPosition", (place, 2)), Call("openContainer", (place,)))
            if self._succeeds(mind, calls):
                return calls
        return ()

    def _telling(self, mind: Imagination) -> Call | None:
        """Return something true that agents with the same goal do not know; None: there is nothing.

        It is told if no course reaches the goal with the other agents as this one imagines them.
        An agent that learns where things are, even one whose place is unknown, may plan better.
        """
        most = self._goal.messages
        if not self._speaks or self._opponents or most is not None:
            return None
        before = self._planner.spoken.get(self._agent, ())
        hearers = [name for name in self._brief.agents if name != self._agent]
        for claim in claims_of_mind(mind, list(self._brief.goals.values()), lies=False):
            call = said(claim)
            if call.args[0] not in before and is_news(mind, claim, self._agent, hearers):
                return call
        return None

    def _succeeds(self, mind: Imagination, calls: Sequence[Call]) -> bool:
        """Return True if the agent, left alone in a mind, can do the last one of some calls."""
        trial, mine = mind.bare(), Performer([*calls])
        trial.play({self._agent: mine}, self._horizon, lambda: mine.is_done)
        return not mine.failed


def _is_notable(event: Event) -> bool:
    """Return True if others may decide anew because of an event."""
    if event.kind is EventKind.BLOCK_UPDATE:
        # Doors that are moved by hand have an event of their own.
        name, properties = parse_state(event.detail["block"])
        return is_door(name) and properties["powered"] == "true"
    return event.kind.is_public_deed


def _apart(feet: Sequence[float], place: Sequence[int]) -> float:
    return float(sum((a - b) ** 2 for a, b in zip(feet, place, strict=True)))
