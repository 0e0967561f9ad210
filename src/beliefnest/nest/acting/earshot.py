"""Hearing of people in Minecraft: they hear what their agents hear (semantics, section 3)."""

from collections.abc import Collection

from beliefnest.nest.past.history import StateHistory
from beliefnest.timeline.journal import TimelineKey
from beliefnest.world.event_kinds import EventKind
from beliefnest.world.frames import Frame
from beliefnest.world.values import Event
from beliefnest.worlds.protocol import SpeechHost


class Earshot:
    """Messenger that tells the people's world which of them hear an utterance.

    Args:
        history: History that computes who perceives an event.
        people: Names of the agents that people play.
        host: The process that people have joined.
    """

    def __init__(self, history: StateHistory, people: Collection[str], host: SpeechHost) -> None:
        self._history = history
        self._people = sorted(people)
        self._host = host

    @property
    def is_global(self) -> bool:
        """True if everybody hears everything."""
        return self._history.context.options.hearing == "global"

    def begin(self) -> None:
        """Tell a process that has just begun how people hear."""
        self._host.hearing(everybody=self.is_global)

    def awaits(self, frame: Frame) -> bool:
        """Return True if the world waits to be told who hears the utterances of a frame."""
        return not self.is_global and any(map(_is_aloud, frame.events))

    def tell(self, key: TimelineKey, frame: Frame, entries: int) -> None:
        """Tell the world who hears the utterances of a frame.

        Args:
            key: The timeline.
            frame: The frame, which is the last entry.
            entries: Number of entries of the timeline, the frame included.
        """
        heard: list[list[str]] = [[] for event in frame.events if _is_aloud(event)]
        for name in self._people:
            reading = self._history.state(key, (name,), entries)
            perceived = reading.perceived_since(reading.count_of_events - len(frame.events))
            spoken = [p for p, e in zip(perceived, frame.events, strict=True) if _is_aloud(e)]
            for names, hears in zip(heard, spoken, strict=True):
                if hears:
                    names.append(name)
        self._host.heard(frame.tick, heard)


def _is_aloud(event: Event) -> bool:
    return event.kind is EventKind.CHAT and "to" not in event.detail
