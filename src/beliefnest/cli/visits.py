"""`beliefnest run --embody`: let people visit beliefs until the user presses Enter."""

import sys
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from beliefnest.errors import InputError
from beliefnest.nest.face.nest import Nest
from beliefnest.worlds.minecraft.launching import MINECRAFT
from beliefnest.worlds.servers.address import is_server
from beliefnest.worlds.servers.listening import is_hosted

_DAY_S = 24 * 60 * 60.0


def check_visits(paths: Sequence[str], world: str) -> None:
    """Raise an error if people cannot visit beliefs in a world, before anything is started.

    Raises:
        InputError: People cannot join this world.
    """
    if paths and not (is_hosted(world) or is_server(world)):
        raise InputError(
            f"--embody {paths[0]}: nobody can visit a belief in the world {world}, which does not "
            "run in real time; add --realtime --listen 25565, or --world minecraft://HOST:PORT"
        )


@contextmanager
def visited(nest: Nest, paths: Sequence[str]) -> Iterator[None]:
    """Embody beliefs, and keep them until a line or the end of standard input.

    The addresses of the embodied beliefs are printed on stderr.

    Raises:
        BeliefNestError: A belief cannot be embodied.
    """
    if not paths:
        yield
        return
    for path in paths:
        nest[path].embody()
    if nest.address is not None:
        _tell(
            f"to visit, join by a name that no agent has: Minecraft Java edition {MINECRAFT}, "
            f"Multiplayer, Direct Connection, {nest.address}; then type"
        )
    _tell(repr(nest.layout()))
    yield
    _tell("beliefs can be visited until you press Enter")
    entered = threading.Event()

    def listen() -> None:
        try:
            sys.stdin.readline()
        finally:
            entered.set()

    threading.Thread(target=listen, daemon=True).start()
    nest.wait(entered.is_set, _DAY_S)


def _tell(line: str) -> None:
    sys.stderr.write(f"{line}\n")
