"""Decisions in parts of rounds and their results, as a run records them."""

from collections.abc import Sequence
from typing import Literal

import msgspec

from beliefnest.episodes.considered import SearchTrace
from beliefnest.worlds.protocol import Fault, ProgramPast

HowEnded = Literal["none", "ok", "cut", "no_way", "failed", "lost"]


class Spent(msgspec.Struct, frozen=True):
    """Spending of a policy on models.

    Attributes:
        requests: Number of requests that reached a provider.
        tokens: Tokens sent and received.
        cost: US dollars; None if a price is not known.
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
    """Decision of a policy for a round.

    Attributes:
        program: The program; empty: the agent does nothing.
        fault: Reason why the policy gave no program; empty: there was no error.
        spent: Spending of the decision.
        goes_on: True if the program is the previous one, which was cut, and continues.
        considered: Courses that the policy tried first; None: it recorded none.
        outcome: Outcome of a model's answer without a program, such as `unread` or `cut`; empty:
            there was none.
        asked_again: Number of answers without a program after which the model was asked again.
    """

    program: str = ""
    fault: str = ""
    spent: Spent = Spent()
    goes_on: bool = False
    considered: SearchTrace | None = None
    outcome: str = ""
    asked_again: int = 0


class Ended(msgspec.Struct, frozen=True):
    """End of an agent's latest program, as the agent itself perceives it.

    Attributes:
        program: Text of the program; empty if there was none.
        how: `ok`; `cut` at the end of the round; `no_way` on foot, as far as the agent knows;
            `failed`; `lost`: the policy gave no program in time; `none`: the policy chose to do
            nothing.
        error: Error in words, without its line; empty if there was none.
        line: Line of the program, from 1; None if unknown.
    """

    program: str = ""
    how: HowEnded = "none"
    error: str = msgspec.field(default="", name="message")
    line: int | None = None

    @property
    def message(self) -> str:
        """Return the error in words, with its line; empty if there was none."""
        return str(Fault(self.error, line=self.line))

    @property
    def has_failed(self) -> bool:
        """Return True if the program failed or is missing."""
        return self.how in ("no_way", "failed", "lost")


class RoundPart(msgspec.Struct, frozen=True):
    """Part of a round: decisions of agents that act together, and their results.

    Attributes:
        decisions: Decisions by agent.
        ended: Ends of programs by agent; empty until the part is played.
        cut: Past of programs that were cut, by agent.
        began: Tick at which the part began in real time; None: the world waits for decisions.
        reasons: Complete reasons of failed programs, by agent. They are for readers of the run:
            agents learn only what `ended` says.
    """

    decisions: dict[str, Decision]
    ended: dict[str, Ended] = {}
    cut: dict[str, ProgramPast] = {}
    began: int | None = None
    reasons: dict[str, str] = {}

    def reason(self, agent: str) -> str:
        """Return why an agent's program failed, was cut or is missing; empty if it ended well."""
        message = self.ended[agent].message if agent in self.ended else ""
        return self.reasons.get(agent) or self.decisions[agent].fault or message


class Failure(msgspec.Struct, frozen=True):
    """Failed or missing program in an episode.

    Attributes:
        round: Number of the round, from 0.
        agent: Name of the agent.
        ended: `failed`, `no_way` or `lost`, as in `Ended.how`.
        reason: Error in words, with the line of the program.
    """

    round: int
    agent: str
    ended: HowEnded
    reason: str

    def __str__(self) -> str:
        return f"round {self.round + 1}, {self.agent}: {self.reason}"


def failures_in(parts: Sequence[RoundPart], per_round: int) -> tuple[Failure, ...]:
    """Return the failures in parts of rounds.

    Args:
        parts: Parts from the first round on.
        per_round: Number of parts in a round.
    """
    return tuple(
        Failure(number // per_round, agent, ended.how, part.reason(agent))
        for number, part in enumerate(parts)
        for agent, ended in part.ended.items()
        if ended.has_failed
    )


def latest_end(parts: Sequence[RoundPart], agent: str) -> Ended:
    """Return the end of an agent's latest program."""
    return next((p.ended[agent] for p in reversed(parts) if agent in p.ended), Ended())


def programs_of(parts: Sequence[RoundPart], agent: str) -> tuple[str, ...]:
    """Return the programs of an agent, round by round."""
    return tuple(p.decisions[agent].program for p in parts if agent in p.decisions)


def spent_in(parts: Sequence[RoundPart]) -> Spent:
    """Return the spending of policies on models."""
    return sum((each.spent for part in parts for each in part.decisions.values()), Spent())
