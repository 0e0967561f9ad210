"""What an agent knows of the world that it acts in, tick by tick, for its program."""

from collections.abc import Callable

from beliefnest.bodies.protocol import Sensed
from beliefnest.nest.past.recording import Recording
from beliefnest.world.values import AgentState, EventKind

__all__ = ["Sensing"]

Path = tuple[str, ...]


class Sensing:
    """A `Sense`: the belief of an agent of a simulator, as of what has been recorded.

    Args:
        recording: What beliefs are worked out from.
        path: The simulator that it acts in. In its own belief all there is is what it believes.
        agent: Who it is.
        write: Lets everything be recorded that has happened.
    """

    def __init__(
        self, recording: Recording, path: Path, agent: str, write: Callable[[], None]
    ) -> None:
        self._recording = recording
        self._path = path
        self._agent = agent
        self._believer = path if path[-1:] == (agent,) else (*path, agent)
        self._write = write
        self._entries = -1
        self._events: int | None = None
        self._last: Sensed | None = None

    def __call__(self) -> Sensed:
        """What it knows by now; the same object as long as nothing has been recorded."""
        self._write()
        entries = self._recording.info(self._path).entries
        if self._last is None or entries != self._entries:
            self._entries = entries
            self._last = self._sensed()
        return self._last

    def _sensed(self) -> Sensed:
        seen = self._recording.reading(self._believer)
        agents = {
            name: AgentState(
                each.position, each.yaw, each.pitch, each.on_ground, each.equipment or {}
            )
            for name, each in seen.agents.items()
            if each.current and each.position is not None and name != self._agent
        }
        before, self._events = self._events, seen.count_of_events
        said = () if before is None else seen.events_since(before)
        heard = tuple(
            (event.actor or "", str(event.detail["text"]), event.detail.get("to"))
            for event in said
            if event.kind is EventKind.CHAT
        )
        return Sensed(seen.blocks, agents, dict(seen.items), heard, seen.signs)
