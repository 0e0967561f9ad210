"""Tracking of an episode's goals, tick by tick."""

from collections.abc import Mapping, Sequence

from beliefnest.belief.view import State
from beliefnest.episodes.task import Task
from beliefnest.facts.states import StateFacts
from beliefnest.nest.face.nest import Nest
from beliefnest.nest.past.over_time import TickWalk
from beliefnest.scenarios.goals import Progress
from beliefnest.timeline.journal import Edit, Entry
from beliefnest.world.event_kinds import EventKind
from beliefnest.world.paths import BeliefPath, path_text
from beliefnest.world.values import Items, Point


class Watch:
    """Tracker of a task's goals on one branch.

    Args:
        task: Task; its own goal has the name "", goals of agents have the names of the agents.
        start: Tick at which the first round begins.

    Attributes:
        paths: Paths of the simulators that the goals are about.
    """

    def __init__(self, task: Task, start: int) -> None:
        self._start = start
        self._seen = start - 1
        self._walk = TickWalk()
        self._players = task.players
        goals = {"": task.goal, **{agent: task.goal_of(agent) for agent in task.agents}}
        # Equal goals have one progress: in most tasks, those of all agents.
        self._distinct: list[Progress] = []
        for goal in goals.values():
            if all(each.goal != goal for each in self._distinct):
                self._distinct.append(Progress(goal, start))
        self.progress: Mapping[str, Progress] = {
            name: next(each for each in self._distinct if each.goal == goal)
            for name, goal in goals.items()
        }
        named = {path for goal in goals.values() for path in goal.paths}
        self._limits_messages = any(goal.messages is not None for goal in goals.values())
        self.paths: Sequence[BeliefPath] = sorted({(), *named})
        # Results of the last test, the agents whose places it read, and all agents' items now.
        self._met: Sequence[Sequence[bool]] = ()
        self._places: set[str] = set()
        self._items: dict[str, Items | None] = {}

    def up_to_now(self, nest: Nest) -> Mapping[str, Progress]:
        """Return the progress of all goals up to the nest's tick."""
        if self._seen < nest.tick:
            if self._seen < self._start:
                past = nest.at(self._start)
                self._test({path: past[path_text(path)].state for path in self.paths})
                self._feed(self._start)
                self._seen = self._start
            for entry, states in nest.each_entry(self.paths, self._seen, nest.tick, self._walk):
                if self._matters(entry):
                    self._test(states())
                self._feed(entry.tick, self._said(entry))
            self._seen = nest.tick
            for each in self._distinct:
                each.end_tick(nest.tick)
        return self.progress

    def _matters(self, entry: Entry) -> bool:
        """Return True if conditions may hold differently after an entry.

        Most entries are steps of agents, and most conditions are about things.
        """
        if isinstance(entry, Edit):
            return len(self.paths) > 1 or bool(entry.blocks or entry.containers)
        agents = entry.agents.items()
        items = {name: None if state is None else state.inventory for name, state in agents}
        took = any(self._items.get(name) != each for name, each in items.items())
        self._items.update(items)
        return (
            len(self.paths) > 1
            or took
            or bool(entry.blocks or entry.containers or entry.items)
            or not self._places.isdisjoint(entry.agents)
            or any("text" in event.detail for event in entry.events)
        )

    def _test(self, states: Mapping[BeliefPath, State]) -> None:
        self._places.clear()
        facts = {path: _Read(state, self._places) for path, state in states.items()}
        self._met = [each.goal.met(facts.__getitem__) for each in self._distinct]

    def _said(self, entry: Entry) -> int:
        """Return the number of utterances of players in an entry, if a goal limits it."""
        if not self._limits_messages or isinstance(entry, Edit):
            return 0
        said = (event.actor for event in entry.events if event.kind is EventKind.CHAT)
        return sum(speaker in self._players for speaker in said)

    def _feed(self, tick: int, said: int = 0) -> None:
        for each, met in zip(self._distinct, self._met, strict=True):
            each.feed(tick, met, said)


class _Read(StateFacts):
    """Facts of a state that note whose places were read."""

    def __init__(self, state: State, places: set[str]) -> None:
        super().__init__(state)
        self._places = places

    def feet_of(self, agent: str) -> Point | None:
        self._places.add(agent)
        return super().feet_of(agent)
