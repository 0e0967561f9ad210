"""Record of an episode in its run, and ends of programs as their agents perceive them."""

from collections.abc import Mapping
from typing import Any, Protocol

import msgspec

from beliefnest.episodes.decided import Decision, Ended, RoundPart, Spent
from beliefnest.errors import BranchError, InputError, NotBegunError, StoreError
from beliefnest.world.texts import quoted
from beliefnest.worlds.protocol import NO_WAY, ProgramPast, ProgramResult

_BEGINS, _START, _BRANCHES = "episode begins", "episode", "episode branches"
_LAST = "episode branch played last"


class Keeps(Protocol):
    """Protocol of a run from which stored bytes can be read."""

    def kept(self, name: str) -> bytes | None:
        """Return the bytes last stored under a name."""


class Writes(Keeps, Protocol):
    """Protocol of a run in which bytes can be stored."""

    def keep(self, name: str, value: bytes) -> None:
        """Store bytes under a name."""


class Budget(msgspec.Struct, frozen=True, omit_defaults=True):
    """Limits of an episode; None: no limit.

    Attributes:
        ticks: Ticks of the world.
        tokens: Tokens sent to models and received.
        cost: US dollars.
    """

    ticks: int | None = None
    tokens: int | None = None
    cost: float | None = None

    def __post_init__(self) -> None:
        for name, value, least in (
            ("ticks", self.ticks, 1),
            ("tokens", self.tokens, 1),
            ("cost", self.cost, 0),
        ):
            if value is not None and not value >= least:
                raise InputError(
                    f"{name} of a budget is {quoted(value)}; give at least {least}, or None"
                )

    def is_spent(self, ticks: int, spent: Spent) -> bool:
        """Return True if ticks or spending have reached a limit."""
        return (self.ticks is not None and ticks >= self.ticks) or self.fault(spent) is not None

    def fault(self, spent: Spent) -> str | None:
        """Return the limit that spending has reached, in words; None: more may be spent.

        A limit of 0 US dollars admits models that cost nothing.
        """
        if self.tokens is not None and spent.tokens >= self.tokens:
            return f"the episode has used {spent.tokens:,} tokens and may use {self.tokens:,}"
        cost = spent.cost or 0.0
        if self.cost is not None and cost >= self.cost and cost > 0:
            return f"the episode has cost {cost:.2f} US dollars and may cost {self.cost:.2f}"
        return None


class EpisodeStart(msgspec.Struct, frozen=True):
    """Record of an episode's beginning in its run."""

    task: dict[str, Any]
    seed: int
    task_seed: int | None
    world: str
    start: int
    budget: Budget


class Branch(msgspec.Struct, frozen=True):
    """Record of a branch of an episode in its run.

    Attributes:
        policies: Policies by agent, as text.
        parts: Decisions and their results.
        goal: Conditions of the task's goal in words, each with the tick at which it first came
            true.
        reached: Tick at which the task's goal was reached; None: not yet.
        violated: Tick at which the goal was violated; None: it was not.
    """

    policies: dict[str, str]
    parts: list[RoundPart]
    goal: list[tuple[str, int | None]] = []
    reached: int | None = None
    violated: int | None = None


def keep_begins(nest: Writes) -> None:
    """Store a mark that the run is an episode, before the script runs."""
    nest.keep(_BEGINS, b"")


def keep_start(nest: Writes, start: EpisodeStart) -> None:
    """Store the beginning of an episode."""
    nest.keep(_START, msgspec.json.encode(start))


def keep_branch(nest: Writes, name: str, branch: Branch) -> None:
    """Store the record of a branch up to now."""
    kept = nest.kept(_BRANCHES)
    # Other branches stay as they were written.
    branches: dict[str, Any] = msgspec.json.decode(kept or b"{}", type=dict[str, msgspec.Raw])
    branches[name] = branch
    nest.keep(_BRANCHES, msgspec.json.encode(branches))
    if len(branches) > 1 and nest.kept(_LAST) != name.encode():
        nest.keep(_LAST, name.encode())


def played_last(nest: Keeps) -> str | None:
    """Return the branch that was played or begun last; None: there is only one."""
    kept = nest.kept(_LAST)
    return None if kept is None else kept.decode()


def ended_as(decision: Decision, result: ProgramResult | None) -> Ended:
    """Return how a program ended, without facts that its agent could not perceive.

    The error of a skill may reveal what the agent does not see, so the agent learns only that the
    skill failed. `no_way` reveals nothing: paths are planned on ground that the agent knows.
    """
    if decision.fault:
        return Ended("", "lost", "no program came in time, so nothing was done")
    fault = None if result is None else result.error
    if fault is None:
        return Ended(decision.program, "ok" if decision.program else "none")
    if fault.kind == "timeout":
        return Ended(decision.program, "cut", "the round was over first; it may go on")
    if fault.reason == NO_WAY:
        return Ended(decision.program, "no_way", fault.message, fault.line)
    if fault.skill is not None:
        return Ended(decision.program, "failed", f"{fault.skill} did not work", fault.line)
    return Ended(decision.program, "failed", fault.message, fault.line)


def holds_episode(nest: Keeps) -> bool:
    """Return True if there is an episode in a run."""
    return nest.kept(_BRANCHES) is not None


def cut_in(
    results: Mapping[str, ProgramResult],
    ended: Mapping[str, Ended],
    past: Mapping[str, ProgramPast],
    began: int,
    until: int,
) -> dict[str, ProgramPast]:
    """Return the past of programs that were cut, by agent, so that they can go on.

    Args:
        results: Results of the programs of a part.
        ended: How they ended.
        past: Past of the programs that had gone on from earlier parts.
        began: Tick at which the part began.
        until: Tick at which the part ended.
    """
    return {
        agent: ProgramPast(past[agent].tick if agent in past else began, result.calls, until)
        for agent, result in results.items()
        if ended[agent].how == "cut"
    }


def reasons_in(results: Mapping[str, ProgramResult]) -> dict[str, str]:
    """Return the complete reasons of failed programs by agent, for readers of the run only."""
    return {
        agent: str(result.error)
        for agent, result in results.items()
        if result.error is not None and result.error.kind != "timeout"
    }


def kept_in(nest: Keeps) -> tuple[EpisodeStart, dict[str, Branch]]:
    """Return the beginning of a run's episode, and its branches by name.

    Raises:
        NotBegunError: The episode was stopped before the first round.
        StoreError: The run holds no episode, or the episode cannot be read.
    """
    kept, decided = nest.kept(_START), nest.kept(_BRANCHES)
    if kept is None or decided is None:
        if nest.kept(_BEGINS) is not None:
            raise NotBegunError("the episode was stopped before its first round; play it anew")
        raise StoreError("there is no episode in this run; give a run of `beliefnest play`")
    try:
        return (
            msgspec.json.decode(kept, type=EpisodeStart),
            msgspec.json.decode(decided, type=dict[str, Branch]),
        )
    except msgspec.MsgspecError as fault:
        raise StoreError(f"the episode in this run cannot be read: {fault}") from None


def branch_of(branches: Mapping[str, Branch], name: str) -> Branch:
    """Return a branch of an episode; raise BranchError if it does not exist."""
    if name not in branches:
        raise BranchError(f"the episode has no branch {quoted(name)}; it has {', '.join(branches)}")
    return branches[name]
