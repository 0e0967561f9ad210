"""Percepts and memories of an agent, tick by tick, for its program."""

from collections.abc import Callable

from beliefnest.belief.node_view import NodeView
from beliefnest.nest.past.embodiable import chest_places, with_chests_at
from beliefnest.nest.past.history import StateHistory
from beliefnest.timeline.journal import TimelineKey
from beliefnest.world.event_words import announced
from beliefnest.world.paths import BeliefPath
from beliefnest.world.terrain import Terrain
from beliefnest.worlds.protocol import Sensed


def believer_of(path: BeliefPath, agent: str) -> BeliefPath:
    """Return the node that an agent of a simulator reads.

    Inside its own belief an agent reads the simulator itself.
    """
    return path if path[-1:] == (agent,) else (*path, agent)


class Sensing:
    """`SenseSource` that reads an agent's belief from what has been recorded so far.

    Args:
        history: History that computes states.
        key: The timeline on which the agent acts.
        agent: Name of the agent.
        entries: Function that returns the number of entries of that timeline by now.
        since: Number of entries after which the first call announces events; None: it announces
            none.
    """

    def __init__(
        self,
        history: StateHistory,
        key: TimelineKey,
        agent: str,
        entries: Callable[[], int],
        since: int | None = None,
    ) -> None:
        self._history = history
        self._key = key
        self._agent = agent
        self._entries = entries
        self._read = -1
        self._events = None if since is None else self._reading(since).count_of_events
        self._last: Sensed | None = None

    def __call__(self) -> Sensed:
        """Return the agent's percepts. The object is the same while nothing has been recorded."""
        entries = self._entries()
        if self._last is None or entries != self._read:
            self._read = entries
            self._last = self._sensed(self._reading(entries), entries)
        return self._last

    def _reading(self, entries: int) -> NodeView:
        """Return the agent's belief after a number of entries."""
        believer = believer_of(self._key.path, self._agent)
        return self._history.state(self._key, believer, entries)

    def _blocks(self, seen: NodeView, entries: int) -> Terrain:
        """Return the blocks that the agent knows.

        If it believes contents that its believed block cannot hold, it reads the chest that the
        body has put there. Otherwise its program could not open it.
        """
        if not self._key.path or not seen.containers:
            return seen.terrain
        context = self._history.context
        acted_in = self._history.state(self._key, self._key.path, entries)
        put, missing = (
            chest_places(
                context.registry,
                context.box,
                each.terrain,
                {place: content.items for place, content in each.containers.items()},
            )
            for each in (acted_in, seen)
        )
        places = [place for place in missing if place in put]
        return with_chests_at(context.registry, context.box, seen.terrain, places)

    def _sensed(self, seen: NodeView, entries: int) -> Sensed:
        before, self._events = self._events, seen.count_of_events
        events = () if before is None else seen.events_since(before)
        news = announced(events, self._agent)
        return Sensed(
            self._blocks(seen, entries), seen.agents_in_sight(), dict(seen.items), news, seen.texts
        )
