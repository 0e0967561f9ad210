"""What was decided in a part of a round, and how that ended, as a run keeps it."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import msgspec

from beliefnest.bodies.protocol import ProgramPast

__all__ = [
    "Decision",
    "Ended",
    "HowEnded",
    "Part",
    "Spent",
    "latest_end",
    "programs_of",
    "spent_in",
]

HowEnded = Literal["none", "ok", "cut", "no_way", "failed", "lost"]


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
    """

    decisions: dict[str, Decision]
    ended: dict[str, Ended] = {}
    cut: dict[str, ProgramPast] = {}
    began: int | None = None


def latest_end(parts: Sequence[Part], agent: str) -> Ended:
    """How an agent's latest program ended."""
    return next((p.ended[agent] for p in reversed(parts) if agent in p.ended), Ended())


def programs_of(parts: Sequence[Part], agent: str) -> tuple[str, ...]:
    """What was decided for an agent, round by round."""
    return tuple(p.decisions[agent].program for p in parts if agent in p.decisions)


def spent_in(parts: Sequence[Part]) -> Spent:
    """What policies have spent on models."""
    return sum((each.spent for part in parts for each in part.decisions.values()), Spent())
