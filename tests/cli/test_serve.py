"""`beliefnest serve`: where it listens."""

import socket

from beliefnest.cli.serve import ServeOptions, listening


def test_the_address_can_be_connected_to_as_soon_as_it_is_known() -> None:
    options = ServeOptions(
        what="run", port=0, address="127.0.0.1", conditions=(), out=None, depth=2
    )
    with listening(options) as listener:
        socket.create_connection(listener.getsockname(), timeout=10).close()
