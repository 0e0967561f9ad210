"""Records of a run besides its timelines: its start, programs and model requests."""

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Literal, TypeVar

import msgspec
from msgspec.structs import replace

from beliefnest.errors import NotBegunError, StoreError
from beliefnest.timeline import codec
from beliefnest.timeline.database import Database, DatabaseRow, checked, checksum
from beliefnest.timeline.journal import FOLLOW, TimelineKey
from beliefnest.world.paths import BeliefPath
from beliefnest.world.texts import quoted

_NUMBER = re.compile(r"-?[0-9]{1,18}", re.ASCII)

Senses = Literal["world", "percepts"]
"""Input of programs: the whole world, or only what their agents perceive or remember."""


class RunRecord(msgspec.Struct, frozen=True):
    """Settings that a run was started with.

    Attributes:
        scenario: Name of the scenario.
        text: Full text of the scenario file.
        condition: Name of the condition; empty if the scenario has none.
        seed: Seed of every random number.
        versions: Versions of the programs at the start of the run, by program name.
        setting: Bytes from which a resumed run builds its nest again; the nest defines their
            format.
        templates: Texts of the prompt templates that the scenario names, by these names.
    """

    scenario: str
    text: str
    condition: str
    seed: int
    versions: Mapping[str, str]
    setting: bytes = b""
    templates: Mapping[str, str] = msgspec.field(default_factory=dict)

    @property
    def condition_number(self) -> int | None:
        """Number of the condition; None: the scenario has none.

        Raises:
            StoreError: It is no number.
        """
        if not self.condition:
            return None
        if not _NUMBER.fullmatch(self.condition):
            raise StoreError(f"the run file names the condition {quoted(self.condition)}")
        return int(self.condition)


class ProgramRecord(msgspec.Struct, frozen=True):
    """An agent program and its result.

    Attributes:
        path: Belief path of the simulator it ran in.
        branch: Branch it ran on.
        agent: Agent that ran it.
        code: Source text of the program.
        tick: Tick at which it began.
        ok: True if it ended without an error.
        error: Error message; None if there was no error.
        ticks: Number of ticks it took.
        group: Number shared by all programs that ran at the same time in one call.
        lines: Numbers of the source lines that ran, from 1, in rising order.
        log: Lines it wrote to its console.
        unfinished: Descriptions of the actions that were still going on when it ended.
        entries: Number of entries in its timeline when it began.
        timeout_ticks: Number of ticks after which it would have been stopped.
        step: Index of its step in the scenario's script, from 0; None if it is not part of a
            script.
        kept: True if its effects were recorded; False if the world's process died under it.
        senses: `world` or `percepts`: what it could read.
        past: Its calls before it was interrupted, if it was resumed; otherwise unset.
        mute: True if the agent could not speak; otherwise unset.
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
    mute: bool | msgspec.UnsetType = msgspec.UNSET


class PromptRecord(msgspec.Struct, frozen=True):
    """One request to a model and its result.

    Attributes:
        path: Belief path from which the request was made.
        timeline: Timeline of this belief: its own, or the timeline of a simulator it follows.
        tick: Tick of that timeline.
        model: Name of the model.
        attempt: 1 for the first request of a conversation, 2 for the request after a fault.
        messages: Role and text of each message that the model received.
        sampling: Sampling parameters.
        answer: Text of the answer; None if there was none.
        error: Error message if there was no answer, otherwise None.
        requests: Number of requests that reached a provider.
        input_tokens: Number of tokens sent.
        output_tokens: Number of tokens received.
        cost: Cost in US dollars; None if a price is unknown.
        cached: True if the answer came from the cache.
        detail: Further facts from the caller.
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
    detail: Mapping[str, str] = msgspec.field(default_factory=dict)

    @property
    def branch(self) -> str:
        """Branch of the simulator that asked; `follow` in follow mode."""
        return self.timeline.branch if self.path == self.timeline.path else FOLLOW


Record = TypeVar("Record", ProgramRecord, PromptRecord)

_VERSIONS = list[dict[str, str]]

_TABLES: Mapping[type, str] = {ProgramRecord: "program", PromptRecord: "prompt"}


def path_to(path: BeliefPath) -> str:
    """Return a belief path as run files store it: a JSON array."""
    return msgspec.json.encode(path).decode()


def path_from(text: str) -> BeliefPath:
    """Parse a stored belief path; StoreError if the text is none."""
    try:
        return msgspec.json.decode(text, type=BeliefPath)
    except msgspec.MsgspecError as fault:
        raise StoreError(f"{quoted(text)} is no stored belief path: {fault}") from fault


