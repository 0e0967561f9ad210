"""Interfaces of a world and the bodies in it, for all kinds of worlds."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Protocol

import msgspec

from beliefnest.world.event_kinds import EventKind
from beliefnest.world.event_words import Announcement
from beliefnest.world.frames import Frame, Snapshot
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import AgentState, DroppedItem, Event, Placements, Point, Position

Sink = Callable[[Frame], None]
"""Receiver of a body's frames, in order of tick."""


KILLED = "killed"
"""Kind of failure of a program whose world's process ended."""

NO_WAY = "no_way"
"""Reason of a failure: the target cannot be reached on foot."""


class Fault(msgspec.Struct, frozen=True):
    """Failure of a program, described for its author.

    Attributes:
        message: What went wrong and what to do.
        kind: Kind of failure, such as `error`, `skill`, `syntax`, `timeout`, `fuel`, `bot`
            (docs/programs.md lists all), or `killed`: the process behind the world ended, and no
            effect of the program was kept.
        line: Line in the program's own text, from 1; None if unknown.
        column: Column in that line, from 1.
        skill: The skill that failed, if one did.
        reason: Reason of a skill's failure, such as `NO_WAY`; None for all others.
    """

    message: str
    kind: str = "program"
    line: int | None = None
    column: int | None = None
    skill: str | None = None
    reason: str | None = None

    def __str__(self) -> str:
        place = "" if self.line is None else f"line {self.line}: "
        return f"{place}{self.message}"


class Aim(msgspec.Struct, frozen=True):
    """Target that a program asked its bot to walk to or to use, whether or not it succeeded.

    Attributes:
        tick: Tick of the call.
        call: The skill, or the bot's method.
        place: Position in blocks; None if the call names none, as for another kind of goal.
        agent: Agent that is the target; None if it is none.
        uses: True if the call uses the target (opens, digs, presses); False if it only walks there.
    """

    tick: int
    call: str
    place: Point | None
    agent: str | None
    uses: bool


class Unfinished(msgspec.Struct, frozen=True):
    """Activity that was unfinished at the end of a program and was stopped.

    Attributes:
        what: The skill or call that was not awaited, the timer, or the bot's activity.
        line: Line that began it; None if it belongs to no known call of the program.
    """

    what: str
    line: int | None = None

    @property
    def is_call(self) -> bool:
        """True if it is a call of a skill or of the bot, for which `await` is missing."""
        return " " not in self.what and self.what not in ("setTimeout", "setInterval")

    def __str__(self) -> str:
        return self.what if self.line is None else f"{self.what} of line {self.line}"


class Called(msgspec.Struct, frozen=True):
    """Recorded call of a program: of a skill, or of its bot to speak.

    Attributes:
        name: Name of the skill or method.
        given: Arguments as JSON.
        answer: Result as JSON: `{"ok", "value"}`; None if the call had not finished.
        ticks: Number of ticks that an unfinished call had run, as far as they count when it goes
            on.
        since: Tick of the call.
    """

    name: str
    given: str
    answer: str | None = None
    ticks: int = 0
    since: int = 0


class ProgramPast(msgspec.Struct, frozen=True):
    """Record of a program up to its interruption, with which it can be resumed.

    The program's text runs again. Calls that had finished return their recorded results without
    being executed again; an unfinished call begins anew. Waits go on, and in the scripted world
    also what takes more than all ticks in one place. As soon as the program makes another call
    than recorded, because it reads another world now, its calls are executed normally.

    Attributes:
        tick: Tick at which the program first began; its random numbers depend on it.
        calls: Its calls in order.
        until: Tick of the interruption.
    """

    tick: int
    calls: tuple[Called, ...] = ()
    until: int = 0

    @property
    def heard_until(self) -> int:
        """Last tick whose speech the program has heard; later lines are reported on resumption.

        A program that waited for speech had heard none yet. In the tick of its interruption a
        program hears nothing.
        """
        waits = [c.since for c in self.calls if c.name == "waitForChat" and c.answer is None]
        return min([*waits, self.until - 1])


