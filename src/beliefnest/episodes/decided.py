"""What was decided in a part of a round, and how that ended, as a run keeps it."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import msgspec

from beliefnest.bodies.protocol import ProgramPast

__all__ = [
    "Decision",
    "Ended",
    "Failure",
    "HowEnded",
    "Part",
    "Spent",
    "failures_in",
    "latest_end",
    "programs_of",
    "spent_in",
]

HowEnded = Literal["none", "ok", "cut", "no_way", "failed", "lost"]
_FAILED = ("no_way", "failed", "lost")


class Spent(msgspec.Struct, frozen=True):
    """What a policy has spent on models.

    Attributes:
        requests: Requests that reached a provider.
        tokens: Sent and received.
        cost: US dollars; None where a price is not known.
    """

    requests: int = 0
    tokens: int = 0
    cost: float | None = 0.0

    def __add__(self, other: "Spent") -> "Spent":
        unknown = self.cost is None or other.cost is None
        cost = None if unknown else (self.cost or 0.0) + (other.cost or 0.0)
        return Spent(self.requests + other.requests, self.tokens + other.tokens, cost)

    def __sub__(self, other: "Spent") -> "Spent":
        unknown = self.cost is None or other.cost is None
        cost = None if unknown else (self.cost or 0.0) - (other.cost or 0.0)
        return Spent(self.requests - other.requests, self.tokens - other.tokens, cost)


class Decision(msgspec.Struct, frozen=True):
    """What a policy decided for a round.

    Attributes:
        program: The program; empty: nothing.
        fault: Why there is none; empty: it is as the policy wanted.
        spent: What that took.
        goes_on: Whether it is the last one, which was cut, and goes on from there.
    """

    program: str = ""
    fault: str = ""
    spent: Spent = Spent()
    goes_on: bool = False


@dataclass(frozen=True, slots=True)
class Ended:
    """How an agent's latest program ended, as the agent itself could tell.

    Attributes:
        program: Its text; empty if there was none.
        how: `ok`; `cut` at the round's end; `no_way` on foot as far as the agent knows; `failed`;
            `lost`: there was none, since the policy gave none in time; `none`: nothing was to do.
        message: What went wrong, in words; empty if nothing did.
    """

    program: str = ""
    how: HowEnded = "none"
    message: str = ""


class Part(msgspec.Struct, frozen=True):
    """What was decided by who acts together, and how that ended.

    Attributes:
        decisions: By agent.
        ended: By agent; empty until it is done.
        cut: Of agents whose programs were cut, what these had done.
        began: The tick at which it began in real time; None: where time stands still meanwhile.
        reasons: Of agents whose programs failed, the whole reason. It is for readers of the run:
            the agents are told no more than `ended` says.
    """

    decisions: dict[str, Decision]
    ended: dict[str, Ended] = {}
    cut: dict[str, ProgramPast] = {}
    began: int | None = None
    reasons: dict[str, str] = {}

    def reason(self, agent: str) -> str:
        """Return why an agent's program failed, was cut or is missing; empty: it ended well."""
        told = self.ended[agent].message if agent in self.ended else ""
        return self.reasons.get(agent) or self.decisions[agent].fault or told


@dataclass(frozen=True, slots=True)
class Failure:
    """A program that failed in an episode, or that a policy did not give.

    Attributes:
        round: The round, from 0.
        agent: Whose program.
        ended: `failed`, `no_way` or `lost`, as in `Ended.how`.
        reason: What went wrong, in words, with the line of the program.
    """

    round: int
    agent: str
    ended: HowEnded
    reason: str

    def __str__(self) -> str:
        return f"round {self.round + 1}, {self.agent}: {self.reason}"


def failures_in(parts: Sequence[Part], per_round: int) -> tuple[Failure, ...]:
    """Return the failures in parts of rounds.

    Args:
        parts: The parts, from the first round on.
        per_round: How many parts a round has.
    """
    return tuple(
        Failure(number // per_round, agent, ended.how, part.reason(agent))
        for number, part in enumerate(parts)
        for agent, ended in part.ended.items()
        if ended.how in _FAILED
    )


def latest_end(parts: Sequence[Part], agent: str) -> Ended:
    """How an agent's latest program ended."""
    return next((p.ended[agent] for p in reversed(parts) if agent in p.ended), Ended())


def programs_of(parts: Sequence[Part], agent: str) -> tuple[str, ...]:
    """What was decided for an agent, round by round."""
    return tuple(p.decisions[agent].program for p in parts if agent in p.decisions)


def spent_in(parts: Sequence[Part]) -> Spent:
    """What policies have spent on models."""
    return sum((each.spent for part in parts for each in part.decisions.values()), Spent())
