"""Bodies of a nest's simulators.

A body is opened when it is first needed. If its process ends, it is opened again from what was
recorded. Each body has a recorder, which appends frames to the selected timeline of its simulator.
"""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import msgspec

from beliefnest.errors import BodyError, BranchError, WorldError
from beliefnest.nest.acting.earshot import Earshot
from beliefnest.nest.acting.frame_recorder import ChatListener, FrameRecorder
from beliefnest.nest.acting.hearsay import ClaimReader, Hearsay
from beliefnest.nest.acting.lives import Lives
from beliefnest.nest.acting.sensing import Sensing
from beliefnest.nest.acting.speculation import SpeculatedBody, Speculation
from beliefnest.nest.acting.starting import BodyStart, start_of
from beliefnest.nest.acting.visitable import Visitable
from beliefnest.nest.past.body_state import note_internal_state, present
from beliefnest.nest.past.recording import Recording
from beliefnest.timeline.journal import ForkPoint, TimelineKey
from beliefnest.world.frames import Snapshot
from beliefnest.world.paths import BeliefPath, path_text
from beliefnest.worlds.protocol import Body, ProgramPast, SenseSource, World


class _RecordedBody(msgspec.Struct, frozen=True):
    """Body with the recorder of its frames."""

    body: Body
    recorder: FrameRecorder


