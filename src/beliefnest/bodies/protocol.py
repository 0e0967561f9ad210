"""What a world and the bodies in it can do, whichever world it is."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Protocol

from beliefnest.world.frames import BlockGrid, Frame, Snapshot
from beliefnest.world.values import (
    AgentState,
    DroppedItem,
    Event,
    EventKind,
    Placements,
    Point,
    Position,
)

__all__ = [
    "AS_USUAL",
    "KILLED",
    "NO_WAY",
    "Aim",
    "Body",
    "Called",
    "Fault",
    "ProgramPast",
    "ProgramResult",
    "RunRules",
    "Sense",
    "Sensed",
    "Sink",
    "Unfinished",
    "World",
]

Sink = Callable[[Frame], None]
"""Takes the frames of a body as they come, in order of tick."""


KILLED = "killed"
"""Kind of failure of a program under which the process behind the world ended."""

NO_WAY = "no_way"
"""Reason of a failure: what the program made for cannot be reached on foot."""


@dataclass(frozen=True, slots=True)
class Fault:
    """Why a program failed, for its writer.

    Attributes:
        message: What went wrong and what to do.
        kind: Kind of failure, as `error`, `skill`, `syntax`, `timeout`, `fuel`, `bot` (all of
            them are in docs/programs.md), or `killed`: the process behind the world ended, and
            nothing of the program was kept.
        line: Line in the program's own text, from 1; None where there is none.
        column: Column in that line, from 1.
        skill: The skill that failed, if one did.
        reason: What sort of failure of a skill it is, as `NO_WAY`; None: none that is told apart.
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


_NO_DEEDS = (EventKind.CHAT, EventKind.THINK, EventKind.BLOCK_UPDATE)


@dataclass(frozen=True, slots=True)
class Aim:
    """What a program asked its bot to make for, whatever came of it.

    Attributes:
        tick: When it asked.
        call: The skill or call of the bot that it asked with.
        place: Where, in blocks; None where it named none, as for a goal of another kind.
        agent: Whom, if it asked for an agent; None: none.
        uses: Whether it asked to use what is there (open, dig, press); False: to walk there.
    """

    tick: int
    call: str
    place: Point | None
    agent: str | None
    uses: bool


@dataclass(frozen=True, slots=True)
class Unfinished:
    """What was still going on when a program ended, and was stopped then.

    Attributes:
        what: The skill or call that was not waited for, the timer, or what the bot was doing.
        line: Line that began it; None where no call of the program is known for it.
    """

    what: str
    line: int | None = None

    @property
    def is_call(self) -> bool:
        """True if it is a skill or a call of the bot, which `await` would have waited for."""
        return " " not in self.what and self.what not in ("setTimeout", "setInterval")

    def __str__(self) -> str:
        return self.what if self.line is None else f"{self.what} of line {self.line}"


@dataclass(frozen=True, slots=True)
class Called:
    """A call that a program made: of a skill, or of its bot to speak.

    Attributes:
        name: What it called.
        given: With which arguments, as JSON.
        answer: What came of it, as JSON: `{"ok", "value"}`; None: it was under way in the end.
        ticks: For how long it was under way; 0 if it is over.
        since: The tick at which it was called first.
    """

    name: str
    given: str
    answer: str | None = None
    ticks: int = 0
    since: int = 0


@dataclass(frozen=True, slots=True)
class ProgramPast:
    """What a program had done when it was cut, from where it goes on.

    Its text is run again, and the calls that were over give what they gave, without being done
    once more; the one that was under way is begun anew. From where it calls something else, since
    it reads another world now, it does whatever it calls.

    Attributes:
        tick: The tick at which it began at first, which its random numbers hang on.
        calls: In the order in which it made them.
        until: The tick at which it was cut.
    """

    tick: int
    calls: tuple[Called, ...] = ()
    until: int = 0

    @property
    def heard_until(self) -> int:
        """The tick up to which it knows what was said: later words are told when it goes on.

        Whoever waited for words had got none yet. In the tick in which it is cut it hears nothing.
        """
        waits = [c.since for c in self.calls if c.name == "waitForChat" and c.answer is None]
        return min([*waits, self.until - 1])


@dataclass(frozen=True, slots=True)
class ProgramResult:
    """What became of a program.

    Attributes:
        agent: Who ran it.
        ok: Whether it ended without an error.
        error: Why it failed; None if it did not.
        ticks: How many ticks it ran.
        happened: What happened in the simulator meanwhile, whoever did it, in order: (tick, event).
        lines: Lines of its text that ran, from 1, rising.
        log: What it wrote to its console, bounded.
        unfinished: What was stopped because it was still going on at the program's end.
        aims: What it asked its bot to make for, in order, bounded.
        calls: What it called, in order; empty where that was too much to go on from.
        placed: What the body had to place otherwise than believed; see `Simulator.placed`.
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
        """Says so if it ended well while calls went on that nothing waited for; else None."""
        calls = [str(each) for each in self.unfinished if each.is_call]
        if not self.ok or not calls:
            return None
        return f"nothing waited for {', '.join(calls)}, stopped at its end: was await forgotten?"

    @property
    def events(self) -> tuple[Event, ...]:
        """What happened in the simulator meanwhile, whoever did it, in order."""
        return tuple(event for _, event in self.happened)

    @property
    def actions(self) -> tuple[Event, ...]:
        """What the program's agent did, in order; what it said and thought is no deed."""
        return tuple(
            event
            for _, event in self.happened
            if event.actor == self.agent and event.kind not in _NO_DEEDS
        )

    @property
    def said(self) -> tuple[tuple[int, str], ...]:
        """What the program's agent said aloud or to one, in order: (tick, text)."""
        return tuple(
            (tick, event.detail["text"])
            for tick, event in self.happened
            if event.actor == self.agent and event.kind is EventKind.CHAT
        )

    @property
    def killed(self) -> bool:
        """True if the process behind the world ended under it; then nothing of it was kept."""
        return self.error is not None and self.error.kind == KILLED


