"""Python functions that judge probes, given in code or named in a file."""

from collections.abc import Callable
from dataclasses import dataclass

from beliefnest.errors import InputError
from beliefnest.importing import imported_object
from beliefnest.scenarios.trial import Trial
from beliefnest.world.texts import quoted


@dataclass(frozen=True, slots=True)
class NamedFunction:
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
        found = imported_object(f"{self.module}:{self.function}", "judging function")
        if not callable(found):
            raise InputError(f"{quoted(self.function)} in {quoted(self.module)} is no function")
        return found


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
