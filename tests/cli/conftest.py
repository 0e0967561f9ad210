"""What tests of commands have in common."""

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager

import pytest

from beliefnest.bodies.worlds import Worlds

Lent = Callable[[int], AbstractContextManager[Worlds]]


@pytest.fixture(scope="session")
def lent() -> Iterator[Lent]:
    """Worlds by their seed, which stay open for as long as the tests last."""
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
    """The commands of a file play in the same world in turn, as the conditions of one do."""
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr("beliefnest.cli.run.Worlds", lent)
        yield
