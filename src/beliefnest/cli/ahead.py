"""Start of the embedded world ahead of a command's own imports, so that both go on at once."""

from collections.abc import Iterator
from contextlib import contextmanager, suppress

from beliefnest.errors import BodyError
from beliefnest.world.seeds import checked_seed
from beliefnest.worlds.minecraft.launching import Launch
from beliefnest.worlds.process_limits import ProcessLimits

__all__ = ["ahead"]


@contextmanager
def ahead(world: str, seed: int) -> Iterator[Launch | None]:
    """Launch Node for a command, if its world is the embedded one; kill it if it is not used.

    A failure is not told here: a world that gets no launch starts Node again and tells it.

    Raises:
        InputError: The seed is not a whole number of 64 bits.
    """
    checked_seed(seed, "--seed")
    launch = None
    if world == "embedded":
        with suppress(BodyError):
            launch = Launch.begin(seed, ProcessLimits())
    try:
        yield launch
    finally:
        if launch is not None:
            launch.kill()
