"""The bodies of a nest's simulators: made when first needed, lost with their process, made again.

Every body has a recorder, which appends its frames to the timeline that its simulator is on.
"""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

from beliefnest.bodies.protocol import Body, ProgramPast, Sense, World
from beliefnest.bodies.worlds import hosted_of
from beliefnest.errors import BodyError, BranchError, WorldError
from beliefnest.nest.acting.earshot import Earshot
from beliefnest.nest.acting.embodying import Embodying
from beliefnest.nest.acting.frame_recorder import ChatListener, FrameRecorder
from beliefnest.nest.acting.hearsay import ClaimReader, Hearsay
from beliefnest.nest.acting.lives import Lives
from beliefnest.nest.acting.sensing import Sensing
from beliefnest.nest.acting.speculation import SpeculatedBody, Speculation
from beliefnest.nest.acting.starting import BodyStart, start_of
from beliefnest.nest.past.body_state import note_internal_state, present
from beliefnest.nest.past.recording import Recording
from beliefnest.timeline.journal import ForkPoint, TimelineKey
from beliefnest.world.frames import Snapshot
from beliefnest.world.paths import BeliefPath, path_text

__all__ = ["Bodies"]


@dataclass(frozen=True, slots=True)
class _RecordedBody:
    """A body and what records its frames."""

    body: Body
    recorder: FrameRecorder


