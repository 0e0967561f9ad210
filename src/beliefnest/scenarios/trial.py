"""Trial: the run of one program of a probe, as it is judged; Python functions that judge it."""

from collections.abc import Callable, Iterable

import msgspec

from beliefnest.belief.view import State
from beliefnest.errors import InputError
from beliefnest.importing import imported_object
from beliefnest.world.event_kinds import EventKind
from beliefnest.world.texts import quoted
from beliefnest.world.values import Event, Point, Position
from beliefnest.worlds.protocol import ProgramResult


def opened_by(agent: str, events: Iterable[Event]) -> tuple[Position, ...]:
    """Return the containers that an agent opened, in order."""
    return tuple(
        tuple(event.detail["position"])
        for event in events
        if event.kind is EventKind.OPEN_CONTAINER and event.actor == agent
    )


class Trial(msgspec.Struct, frozen=True):
    """Run of a program.

    Attributes:
        agent: Name of the agent that ran it.
        program: Text of the program.
        branch: Branch on which it ran.
        result: Result of the program, with the calls and acts of its agent.
        state: State of its simulator at the end.
        belief: Function from a belief path to the state at the end of the program; valid only
            while the trial is judged.
    """

    agent: str
    program: str
    branch: str
    result: ProgramResult
    state: State
    belief: Callable[[str], State]

    @property
    def opened(self) -> tuple[Position, ...]:
        """Return the containers that the agent opened, in order."""
        return opened_by(self.agent, self.result.events)

    @property
    def arrived(self) -> Point | None:
        """Return the agent's place at the end; None if it was not there."""
        return self.state.agents[self.agent].position

    @property
    def used(self) -> tuple[Point, ...]:
        """Return the places that the program asked to use, in order."""
        return tuple(a.place for a in self.result.aims if a.uses and a.place is not None)

    @property
    def walked(self) -> tuple[Point, ...]:
        """Return the goals of the walks that the program asked for, in order."""
        return tuple(a.place for a in self.result.aims if not a.uses and a.place is not None)

    @property
    def intended(self) -> Point | None:
        """Return the first place it asked to use, else the last goal of a walk, in blocks."""
        return self.used[0] if self.used else self.walked[-1] if self.walked else None


class NamedFunction(msgspec.Struct, frozen=True):
    """Function of a module, which is imported when it is first needed.

    Attributes:
        module: Name of a module on Python's path.
        function: Name of a function in the module.
    """

    module: str
    function: str

    def __call__(self, trial: Trial) -> bool | str:
        """Call the function with a trial."""
        return self.loaded()(trial)

    def loaded(self) -> Callable[[Trial], bool | str]:
        """Return the function.

        Raises:
            InputError: The module or function does not exist.
        """
        function = imported_object(f"{self.module}:{self.function}", "judging function")
        if not callable(function):
            raise InputError(f"{quoted(self.function)} in {quoted(self.module)} is no function")
        return function


def function_of(written: object) -> tuple[Callable[[Trial], bool | str], str]:
    """Return the function that a scenario names, and its name in tables.

    Raises:
        InputError: The value is neither a function nor a text `module:function`.
    """
    if callable(written):
        return written, getattr(written, "__name__", "the judging function")
    if isinstance(written, str):
        module, _, function = written.partition(":")
        if function.isidentifier() and all(part.isidentifier() for part in module.split(".")):
            return NamedFunction(module, function), function
    raise InputError(f"{quoted(written)} is no function; give one as module:function")
