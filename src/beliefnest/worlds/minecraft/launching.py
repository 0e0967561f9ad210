"""Start of Node, which goes on beside Python's own start.

This module imports neither NumPy nor a kernel, so that a command can launch Node first and import
everything else while Node loads the world.
"""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from beliefnest.errors import BodyError, BodyLostError
from beliefnest.importing import part
from beliefnest.world.seeds import checked_seed
from beliefnest.world.shell_limits import low_limits
from beliefnest.worlds.minecraft.channel import PROTOCOL, Channel
from beliefnest.worlds.minecraft.node_files import EMBEDDED, node_command
from beliefnest.worlds.process_limits import ProcessLimits

if TYPE_CHECKING:
    from beliefnest.worlds.protocol import World

MINECRAFT = "1.20.4"
"""Minecraft version of the embedded world."""


class Launch:
    """Node process that was asked for an empty world; made by `Launch.begin`.

    Either a world takes it, or the owner kills it.
    """

    def __init__(self, channel: Channel) -> None:
        self._channel: Channel | None = channel

    @classmethod
    def begin(
        cls,
        seed: int,
        limits: ProcessLimits,
        program: str = EMBEDDED,
        writable: Path | None = None,
        **more: Any,
    ) -> Self:
        """Start Node and ask for an empty world, without waiting for the answer.

        Args:
            seed: Seed of the world's own random numbers.
            limits: Limits of Node.
            program: Name of the bundled program.
            writable: The only folder to which it may write.
            more: Further arguments of the first request.

        Raises:
            BodyError: Node or the bundle is missing, or Node cannot be executed.
        """
        channel = Channel.start(node_command(limits, program, writable), limits)
        launch = cls(channel)
        try:
            with _explained():
                channel.begin("hello", protocol=PROTOCOL, seed=seed, minecraft=MINECRAFT, **more)
        except BaseException:
            launch.kill()
            raise
        return launch

    def take(self) -> tuple[Channel, Mapping[str, str]]:
        """Wait for the world; return the channel to it, and the running versions.

        The caller closes the channel. A launch can be taken once.

        Raises:
            BodyError: The start failed.
        """
        channel = self._channel
        if channel is None:
            raise BodyError("this start of Node was used or given up; launch another one")
        try:
            with _explained():
                versions = channel.finish()
        except BaseException:
            self.kill()
            raise
        self._channel = None
        return channel, {program: str(version) for program, version in versions.items()}

    def worlds(self, seed: int) -> "Mapping[str, World]":
        """Return the embedded world of this launch, by its name; the launch had the same seed."""
        return {"embedded": part("launched_world")(seed, launch=self)}

    def kill(self) -> None:
        """Kill the process, unless a world has taken it."""
        channel, self._channel = self._channel, None
        if channel is not None:
            channel.kill()
            channel.close()


def started(
    seed: int,
    limits: ProcessLimits,
    program: str = EMBEDDED,
    writable: Path | None = None,
    **more: Any,
) -> tuple[Channel, Mapping[str, str]]:
    """Start Node with an empty world; return the channel to it, and the running versions.

    The arguments are those of `Launch.begin`.

    Raises:
        BodyError: Node or the bundle is missing, or the start failed.
    """
    return Launch.begin(seed, limits, program, writable, **more).take()


@contextmanager
def ahead(world: str, seed: int) -> Iterator[Launch | None]:
    """Launch Node with the usual limits if a world is the embedded one; kill it if it is not used.

    A failure is not told here: a world that gets no launch starts Node again and tells it.

    Args:
        world: Name of the world.
        seed: Seed of the world's own random numbers.

    Raises:
        InputError: The seed is not a whole number of 64 bits.
    """
    checked_seed(seed)
    launch = None
    if world == "embedded":
        with suppress(BodyError):
            launch = Launch.begin(seed, ProcessLimits())
    try:
        yield launch
    finally:
        if launch is not None:
            launch.kill()


@contextmanager
def _explained() -> Iterator[None]:
    """Say in the error of a Node that ended while it started what the user can do."""
    try:
        yield
    except BodyLostError as error:
        if limits := low_limits():
            raise BodyError(f"Node cannot be started: {limits}") from error
        raise BodyError(f"Node cannot be started; run `beliefnest doctor`. {error}") from error