@dataclass(frozen=True)
class Sensed:
    """What a program may read of the world.

    Attributes:
        blocks: Block state ids of the box, -1 is unknown.
        agents: The other agents that its own perceives now; of itself it knows by its body.
        items: Dropped items by number, where they were seen last.
        heard: What was heard in the latest tick: speaker, text, and to whom it was whispered.
        signs: What is written on signs, by position; a sign that is not among them is blank.
        has_free_line: Given eyes and a block, whether nothing that it knows of hides the block
            from there; None: nothing ever does.
    """

    blocks: BlockGrid
    agents: Mapping[str, AgentState]
    items: Mapping[int, DroppedItem] = field(default_factory=dict)
    heard: tuple[tuple[str, str, str | None], ...] = ()
    signs: Mapping[Position, str] = field(default_factory=dict)
    has_free_line: "FreeLine | None" = None


FreeLine = Callable[[Point, Position], bool]
"""Given eyes and a block: whether the block can be seen from there."""

Sense = Callable[[], Sensed]
"""What a program may read of the world as of the latest tick that is over."""


@dataclass(frozen=True, slots=True)
class RunRules:
    """How programs run in a body.

    Attributes:
        speech_ticks: Ticks that it takes to say something; 0: it is said in the next tick.
        remembers: Whether results tell what programs called, so that they can go on when cut.
        past: Of agents whose programs go on where they were cut.
    """

    speech_ticks: int = 0
    remembers: bool = False
    past: Mapping[str, ProgramPast] = field(default_factory=dict)


AS_USUAL = RunRules()
"""The rules of who says nothing about them."""


class Body(Protocol):
    """One simulator's part of a world; its clock stands still between the calls, or it `goes_on`.

    Any call but `close` may raise BodyLostError: the process behind the world ended. What was
    asked for has not happened, whatever frames it sent; the body and all others of that
    process are of no more use, and the world can be asked for new ones.
    """

    @property
    def lost(self) -> bool:
        """True if the process behind the world has ended."""

    @property
    def goes_on(self) -> bool:
        """True if time passes in it between the calls; the next call tells what happened."""

    @property
    def tick(self) -> int:
        """The body's latest tick."""

    @property
    def internal_state(self) -> bytes:
        """What goes on in it besides its snapshot's facts, as of the end of the last call."""

    def snapshot(self) -> Snapshot:
        """Return all there is in it now."""

    def run(
        self,
        programs: Mapping[str, str],
        timeout_ticks: int,
        senses: Mapping[str, Sense] | None = None,
        rules: RunRules = AS_USUAL,
    ) -> Mapping[str, ProgramResult]:
        """Run programs by agent, together, until the last has ended.

        Args:
            programs: Their texts.
            timeout_ticks: Ticks after which they are stopped.
            senses: Of agents whose programs may read no more than they are told by this.
            rules: How they run.

        Raises:
            WorldError: An agent is not in this body, or the world cannot run such programs;
                nothing was changed.
            BodyError: The Minecraft side failed.
        """

    def step(self, ticks: int) -> None:
        """Let ticks pass without programs."""

    def set_state(self, snapshot: Snapshot) -> None:
        """Be as the snapshot says, by changing only what differs; no frames are sent."""

    def close(self) -> None:
        """Give the body up, also if it is lost; a second call does nothing."""


class World(Protocol):
    """Where bodies live. If its process has ended, the next body is opened in a new one."""

    @property
    def has_physics(self) -> bool:
        """True if agents in its bodies stand, fall and are stopped by blocks."""

    @property
    def versions(self) -> Mapping[str, str]:
        """Program to version, of what runs."""

    def open_body(self, name: str, seed: str, snapshot: Snapshot, sink: Sink) -> Body:
        """Make a body and fill it.

        Args:
            name: Name of the body in this world, unique.
            seed: Seed of all its random numbers.
            snapshot: What it is filled with.
            sink: Takes its frames.

        Raises:
            BodyLostError: The process behind the world ended meanwhile.
            BodyError: The world could not be started, or failed.
        """

    def another(self) -> "World":
        """One more world of the kind, with nothing in it; it is started with its first body."""

    def interrupt(self) -> None:
        """End what it is doing for another thread, and all its bodies; they are lost."""

    def close(self) -> None:
        """End the world and all its bodies."""
