"""What one program of a probe did, as it is judged."""

from collections.abc import Callable
from dataclasses import dataclass

from beliefnest.belief.view import State
from beliefnest.bodies.protocol import ProgramResult
from beliefnest.world.values import Point, Position

__all__ = ["Trial"]


@dataclass(frozen=True)
class Trial:
    """A program that was run, and what it did.

    Attributes:
        agent: Who ran it.
        program: Its text.
        branch: The branch that it ran on.
        result: What became of it; what its agent asked for and did is in there.
        state: The simulator it ran in, at its end.
        belief: Given a belief path, its state at the program's end; of use while it is judged.
        opened: The containers that the agent opened, in order.
    """

    agent: str
    program: str
    branch: str
    result: ProgramResult
    state: State
    belief: Callable[[str], State]
    opened: tuple[Position, ...]

    @property
    def arrived(self) -> Point | None:
        """Where the agent stood in the end; None if it was not there."""
        return self.state.agents[self.agent].position

    @property
    def used(self) -> tuple[Point, ...]:
        """What the program asked to use, in order."""
        return tuple(a.place for a in self.result.aims if a.uses and a.place is not None)

    @property
    def walked(self) -> tuple[Point, ...]:
        """Where the program asked to walk, in order."""
        return tuple(a.place for a in self.result.aims if not a.uses and a.place is not None)

    @property
    def intended(self) -> Point | None:
        """The first thing it asked to use, else the last place it asked to walk to, in blocks."""
        return self.used[0] if self.used else self.walked[-1] if self.walked else None