@dataclass(frozen=True, slots=True)
class ProgramResult:
    """Result of a program.

    Attributes:
        agent: Agent that ran it.
        ok: True if it ended without an error.
        error: Reason of its failure; None if it did not fail.
        ticks: Number of ticks that it ran.
        happened: All events in the simulator during the run, by any agent, in order: (tick, event).
        lines: Executed lines of its text, from 1, ascending; the scripted world tells none.
        log: Lines that it wrote to its console, limited in length.
        unfinished: Activities that were stopped at the program's end.
        aims: Targets that it asked its bot for, in order, limited in number.
        calls: Its calls, in order; empty if there are too many to resume from.
        placed: Things that the body had to place otherwise than believed; see `Simulator.placed`.
    """

    agent: str
    ok: bool
    error: Fault | None
    ticks: int
    happened: tuple[tuple[int, Event], ...] = ()
    lines: tuple[int, ...] = ()
    log: tuple[str, ...] = ()
    unfinished: tuple[Unfinished, ...] = ()
    aims: tuple[Aim, ...] = ()
    placed: Placements = field(default_factory=dict)
    calls: tuple[Called, ...] = ()

    def __repr__(self) -> str:
        ended = "ended well" if self.ok else f"failed: {self.error}"
        deeds = f"{len(self.actions)} action{'s' * (len(self.actions) != 1)}"
        names = [name for name in self.placed if isinstance(name, str)]
        moved = f", {', '.join(names)} moved at first" if names else ""
        hint = "" if self.hint is None else f"; {self.hint}"
        return f"<program of {self.agent}, {self.ticks} ticks, {deeds}{moved}: {ended}{hint}>"

    @property
    def hint(self) -> str | None:
        """Hint that a successful program left calls unfinished for lack of `await`; else None."""
        calls = [str(each) for each in self.unfinished if each.is_call]
        if not self.ok or not calls:
            return None
        return f"nothing waited for {', '.join(calls)}, stopped at its end: was await forgotten?"

    @property
    def events(self) -> tuple[Event, ...]:
        """All events in the simulator during the run, by any agent, in order."""
        return tuple(event for _, event in self.happened)

    @property
    def actions(self) -> tuple[Event, ...]:
        """Acts of the program's agent, in order; speech and thoughts are not among them."""
        return tuple(
            event for _, event in self.happened if event.actor == self.agent and event.kind.is_act
        )

    @property
    def said(self) -> tuple[tuple[int, str], ...]:
        """Utterances of the program's agent, said aloud or whispered, in order: (tick, text)."""
        return tuple(
            (tick, event.detail["text"])
            for tick, event in self.happened
            if event.actor == self.agent and event.kind is EventKind.CHAT
        )

    @property
    def killed(self) -> bool:
        """True if the process behind the world ended; then no effect of the run was kept."""
        return self.error is not None and self.error.kind == KILLED


class Sensed(msgspec.Struct, frozen=True):
    """Knowledge of the world that a program may read.

    Attributes:
        blocks: Block state ids of the box, -1 is unknown.
        agents: The other agents that its own perceives now; its own state it knows by its body.
        items: Dropped items by number, at their last seen positions.
        announced: Events of its bot about what it perceived, in the latest tick, but did not see.
        signs: Known texts of signs, by position; all other signs are blank.
    """

    blocks: Terrain
    agents: Mapping[str, AgentState]
    items: Mapping[int, DroppedItem] = msgspec.field(default_factory=dict)
    announced: tuple[Announcement, ...] = ()
    signs: Mapping[Position, str] = msgspec.field(default_factory=dict)


SenseSource = Callable[[], Sensed]
"""Function that returns what a program may read, as of the latest tick that has ended."""


class RunRules(msgspec.Struct, frozen=True):
    """Rules of running programs in a body.

    Attributes:
        speech_ticks: Ticks per utterance; 0 if it is said in the next tick.
        remembers: True if results contain the calls of programs, so that these can be resumed.
        past: Records of the programs that are resumed, by agent.
        mute: Agents that cannot say or whisper anything.
    """

    speech_ticks: int = 0
    remembers: bool = False
    past: Mapping[str, ProgramPast] = msgspec.field(default_factory=dict)
    mute: frozenset[str] = frozenset()


AS_USUAL = RunRules()
"""Default rules."""


