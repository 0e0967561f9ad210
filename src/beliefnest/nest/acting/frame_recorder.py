"""Recorder of one body, which appends its frames to a timeline."""

from collections.abc import Callable, Iterator

from beliefnest.nest.acting.earshot import Earshot
from beliefnest.nest.acting.hearsay import Hearsay, has_unread
from beliefnest.nest.acting.visitable import Visitable
from beliefnest.nest.past.history import StateHistory
from beliefnest.timeline.journal import TimelineKey
from beliefnest.timeline.store import Journal
from beliefnest.world.event_kinds import EventKind
from beliefnest.world.frames import Frame

SpokenLine = tuple[int, str, str]
"""Tick, speaker, text."""

ChatListener = Callable[[int, str, str], None]
"""Function of tick, speaker and text of an utterance or a whisper in the real world."""

_BATCH = 256


class FrameRecorder:
    """Recorder that appends a body's frames to its timeline.

    Outside of calls each frame is written at once. During a call `batched` is set: frames are then
    collected, and written together when the call ends, when there are `_BATCH` of them, or when
    people or programs have to know them earlier.

    Args:
        journal: The journal of the timeline.
        history: History that follows the journal.
        key: The timeline.
        hearsay: Reader that adds claims to utterances; None: frames are recorded as they are.
        on_chat: Function called with each utterance after it is recorded; None: none is called.
        follower: Embodied beliefs, brought up to date with every frame, also during a call; None:
            there are none.
        earshot: Object that tells people what the agents they play hear; None: nobody is told.
    """

    def __init__(
        self,
        journal: Journal,
        history: StateHistory,
        key: TimelineKey,
        hearsay: Hearsay | None = None,
        on_chat: ChatListener | None = None,
        follower: Visitable | None = None,
        earshot: Earshot | None = None,
    ) -> None:
        self.key = key
        self.earshot = earshot
        self._follower = follower
        self._on_chat = on_chat
        self._said: list[SpokenLine] = []
        self.batched = False
        self._journal = journal
        self._history = history
        self._hearsay = hearsay
        self._frames: list[Frame] = []
        self._tick: int | None = None

    def __call__(self, frame: Frame) -> None:
        """Take a frame. Claims are read from it after everything before it is written."""
        if self._hearsay is not None and has_unread(frame):
            self.flush()
            frame = self._hearsay.completed(frame, self.key)
        self._tick = frame.tick
        if not frame.is_empty:
            self._frames.append(frame)
        if self._on_chat is not None:
            self._said.extend(_said_in(frame))
        followed = self._follower is not None and self._follower.follows
        awaited = self.earshot is not None and self.earshot.awaits(frame)
        if not self.batched:
            self.flush()
            self.keep_up()
        elif followed or awaited or len(self._frames) >= _BATCH:
            self.flush()
        if self._follower is not None and followed:
            self._follower.keep_up()
        if self.earshot is not None and awaited:
            self.earshot.tell(self.key, frame, self._journal.info(self.key).entries)

    def flush(self, tick: int | None = None) -> None:
        """Append the collected frames. `tick` is the body's tick; None: that of the last frame."""
        head = self._tick if tick is None else tick
        if head is not None:
            frames, self._frames, self._tick = self._frames, [], None
            self._journal.append(self.key, frames, head)

    def keep_up(self) -> None:
        """Let the history follow the written entries, and call `on_chat` with utterances.

        Call this only when the entries cannot be taken back any more.
        """
        self._history.note(self.key)
        said, self._said = self._said, []
        if self._on_chat is not None:
            for utterance in said:
                self._on_chat(*utterance)

    def drop(self) -> None:
        """Drop the collected frames, because the call failed."""
        self._frames, self._tick, self._said = [], None, []


def _said_in(frame: Frame) -> Iterator[SpokenLine]:
    for event in frame.events:
        if event.kind is EventKind.CHAT and event.actor is not None:
            yield frame.tick, event.actor, event.detail["text"]