class Bodies:
    """Bodies of simulators in control mode, by path.

    Attributes:
        world: The world that has the bodies.
        others: Further worlds of the same kind, for programs that run at the same time.
        chat_listeners: Functions that are called with each utterance in the real world.
    """

    def __init__(
        self,
        recording: Recording,
        world: World,
        visitable: Visitable | None,
        reader: ClaimReader | None = None,
    ) -> None:
        self.world = world
        self.others: list[World] = []
        self.chat_listeners: list[ChatListener] = []
        self._recording = recording
        self._visitable = visitable
        self._hearsay = None if reader is None else Hearsay(reader, recording)
        self._embodied: dict[BeliefPath, _RecordedBody] = {}
        self._bodiless: set[BeliefPath] = set()

    def __contains__(self, path: BeliefPath) -> bool:
        return path in self._embodied

    def lives(self) -> Lives:
        """Return the counter of processes that one call may use up; see `Lives`."""
        return Lives(self.forget_lost)

    def of(self, path: BeliefPath) -> Body:
        """Return the body of a simulator in control mode. Open it if there is none.

        Raises:
            BranchError: The simulator is in follow mode.
            BodyError: The world could not be started.
        """
        if path not in self._recording.selected:
            raise BranchError(
                f"{path_text(path)} is in follow mode and has no body to act in; switch it to a "
                "branch first, with simulator.switch('my-branch')"
            )
        if path not in self._embodied:
            key = self._recording.selected[path]
            self.open(key, self.recorded(key))
        return self._embodied[path].body

    def open(self, key: TimelineKey, snapshot: Snapshot) -> None:
        """Open the body of a simulator, filled with a snapshot."""
        recorder = self._recorder(key)
        body = self.world.open_body(path_text(key.path), self.seed_of(key.path), snapshot, recorder)
        self._embodied[key.path] = _RecordedBody(body, recorder)
        self._recording.records.add_versions(self.world.versions)
        if recorder.earshot is not None:
            recorder.earshot.begin()

    def _recorder(self, key: TimelineKey) -> FrameRecorder:
        recording = self._recording
        on_chat = self._tell_chat if key.path == () else None
        # Only the real world runs in real time, so only its frames are shown while they come.
        follower = self._visitable if key.path == () else None
        return FrameRecorder(
            recording.journal,
            recording.history,
            key,
            self._hearsay,
            on_chat,
            follower,
            self._earshot() if key.path == () else None,
        )

    def _earshot(self) -> Earshot | None:
        people, joined = self._recording.setting.people, self.world.realtime
        if joined is None or joined.host is None or not people:
            return None
        return Earshot(self._recording.history, people, joined.host)

    def _tell_chat(self, tick: int, speaker: str, text: str) -> None:
        for listener in self.chat_listeners:
            listener(tick, speaker, text)

    def seed_of(self, path: BeliefPath) -> str:
        """Return the seed of a simulator's body."""
        return f"{self._recording.seed} {path_text(path)}"

    def start(self, path: BeliefPath, moment: ForkPoint) -> BodyStart:
        """Return the start of a simulator's body at a moment; see `start_of`."""
        recording = self._recording
        return start_of(
            recording.journal, recording.history, path, moment, has_physics=self.world.has_physics
        )

    def recorded(self, key: TimelineKey) -> Snapshot:
        """Return the snapshot that a body on a timeline must have now."""
        return self.start(key.path, present(self._recording.journal, key)).snapshot

    def give_up(self, path: BeliefPath) -> None:
        """Close a simulator's body, if it has one."""
        embodied = self._embodied.pop(path, None)
        if embodied is not None:
            embodied.body.close()

    def forget_lost(self) -> None:
        """Drop the bodies whose process has ended. New ones are opened when they are needed."""
        self._embodied = {p: each for p, each in self._embodied.items() if not each.body.lost}

    def rename(self, key: TimelineKey) -> None:
        """Let a body's recorder append to another timeline of its simulator."""
        if key.path in self._embodied:
            self._embodied[key.path].recorder.key = key

    @contextmanager
    def selecting(self, key: TimelineKey, snapshot: Snapshot) -> Iterator[None]:
        """Bring a simulator's body to a state, and select the timeline when the block ends.

        The block records the selection. If it or the world raises, the simulator stays where it is.
        """
        embodied = self._embodied.get(key.path)
        try:
            if embodied is not None:
                embodied.body.set_state(snapshot)
            elif key.path not in self._bodiless:
                self.open(key, snapshot)
            yield
        except BaseException:
            self.restore(key.path)
            raise
        self._recording.selected[key.path] = key
        self.rename(key)

    @contextmanager
    def acting(self, path: BeliefPath) -> Iterator[Body]:
        """Wrap a call on a body: its frames and notes are recorded when it ends, or not at all."""
        body, recorder = self.of(path), self._embodied[path].recorder
        journal = self._recording.journal
        recorder.batched = True
        try:
            # A `WorldError` is a refusal: the body was not changed, so it need not be restored.
            with self.changing(path, unless=WorldError):
                yield body
                recorder.flush(body.tick)
                note_internal_state(journal, present(journal, recorder.key), body.internal_state)
        finally:
            recorder.batched = False
        recorder.keep_up()

    def catch_up(self, path: BeliefPath) -> None:
        """Record the frames of a body that runs in real time since the last call on it."""
        embodied = self._embodied.get(path)
        if embodied is not None and embodied.body.goes_on:
            with self.acting(path) as body:
                body.step(0)

    def sense_of(
        self, path: BeliefPath, agent: str, past: ProgramPast | None = None
    ) -> SenseSource:
        """Return the percepts and memories of an agent, for its program with `senses: percepts`.

        They are computed from what has been recorded so far. The agent's belief here follows this
        simulator, whatever branch is selected for the belief itself. A program knows its own
        position and possessions from its bot. A program that continues from a `past` also hears
        the utterances since then.
        """
        embodied, recording = self._embodied[path], self._recording
        key = recording.controller(path)

        def entries() -> int:
            embodied.recorder.flush(embodied.body.tick)
            return recording.journal.info(key).entries

        since = None
        if past is not None:
            since = recording.journal.entries_until(key, past.heard_until)
        return Sensing(recording.history, key, agent, entries, since)

    @contextmanager
    def changing(
        self, path: BeliefPath, unless: type[BaseException] | tuple[()] = ()
    ) -> Iterator[None]:
        """Record everything inside the block or nothing.

        If the block raises, the journal is as before, and the body gets the state of its timeline
        again.

        Args:
            path: Path of the simulator.
            unless: Exceptions that are raised only before the body was changed.
        """
        try:
            with self._recording.journal.together():
                yield
        except unless:
            raise
        except BaseException:
            if path in self._embodied:
                self._embodied[path].recorder.drop()
            # Forests may have folded entries that the journal has now dropped.
            self._recording.history.forget_all()
            if self._visitable is not None:
                self._visitable.look_again()
            self.restore(path)
            raise

    def restore(self, path: BeliefPath) -> None:
        """Bring a simulator's body, after a fault, to the state at the head of its timeline."""
        self.forget_lost()
        key, embodied = self._recording.selected.get(path), self._embodied.get(path)
        if embodied is None:
            return
        if key is None:
            self.give_up(path)
            return
        try:
            embodied.body.set_state(self.recorded(key))
        except BodyError:
            # The body is of no use any more: close it, and open another one when it is needed.
            self.give_up(path)

    @contextmanager
    def without(self, path: BeliefPath) -> Iterator[None]:
        """Close a simulator's body, and open none when a branch is selected inside the block."""
        self.give_up(path)
        self._bodiless.add(path)
        try:
            yield
        finally:
            self._bodiless.discard(path)

    @contextmanager
    def speculated(self, path: BeliefPath, speculation: Speculation) -> Iterator[None]:
        """Let the result of a speculation stand in for this simulator's body inside the block."""
        recording = self._recording
        self.give_up(path)
        recorder = self._recorder(recording.selected[path])
        self._embodied[path] = _RecordedBody(SpeculatedBody(speculation, recorder), recorder)
        try:
            yield
        finally:
            self.give_up(path)

    def further_worlds(self, count: int) -> Sequence[World]:
        """Return a number of worlds like this nest's own. Each starts when it is first needed."""
        while len(self.others) < count:
            self.others.append(self.world.another())
        return self.others[:count]

    def close(self) -> None:
        """Close all bodies and their worlds."""
        self._embodied.clear()
        for world in (*self.others, self.world):
            world.close()