class Body(Protocol):
    """One simulator's part of a world; its clock stops between calls unless it `goes_on`.

    Any call but `close` may raise BodyLostError: the process behind the world ended. The requested
    changes have then not happened, whatever frames were sent. The body and all others of that
    process are unusable; the world can open new ones.
    """

    @property
    def lost(self) -> bool:
        """True if the process behind the world has ended."""

    @property
    def goes_on(self) -> bool:
        """True if time passes in it between calls; the next call reports the events."""

    @property
    def tick(self) -> int:
        """Latest tick of the body."""

    @property
    def internal_state(self) -> bytes:
        """State of processes that its snapshot does not contain, at the end of the last call."""

    def snapshot(self) -> Snapshot:
        """Return the present state."""

    def run(
        self,
        programs: Mapping[str, str],
        timeout_ticks: int,
        senses: Mapping[str, SenseSource] | None = None,
        rules: RunRules = AS_USUAL,
    ) -> Mapping[str, ProgramResult]:
        """Run programs by agent, together, until the last has ended.

        Args:
            programs: Texts of the programs.
            timeout_ticks: Number of ticks after which they are stopped.
            senses: Knowledge, by agent, for the programs that may read nothing else.
            rules: Rules of the run.

        Raises:
            WorldError: An agent is not in this body, or the world cannot run such programs; nothing
                was changed.
            BodyError: The Minecraft side failed.
        """

    def step(self, ticks: int) -> None:
        """Let ticks pass without programs."""

    def set_state(self, snapshot: Snapshot) -> None:
        """Set the state to a snapshot by changing only what differs; no frames are sent."""

    def close(self) -> None:
        """Close the body, also if it is lost; a second call does nothing."""


class World(Protocol):
    """Place where bodies live. If its process has ended, the next body starts a new one."""

    @property
    def has_physics(self) -> bool:
        """True if agents in its bodies stand, fall and are stopped by blocks."""

    @property
    def versions(self) -> Mapping[str, str]:
        """Versions of the running programs by name."""

    @property
    def realtime(self) -> "RealtimePlay | None":
        """The same world, if its real world runs in real time; None for all others."""

    def start(self) -> object:
        """Start the process behind the world now, if there is one and it has not begun.

        Raises:
            BodyError: It could not be started.
        """

    def open_body(self, name: str, seed: str, snapshot: Snapshot, sink: Sink) -> Body:
        """Create a body and fill it.

        Args:
            name: Name of the body in this world, unique.
            seed: Seed of all its random numbers.
            snapshot: Initial state.
            sink: Receiver of its frames.

        Raises:
            BodyLostError: The process behind the world ended meanwhile.
            BodyError: The world could not be started, or failed.
        """

    def another(self) -> "World":
        """Return another empty world of the same kind; it starts with its first body."""

    def interrupt(self) -> None:
        """Interrupt its work for another thread, and close all its bodies; they are lost."""

    def close(self) -> None:
        """Close the world and all its bodies."""


class RealtimePlay(World, Protocol):
    """World whose real world runs in real time, so that people can join it."""

    @property
    def address(self) -> str:
        """Address for Minecraft clients: `HOST:PORT`."""

    @property
    def minecraft(self) -> str:
        """Minecraft version of the clients."""

    @property
    def invited(self) -> frozenset[str]:
        """Names of the people who may join."""

    @property
    def host(self) -> "SpeechHost | None":
        """The process of this nest that people join; None on a server elsewhere."""

    def invite(self, people: Iterable[str]) -> None:
        """Set the people who may join; disconnect others who are there.

        Raises:
            WorldError: A server's operator may not kick people.
        """

    def here(self) -> frozenset[str]:
        """Return the names of the people who play now."""

    def pause(self, *, paused: bool) -> None:
        """Stop or resume time in the real world.

        Raises:
            WorldError: It is on a server, whose time cannot be stopped.
        """


class SpeechHost(Protocol):
    """Process that people join, in which they hear only what it is told that they hear."""

    def hearing(self, *, everybody: bool) -> None:
        """Set whether all people hear everything said aloud, so that lines need not wait."""

    def heard(self, tick: int, agents: Sequence[Sequence[str]]) -> None:
        """Report the hearers of a tick's utterances; people receive only the lines they heard.

        Args:
            tick: The tick.
            agents: For each utterance, in order, the names of its hearers.
        """
