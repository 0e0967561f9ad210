"""How much the process behind a world may take."""

from dataclasses import dataclass

from beliefnest.errors import InputError

__all__ = ["ProcessLimits"]


@dataclass(frozen=True, slots=True)
class ProcessLimits:
    """What Node may take; beyond that it is killed or ends, and another one takes its place.

    Programs have budgets of their own, which are far below (SECURITY.md). These bounds are for
    what those budgets did not stop, so they are generous: no slow machine comes near them.

    Attributes:
        silence: Seconds without any sign of life while a request is under way. Frames,
            ticks that pass and programs that compute within their budget are signs of life.
        heap: Megabytes of JavaScript objects.
        memory: Megabytes of writable memory in all, about a thousand of which V8 reserves without
            using them; held by the operating system, on Linux only.

    Raises:
        InputError: A limit is too small for Node to live with.
    """

    silence: float = 60.0
    heap: int = 1024
    memory: int = 4096

    def __post_init__(self) -> None:
        for name, least in (("silence", 0.1), ("heap", 64), ("memory", 2048)):
            if not getattr(self, name) >= least:
                raise InputError(
                    f"the limit {name} is {getattr(self, name)}; give at least {least}"
                )
