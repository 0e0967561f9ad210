"""What a run keeps of its episode, and how programs ended as their agents could tell."""

from collections.abc import Mapping
from typing import Any, Protocol

import msgspec

from beliefnest.bodies.protocol import NO_WAY, Fault, ProgramPast, ProgramResult
from beliefnest.episodes.decided import Decision, Ended, Part, Spent
from beliefnest.errors import BranchError, InputError, NotBegunError, StoreError

__all__ = [
    "Branch",
    "Budget",
    "EpisodeStart",
    "Keeps",
    "branch_of",
    "cut_in",
    "ended_as",
    "holds_episode",
    "keep_begins",
    "keep_branch",
    "keep_start",
    "kept_in",
    "reasons_in",
]

_BEGINS, _START, _BRANCHES = "episode begins", "episode", "episode branches"


class Keeps(Protocol):
    """A run that bytes were kept in."""

    def kept(self, name: str) -> bytes | None:
        """Return the bytes last kept under a name."""


class Writes(Keeps, Protocol):
    """A run that bytes can be kept in."""

    def keep(self, name: str, value: bytes) -> None:
        """Keep bytes under a name."""


class Budget(msgspec.Struct, frozen=True, omit_defaults=True):
    """What an episode may take; None: as much as it needs.

    Attributes:
        ticks: Ticks of the world.
        tokens: Sent to models and received.
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
                raise InputError(f"{name} of a budget is {value!r}; give at least {least}, or None")

    def is_spent(self, ticks: int, spent: Spent) -> bool:
        """Return True if nothing is left after so many ticks, and what policies have spent."""
        return (
            (self.ticks is not None and ticks >= self.ticks)
            or (self.tokens is not None and spent.tokens >= self.tokens)
            or (self.cost is not None and spent.cost is not None and spent.cost >= self.cost)
        )


class EpisodeStart(msgspec.Struct, frozen=True):
    """What a run keeps of its episode at the beginning."""

    task: dict[str, Any]
    seed: int
    task_seed: int | None
    world: str
    start: int
    budget: Budget


class Branch(msgspec.Struct, frozen=True):
    """What a run keeps of an episode's branch.

    Attributes:
        policies: By agent, in words.
        parts: What was decided.
        goal: The task's conditions in words, each with the tick at which it came true first.
        reached: The tick at which the task's goal was reached; None: not yet.
        violated: The tick at which something happened that must not; None: nothing has.
    """

    policies: dict[str, str]
    parts: list[Part]
    goal: list[tuple[str, int | None]] = []
    reached: int | None = None
    violated: int | None = None


def keep_begins(nest: Writes) -> None:
    """Keep that there is to be an episode, before what comes before its first round."""
    nest.keep(_BEGINS, b"")


def keep_start(nest: Writes, start: EpisodeStart) -> None:
    """Keep what an episode begins with."""
    nest.keep(_START, msgspec.json.encode(start))


def keep_branch(nest: Writes, name: str, branch: Branch) -> None:
    """Keep what has been decided on a branch by now."""
    kept = nest.kept(_BRANCHES)
    branches = {} if kept is None else msgspec.json.decode(kept, type=dict[str, Branch])
    branches[name] = branch
    nest.keep(_BRANCHES, msgspec.json.encode(branches))


def ended_as(decision: Decision, result: ProgramResult | None) -> Ended:
    """How a program ended, without what its agent could not perceive.

    What a skill says of the world may rest on what the agent does not see: it learns only that the
    skill did not work. Ways are looked for on ground that it knows.
    """
    if decision.fault:
        return Ended("", "lost", "no program came in time, so nothing was done")
    fault = None if result is None else result.error
    if fault is None:
        return Ended(decision.program, "ok" if decision.program else "none")
    if fault.kind == "timeout":
        return Ended(decision.program, "cut", "the round was over first; it may go on")
    if fault.reason == NO_WAY:
        return Ended(decision.program, "no_way", str(fault))
    if fault.skill is not None:
        told = Fault(f"{fault.skill} did not work", line=fault.line)
        return Ended(decision.program, "failed", str(told))
    return Ended(decision.program, "failed", str(fault))


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
    """What programs had done that were cut, by agent.

    Args:
        results: What became of the programs of a part.
        ended: How they ended.
        past: What those had done that went on.
        began: The tick at which the part began.
        until: The tick at which it was over.
    """
    return {
        agent: ProgramPast(past[agent].tick if agent in past else began, result.calls, until)
        for agent, result in results.items()
        if ended[agent].how == "cut"
    }


def reasons_in(results: Mapping[str, ProgramResult]) -> dict[str, str]:
    """Return why programs failed, by agent, with what their agents could not perceive."""
    return {
        agent: str(result.error)
        for agent, result in results.items()
        if result.error is not None and result.error.kind != "timeout"
    }


def kept_in(nest: Keeps) -> tuple[EpisodeStart, dict[str, Branch]]:
    """What a run's episode began with, and its branches by name.

    Raises:
        NotBegunError: It was stopped before the first round.
        StoreError: There is no episode in it, or it cannot be read.
    """
    kept, decided = nest.kept(_START), nest.kept(_BRANCHES)
    if kept is None or decided is None:
        if nest.kept(_BEGINS) is not None:
            raise NotBegunError("the episode was stopped before its first round; play it anew")
        raise StoreError("there is no episode in this run: it was made by another command")
    try:
        return (
            msgspec.json.decode(kept, type=EpisodeStart),
            msgspec.json.decode(decided, type=dict[str, Branch]),
        )
    except msgspec.MsgspecError as fault:
        raise StoreError(f"the episode in this run cannot be read: {fault}") from None


def branch_of(branches: Mapping[str, Branch], name: str) -> Branch:
    """Return an episode's branch; BranchError if it has none of that name."""
    if name not in branches:
        raise BranchError(f"the episode has no branch {name!r}; it has {', '.join(branches)}")
    return branches[name]
