"""Shares of a goal that several agents have: the conditions that each agent brought about."""

from collections.abc import Mapping, Sequence

import msgspec

from beliefnest.belief.grounds import PerceivedEvent
from beliefnest.scenarios.goals import Goal, Progress

_NEVER = float("inf")


class Share(msgspec.Struct, frozen=True):
    """Share of a goal: the conditions for which one agent is responsible.

    Attributes:
        reach: Numbers of conditions to reach.
        never: Numbers of conditions that must not come true; they follow those to reach.
    """

    reach: tuple[int, ...]
    never: tuple[int, ...]

    def done_at(self, progress: Progress) -> float:
        """Return the tick by which the whole share had come true; infinite: it never did.

        Args:
            progress: Progress of the agent's goal, in the episode or on a branch of it.
        """
        lost = _NEVER if progress.violated is None else progress.violated
        if any(number in progress.first for number in self.never):
            return _NEVER
        if not progress.goal.reach:
            return progress.start if lost == _NEVER else _NEVER
        came = [progress.first.get(number, _NEVER) for number in self.reach]
        done = max(came, default=progress.start)
        return done if done <= lost else _NEVER


def shares_of(
    progress: Mapping[str, Progress], events: Sequence[PerceivedEvent]
) -> dict[str, Share]:
    """Return each agent's share of its goal.

    A condition belongs to the share of the agents that have it in their goals and brought it about.
    If it did not come true, or another agent brought it about, it belongs to the shares of all
    agents that have it in their goals.

    Args:
        progress: Progress of each agent's goal in the episode.
        events: Events of the episode, in order.
    """
    goals = {agent: each.goal for agent, each in progress.items()}
    return {agent: _share(agent, goals, each.first, events) for agent, each in progress.items()}


def _share(
    agent: str,
    goals: Mapping[str, Goal],
    first: Mapping[int, int],
    events: Sequence[PerceivedEvent],
) -> Share:
    goal = goals[agent]
    reach = []
    for number, condition in enumerate(goal.reach):
        after_it = {name for name, other in goals.items() if condition in other.reach}
        tick = first.get(number, -1)
        did = condition.bringers([each for each in events if each.tick <= tick]) & after_it
        if agent in (did or after_it):
            reach.append(number)
    return Share(tuple(reach), tuple(range(len(goal.reach), len(goal.conditions))))