class Records:
    """Programs, model requests and settings of a run, stored in tables.

    A record is durable when the call that wrote it returns. Every call may raise StoreError, as the
    calls of the journal may.
    """

    def __init__(self, database: Database) -> None:
        self._database = database

    def set_run(self, run: RunRecord) -> None:
        """Store the settings that the run was started with."""
        self.put_state("run", codec.encode(run))

    def run(self) -> RunRecord:
        """Return the settings that the run was started with; StoreError if there are none."""
        body = self.state("run")
        if body is None:
            raise NotBegunError(
                f"{self._database.path} has no record of what was run: "
                "the run was stopped while it began; start it again"
            )
        return codec.decode(body, RunRecord)

    def add_versions(self, versions: Mapping[str, str]) -> None:
        """Record the versions in use from now on, if they differ from the last known ones."""
        recorded = self.versions()
        now = {**recorded[-1], **versions}
        if now != recorded[-1]:
            self.put_state("versions", codec.encode([*recorded[1:], now]))

    def versions(self) -> tuple[Mapping[str, str], ...]:
        """Return the versions at the start of the run, then those after each change."""
        later = self.state("versions")
        return (self.run().versions, *([] if later is None else codec.decode(later, _VERSIONS)))

    def put_state(self, name: str, value: bytes) -> None:
        """Store bytes under a name and replace the old ones: counters, random states."""
        with self._database.transaction():
            self._database.write("INSERT OR REPLACE INTO meta", name=name, value=value)

    def state(self, name: str) -> bytes | None:
        """Return the bytes last stored under a name; None if there are none."""
        where, what = "meta WHERE name = ?", f"state {quoted(name)}"
        states = self._database.sound_rows("name, value", where, (name,), what, tuple[str, bytes])
        return next((value for _, value in states), None)

    def select(self, path: BeliefPath, branch: str) -> None:
        """Record the branch that a simulator is on."""
        with self._database.transaction():
            into = "INSERT OR REPLACE INTO selected"
            self._database.write(into, path=path_to(path), branch=branch)

    def selected(self) -> dict[BeliefPath, str]:
        """Return the recorded branch of each simulator, in order of paths."""
        in_order, what = "selected ORDER BY path", "the selected branches"
        selections = self._database.sound_rows("path, branch", in_order, (), what, tuple[str, str])
        return {path_from(path): branch for path, branch in selections}

    def add_program(self, program: ProgramRecord) -> None:
        """Append the record of a program that has ended."""
        self._add(program, TimelineKey(program.path, program.branch))

    def next_group(self) -> int:
        """Return an unused group number for programs that run at the same time."""
        # SQLite's sequence also counts deleted rows, so no number is given out twice.
        row = self._database.row("SELECT seq FROM sqlite_sequence WHERE name = 'program'")
        return 1 if row is None else int(row[0]) + 1

    def programs(self) -> Sequence[ProgramRecord]:
        """Return the records of all programs, in the order in which they ended."""
        return self._all(ProgramRecord)

    def add_prompt(self, prompt: PromptRecord) -> None:
        """Append the record of a request to a model."""
        self._add(prompt, prompt.timeline)

    def prompts(self) -> Sequence[PromptRecord]:
        """Return the records of all requests to models, in order."""
        return self._all(PromptRecord)

    def follow_rename(self, path: BeliefPath, branch: str, name: str) -> None:
        """Update all records that name a renamed branch; the caller opens the transaction."""
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
        """Remove all records of a deleted branch; the caller opens the transaction."""
        where = (path_to(path), branch)
        for table in ("selected", *_TABLES.values()):
            self._database.execute(f"DELETE FROM {table} WHERE path = ? AND branch = ?", where)

    def _add(self, record: ProgramRecord | PromptRecord, key: TimelineKey) -> None:
        """Append a record that is renamed and deleted together with its timeline."""
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
        # Renaming a branch changes the column only; the body still has the old name.
        return tuple(
            _with_branch(codec.decode(body, kind), branch) for _, (_, branch, body) in rows
        )

    def _rows(
        self, table: str, where: str, values: DatabaseRow
    ) -> Iterator[tuple[int, DatabaseRow]]:
        rows = self._database.rows(
            f"SELECT id, path, branch, body, seal FROM {table} {where} ORDER BY id", values
        )
        for number, *row in rows:
            what = f"{table} {quoted(number)}"
            yield number, checked(tuple(row), self._database.path, what, tuple[str, str, bytes])


def _with_branch(record: Record, branch: str) -> Record:
    if isinstance(record, PromptRecord):
        return replace(record, timeline=replace(record.timeline, branch=branch))
    return replace(record, branch=branch)
