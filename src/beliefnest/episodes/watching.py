"""Tracking of an episode's goals, tick by tick."""

from collections.abc import Mapping
from typing import Any

from beliefnest.belief.view import State
from beliefnest.episodes.task import Task
from beliefnest.facts.states import looking_at
from beliefnest.nest.face.nest import Nest
from beliefnest.nest.past.over_time import TickWalk
from beliefnest.scenarios.goals import Progress
from beliefnest.world.paths import BeliefPath, path_text


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
                self._distinct.append(Progress.begun(goal, start))
        self.progress: Mapping[str, Progress] = {
            name: next(each for each in self._distinct if each.goal == goal)
            for name, goal in goals.items()
        }
        named = {path for goal in goals.values() for path in goal.paths}
        self._limits_messages = any(goal.messages is not None for goal in goals.values())
        self.paths = sorted({"/", *map(path_text, named)})

    def up_to_now(self, nest: Nest) -> Mapping[str, Progress]:
        """Return the progress of all goals up to the nest's tick."""
        if self._seen < nest.tick:
            if self._seen < self._start:
                self._feed(self._start, nest.at(self._start))
                self._seen = self._start
            for tick, states in nest.each_tick(self.paths, self._seen, nest.tick, self._walk):
                self._feed(tick, states)
                del states  # what somebody holds is read before the next tick
            self._seen = nest.tick
        return self.progress

    def _feed(self, tick: int, states: Any) -> None:
        views: dict[BeliefPath, State] = {}
        for path in self.paths:
            view = states[path]
            views[tuple(name for name in path.split("/") if name)] = getattr(view, "state", view)
        look = looking_at(views)
        said = 0
        if tick != self._start and self._limits_messages:
            chat = views[()].chat
            said = sum(1 for when, who, _ in chat if when == tick and who in self._players)
        for each in self._distinct:
            each.feed(tick, look, said)