class Bodies:
    """The bodies of simulators in control mode, by path.

    Attributes:
        world: Where they live.
        others: Further worlds of the kind, for programs that run at the same time.
        chat_listeners: Called on what is said in the real world.
    """

    def __init__(
        self,
        recording: Recording,
        world: World,
        embodying: Embodying,
        reader: ClaimReader | None = None,
    ) -> None:
        self.world = world
        self.others: list[World] = []
        self.chat_listeners: list[ChatListener] = []
        self._recording = recording
        self._embodying = embodying
        self._hearsay = None
        if reader is not None:
            self._hearsay = Hearsay(reader, recording.setting, recording.history)
        self._embodied: dict[BeliefPath, _RecordedBody] = {}
        self._bodiless: set[BeliefPath] = set()

    def __contains__(self, path: BeliefPath) -> bool:
        return path in self._embodied

    def lives(self) -> Lives:
        """Return the processes that one call on bodies may use up."""
        return Lives(self.forget_lost)

    def of(self, path: BeliefPath) -> Body:
        """Return the body of a simulator in control mode, made if there is none yet.

        Raises:
            BranchError: The simulator is in follow mode.
            BodyError: The world could not be started.
        """
        if path not in self._recording.selected:
            raise BranchError(
                f"{path_text(path)} is in follow mode and has no body to act in; "
                "switch it to a branch first: simulator.switch('my-branch')"
            )
        if path not in self._embodied:
            key = self._recording.selected[path]
            self.open(key, self.recorded(key))
        return self._embodied[path].body

    def open(self, key: TimelineKey, snapshot: Snapshot) -> None:
        """Make the body of a simulator."""
        recorder = self._recorder(key)
        body = self.world.open_body(path_text(key.path), self.seed_of(key.path), snapshot, recorder)
        self._embodied[key.path] = _RecordedBody(body, recorder)
        self._recording.records.add_versions(self.world.versions)
        if recorder.earshot is not None:
            recorder.earshot.begin()

    def _recorder(self, key: TimelineKey) -> FrameRecorder:
        recording = self._recording
        on_chat = self._tell_chat if key.path == () else None
        # Of reality alone: what goes on faster than real time nobody could watch.
        follower = self._embodying if key.path == () else None
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
        people, world = self._recording.setting.people, hosted_of(self.world)
        if world is None or not people:
            return None
        return Earshot(self._recording.history, people, world)

    def _tell_chat(self, tick: int, speaker: str, text: str) -> None:
        for listener in self.chat_listeners:
            listener(tick, speaker, text)

    def seed_of(self, path: BeliefPath) -> str:
        """Seed of a simulator's body."""
        return f"{self._recording.seed} {path_text(path)}"

    def start(self, path: BeliefPath, moment: ForkPoint) -> BodyStart:
        """What a simulator's body is filled with at a moment of its timeline or its parent's."""
        recording = self._recording
        return start_of(
            recording.journal,
            recording.history,
            path,
            moment,
            has_physics=self.world.has_physics,
        )

    def recorded(self, key: TimelineKey) -> Snapshot:
        """What a body on a timeline has to be like now."""
        return self.start(key.path, present(self._recording.journal, key)).snapshot

    def give_up(self, path: BeliefPath) -> None:
        """Close a simulator's body, if it has one."""
        embodied = self._embodied.pop(path, None)
        if embodied is not None:
            embodied.body.close()

    def forget_lost(self) -> None:
        """Forget the bodies whose process has ended; others are made when they are needed."""
        self._embodied = {p: each for p, each in self._embodied.items() if not each.body.lost}

    def rename(self, key: TimelineKey) -> None:
        """Record in the timeline that a simulator is on from now on."""
        if key.path in self._embodied:
            self._embodied[key.path].recorder.key = key

    @contextmanager
    def selecting(self, key: TimelineKey, snapshot: Snapshot) -> Iterator[None]:
        """Give a simulator's body a state and, if the body of the block records that, select it.

        If the world or the journal refuses, the simulator is where it was before.
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
        """A call on a body; what happens and what is noted is kept once it ends, as a whole."""
        body, recorder = self.of(path), self._embodied[path].recorder
        journal = self._recording.journal
        recorder.batched = True
        try:
            # What a world refuses it has not begun.
            with self.changing(path, unless=WorldError):
                yield body
                recorder.flush(body.tick)
                note_internal_state(journal, present(journal, recorder.key), body.internal_state)
        finally:
            recorder.batched = False
        recorder.keep_up()

    def catch_up(self, path: BeliefPath) -> None:
        """Record what has happened in a body that goes on by itself since the last call on it."""
        embodied = self._embodied.get(path)
        if embodied is not None and embodied.body.goes_on:
            with self.acting(path) as body:
                body.step(0)

    def sense_of(self, path: BeliefPath, agent: str, past: ProgramPast | None = None) -> Sense:
        """What an agent of a simulator perceives or remembers, while programs run in its body.

        Beliefs are worked out from what has been recorded so far, as they always are, and follow
        this simulator, whatever branch the agent's own one is on. Where the agent is, and what
        it has on it, it knows from its own body. A program that goes on from a `past` hears what
        was said since then.
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
        """What is recorded inside is kept as a whole.

        If it raises, nothing of it is kept, and the body is again as its timeline says.

        Args:
            path: The simulator.
            unless: What is raised only where the body was not changed.
        """
        try:
            with self._recording.journal.together():
                yield
        except unless:
            raise
        except BaseException:
            if path in self._embodied:
                self._embodied[path].recorder.drop()
            # What was read meanwhile, here or in what is based on it, has not happened.
            self._recording.history.forget_all()
            self._embodying.look_again()
            self.restore(path)
            raise

    def restore(self, path: BeliefPath) -> None:
        """Make a simulator's body, after a fault, what its timeline says."""
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
            # Not even that; another one is made when it is needed.
            self.give_up(path)

    @contextmanager
    def without(self, path: BeliefPath) -> Iterator[None]:
        """Give a simulator's body up, and make none for a branch that is only selected."""
        self.give_up(path)
        self._bodiless.add(path)
        try:
            yield
        finally:
            self._bodiless.discard(path)

    @contextmanager
    def speculated(self, path: BeliefPath, speculation: Speculation) -> Iterator[None]:
        """Let programs that have run already run as in this simulator's body."""
        recording = self._recording
        self.give_up(path)
        recorder = self._recorder(recording.selected[path])
        self._embodied[path] = _RecordedBody(SpeculatedBody(speculation, recorder), recorder)
        try:
            yield
        finally:
            self.give_up(path)

    def further_worlds(self, count: int) -> Sequence[World]:
        """That many worlds like this nest's own; each is started when it is first needed."""
        while len(self.others) < count:
            self.others.append(self.world.another())
        return self.others[:count]

    def close(self) -> None:
        """Give up all bodies and their worlds."""
        self._embodied.clear()
        for world in (*self.others, self.world):
            world.close()
