"""What a run keeps besides its timelines: what ran, with which results."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal, Protocol, TypeVar

import msgspec

from beliefnest.errors import NotBegunError, StoreError
from beliefnest.timeline import codec
from beliefnest.timeline.database import Database, Row, checked, checksum
from beliefnest.timeline.journal import FOLLOW, Journal, TimelineKey
from beliefnest.world.paths import BeliefPath

__all__ = [
    "ProgramRecord",
    "PromptRecord",
    "Records",
    "RunJournal",
    "RunRecord",
    "Senses",
    "path_from",
    "path_to",
]

Senses = Literal["world", "percepts"]
"""What programs read: everything there is, or what their agents perceive or remember."""


@dataclass(frozen=True, slots=True)
class RunRecord:
    """What a run was started with.

    Attributes:
        scenario: Name of the scenario.
        text: The scenario file, whole.
        condition: Name of the condition; empty if the scenario has none.
        seed: Seed of every random number.
        versions: Program to version, of everything that ran when it began.
        setting: What the nest needs to be made again, in its own format.
        templates: Texts of the prompt templates that the scenario names, by these names.
    """

    scenario: str
    text: str
    condition: str
    seed: int
    versions: Mapping[str, str]
    setting: bytes = b""
    templates: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class ProgramRecord:
    """An agent program and how it ended.

    Attributes:
        path: Belief path of the simulator it ran in.
        branch: Branch it ran on.
        agent: Agent that ran it.
        code: Its text.
        tick: Tick it began at.
        ok: Whether it ended without an error.
        error: The error's message; None if it ended well.
        ticks: How many ticks it took.
        group: Programs that ran at the same time in one call share a number.
        lines: Lines of its text that ran, from 1, rising.
        log: What it wrote to its console.
        unfinished: What was still going on when it ended, in words.
        entries: How many entries its timeline had when it began.
        timeout_ticks: Ticks after which it would have been stopped.
        step: Number of the script's step that it is part of, from 0; None: it is in no script.
        kept: Whether what it did was recorded; not if the world's process ended under it.
        senses: What it read; files of earlier versions, which do not say it, are read as `world`.
        past: What it had done when it was cut, from where it went on; unset if it began anew.
    """

    path: BeliefPath
    branch: str
    agent: str
    code: str
    tick: int
    ok: bool
    error: str | None
    ticks: int
    group: int = 0
    lines: tuple[int, ...] = ()
    log: tuple[str, ...] = ()
    unfinished: tuple[str, ...] = ()
    entries: int = 0
    timeout_ticks: int = 0
    step: int | None = None
    kept: bool = True
    senses: Senses = "world"
    past: bytes | msgspec.UnsetType = msgspec.UNSET


@dataclass(frozen=True, slots=True)
class PromptRecord:
    """One request to a model and what came of it.

    Attributes:
        path: Belief path it was made from.
        timeline: The timeline that this belief was on: its own or that of a simulator it follows.
        tick: Tick of that timeline.
        model: Name of the model.
        attempt: 1 for the first request of a conversation, 2 for the one after a fault.
        messages: What the model received: role and text of each message.
        sampling: How the answer was to be drawn.
        answer: The text it gave; None if it gave none.
        error: Why it gave none; None if it gave one.
        requests: Requests that reached a provider.
        input_tokens: Tokens sent.
        output_tokens: Tokens received.
        cost: US dollars; None where a price is not known.
        cached: Whether the answer had been kept from another time.
        detail: Further facts of the caller.
    """

    path: BeliefPath
    timeline: TimelineKey
    tick: int
    model: str
    attempt: int
    messages: tuple[tuple[str, str], ...]
    sampling: Mapping[str, float | int | None]
    answer: str | None
    error: str | None
    requests: int = 0
    input_tokens: int = 0
    output_tokens: int = 0
    cost: float | None = 0.0
    cached: bool = False
    detail: Mapping[str, str] = field(default_factory=dict)

    @property
    def branch(self) -> str:
        """The branch its simulator was on; `follow` in follow mode."""
        return self.timeline.branch if self.path == self.timeline.path else FOLLOW


Record = TypeVar("Record", ProgramRecord, PromptRecord)

_VERSIONS = list[dict[str, str]]

_TABLES: Mapping[type, str] = {ProgramRecord: "program", PromptRecord: "prompt"}


def path_to(path: BeliefPath) -> str:
    """Return a belief path as a run file holds it: a JSON array."""
    return msgspec.json.encode(path).decode()


def path_from(text: str) -> BeliefPath:
    """Return the belief path of a column; StoreError if it holds none."""
    try:
        return msgspec.json.decode(text, type=BeliefPath)
    except msgspec.MsgspecError as fault:
        raise StoreError(f"{text!r} is no stored belief path: {fault}") from fault


class Records:
    """What ran in a run: set once or appended, durable when the call returns.

    Every call may raise StoreError, as those of the journal.
    """

    def __init__(self, database: Database) -> None:
        self._database = database

    def set_run(self, run: RunRecord) -> None:
        """Set what the run was started with."""
        self.put_state("run", codec.encode(run))

    def run(self) -> RunRecord:
        """What the run was started with; StoreError if that was never set."""
        body = self.state("run")
        if body is None:
            raise NotBegunError(
                f"{self._database.path} does not say what was run; "
                "the run was stopped while it began: start it again"
            )
        return codec.decode(body, RunRecord)

    def add_versions(self, versions: Mapping[str, str]) -> None:
        """Note what runs from now on, if it is not what ran before."""
        known = self.versions()
        now = {**known[-1], **versions}
        if now != known[-1]:
            self.put_state("versions", codec.encode([*known[1:], now]))

    def versions(self) -> tuple[Mapping[str, str], ...]:
        """Return the program to version, when the run began and whenever it went on with others."""
        later = self.state("versions")
        return (self.run().versions, *([] if later is None else codec.decode(later, _VERSIONS)))

    def put_state(self, name: str, value: bytes) -> None:
        """Keep bytes under a name, in place of those before: counters, random states."""
        with self._database.transaction():
            self._database.write("INSERT OR REPLACE INTO meta", name=name, value=value)

    def state(self, name: str) -> bytes | None:
        """Return the bytes last put under a name; None if there are none."""
        where, what = "meta WHERE name = ?", f"state {name!r}"
        found = self._database.sound_rows("name, value", where, (name,), what)
        return next((bytes(value) for _, value in found), None)

    def select(self, path: BeliefPath, branch: str) -> None:
        """Note which branch a simulator is on."""
        with self._database.transaction():
            into = "INSERT OR REPLACE INTO selected"
            self._database.write(into, path=path_to(path), branch=branch)

    def selected(self) -> dict[BeliefPath, str]:
        """Return the branch each simulator is on, of those `select` named, in order of paths."""
        in_order, what = "selected ORDER BY path", "the selected branches"
        found = self._database.sound_rows("path, branch", in_order, (), what)
        return {path_from(path): branch for path, branch in found}

    def add_program(self, program: ProgramRecord) -> None:
        """Append a program that has ended."""
        self._add(program, TimelineKey(program.path, program.branch))

    def next_group(self) -> int:
        """Return a number for programs that run at the same time, which none before has had."""
        # The sequence outlives deleted rows.
        row = self._database.row("SELECT seq FROM sqlite_sequence WHERE name = 'program'")
        return 1 if row is None else int(row[0]) + 1

    def programs(self) -> Sequence[ProgramRecord]:
        """Return all programs, in order of their end."""
        return self._all(ProgramRecord)

    def add_prompt(self, prompt: PromptRecord) -> None:
        """Append a request to a model with what came of it."""
        self._add(prompt, prompt.timeline)

    def prompts(self) -> Sequence[PromptRecord]:
        """Return all requests to models, in order."""
        return self._all(PromptRecord)

    def follow_rename(self, path: BeliefPath, branch: str, name: str) -> None:
        """Let all that names a branch name it anew; the caller opens the transaction."""
        if self.selected().get(path) == branch:
            self.select(path, name)
        text = path_to(path)
        for table in _TABLES.values():
            for number, row in self._rows(table, "WHERE path = ? AND branch = ?", (text, branch)):
                self._database.execute(
                    f"UPDATE {table} SET branch = ?, seal = ? WHERE id = ?",
                    (name, checksum(text, name, row[2]), number),
                )

    def forget_branch(self, path: BeliefPath, branch: str) -> None:
        """Remove what belongs to a deleted branch; the caller opens the transaction."""
        where = (path_to(path), branch)
        for table in ("selected", *_TABLES.values()):
            self._database.execute(f"DELETE FROM {table} WHERE path = ? AND branch = ?", where)

    def _add(self, record: ProgramRecord | PromptRecord, key: TimelineKey) -> None:
        """Append a record, to be renamed and deleted with a timeline."""
        body = codec.encode(record)
        with self._database.transaction():
            self._database.write(
                f"INSERT INTO {_TABLES[type(record)]}",
                path=path_to(key.path),
                branch=key.branch,
                body=body,
            )

    def _all(self, kind: type[Record]) -> tuple[Record, ...]:
        rows = self._rows(_TABLES[kind], "", ())
        # The column is right where the branch was renamed after the record was written.
        return tuple(
            _with_branch(codec.decode(body, kind), branch) for _, (_, branch, body) in rows
        )

    def _rows(self, table: str, where: str, values: Row) -> Iterator[tuple[int, Row]]:
        rows = self._database.rows(
            f"SELECT id, path, branch, body, seal FROM {table} {where} ORDER BY id", values
        )
        for number, *row in rows:
            yield number, checked(tuple(row), self._database.path, f"{table} {number}")


class RunJournal(Journal, Protocol):
    """A journal that keeps what ran together with its timelines."""

    @property
    def records(self) -> Records:
        """What ran; it follows timelines that are renamed or deleted."""


def _with_branch(record: Record, branch: str) -> Record:
    if isinstance(record, PromptRecord):
        return replace(record, timeline=replace(record.timeline, branch=branch))
    return replace(record, branch=branch)
