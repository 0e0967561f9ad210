"""Worlds that tests play in one after the other, as the conditions of one command do.

Starting Minecraft takes longer than most stories played in it. Tests of what starts, ends and
breaks it use a world of their own.
"""

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager, nullcontext

import pytest

from beliefnest.worlds.by_name import Worlds, open_world
from beliefnest.worlds.process_limits import ProcessLimits
from beliefnest.worlds.protocol import World

__all__ = ["WORLDS", "Lent", "kept_worlds", "lent"]

WORLDS = ("embedded", "scripted")
"""Names of the worlds that this package declares."""

Lent = Callable[[int], AbstractContextManager[Worlds]]


@pytest.fixture(scope="session")
def lent() -> Iterator[Lent]:
    """Worlds by their seed, which stay open until the last test has ended."""
    with ExitStack() as ended:
        opened: dict[int, Worlds] = {}

        @contextmanager
        def lend(seed: int) -> Iterator[Worlds]:
            if seed not in opened:
                opened[seed] = ended.enter_context(Worlds(seed))
            yield opened[seed]

        yield lend


@pytest.fixture(scope="module")
def kept_worlds(lent: Lent) -> Iterator[None]:
    """Lend a world to the nests that a file's tests begin; resumed ones get their own."""

    def lent_world(name: str, seed: int, limits: ProcessLimits | None = None) -> World:
        if name != "embedded" or limits is not None:
            return open_world(name, seed, limits)
        with lent(seed) as worlds:
            return worlds.lend(name)

    def shared(seed: int, begun: object) -> AbstractContextManager[Worlds]:
        return lent(seed)

    def nothing_ahead(world: str, seed: int) -> AbstractContextManager[None]:
        return nullcontext()

    with pytest.MonkeyPatch.context() as patched:
        patched.setattr("beliefnest.worlds.minecraft.launching.ahead", nothing_ahead)
        patched.setattr("beliefnest.plan.worker.Worlds", shared)
        patched.setattr("beliefnest.nest.face.nest.open_world", lent_world)
        yield
