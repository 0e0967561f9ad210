"""`beliefnest serve`: where it listens, and how it ends."""

import re
import signal
import socket
import subprocess
import sys
import urllib.request
from pathlib import Path

import beliefnest as bn
from beliefnest.cli.serve import ServeOptions, listening


def test_the_address_can_be_connected_to_as_soon_as_it_is_known() -> None:
    options = ServeOptions(
        what="run", port=0, address="127.0.0.1", conditions=(), out=None, depth=2
    )
    with listening(options) as listener:
        socket.create_connection(listener.getsockname(), timeout=10).close()


def test_ctrl_c_ends_it_without_complaint_while_a_page_listens(tmp_path: Path) -> None:
    store = tmp_path / "run.bn"
    world = bn.ScriptedWorld(((0, 0, 0), (4, 2, 4)), {}, {"ann": (1.5, 0, 1.5)})
    with bn.Nest(world, store=store):
        world.step(3)
    command = [sys.executable, "-m", "beliefnest", "serve", str(store), "--port", "0"]
    server = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    with server:
        assert server.stdout is not None
        address = re.search(r"http://\S+", server.stdout.readline())
        assert address is not None
        with urllib.request.urlopen(f"{address[0]}api/live?from=0", timeout=60) as live:
            assert live.readline().startswith(b"id: 1")
            server.send_signal(signal.SIGINT)
            live.read()
        said, complaints = server.communicate(timeout=60)
    assert (server.returncode, said, complaints) == (0, "", "")
