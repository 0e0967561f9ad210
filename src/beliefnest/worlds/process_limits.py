"""Limits of the process behind a world."""

from dataclasses import dataclass

from beliefnest.errors import InputError


@dataclass(frozen=True, slots=True)
class ProcessLimits:
    """Limits of Node; a process that exceeds them is killed or ends, and is then replaced.

    Programs have budgets of their own, which are far lower (SECURITY.md). These limits are for
    failures that the budgets did not stop. They are generous, so that no slow machine comes near
    them.

    Attributes:
        silence: Seconds without a heartbeat during a request. Frames, ticks that pass and programs
            that compute within their budget count as heartbeats.
        heap: Megabytes of JavaScript objects.
        memory: Megabytes of writable memory in total, about a thousand of which V8 reserves without
            using them; enforced by the operating system, on Linux only.

    Raises:
        InputError: A limit is too small for Node.
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
