"""`beliefnest serve`: serve the live page of a run, or run a scenario and serve its page."""

import secrets
import socket
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from datetime import datetime
from ipaddress import ip_address
from pathlib import Path
from typing import TYPE_CHECKING

from beliefnest.belief import node_memory
from beliefnest.cli.console import stdout
from beliefnest.cli.editing import FileEditor
from beliefnest.cli.folder import STORE, stores_in
from beliefnest.cli.options import ServeOptions
from beliefnest.cli.page import about_run
from beliefnest.errors import InputError
from beliefnest.nest.face.recorded import RecordedNest
from beliefnest.nest.past.history import context_of
from beliefnest.scenarios.scenario import Scenario
from beliefnest.timeline.store import Journal
from beliefnest.viewer.page.static import check_depth
from beliefnest.viewer.serving.host import Host, OpenRun

if TYPE_CHECKING:  # Starlette is an optional dependency: `serve` imports it when it runs.
    from starlette.applications import Starlette

_PORT = 8642


def serve(options: ServeOptions) -> None:
    """Serve the page of a run, or the editor of a file, until the user interrupts it.

    Raises:
        InputError: The extra is not installed, there is no such run, scenario or condition, the
            depth is not from 0 to 4, or the address cannot be listened on.
    """
    try:
        import uvicorn

        from beliefnest.viewer.serving.editor import editor_app
        from beliefnest.viewer.serving.routes import page_app
    except ImportError:
        raise InputError(
            "serve needs starlette and uvicorn: run `pip install 'beliefnest[serve]'`"
        ) from None
    check_depth(options.depth)

    def show(listener: socket.socket, app: Callable[[set[str], str | None], "Starlette"]) -> None:
        """Tell the address and serve the application."""
        port = listener.getsockname()[1]
        token = None if _is_loopback(options.address) else secrets.token_urlsafe(24)
        query = "" if token is None else f"?token={token}"
        address = f"http://{_host(options.address)}:{port}/{query}"
        stdout().print(
            f"The page is at {address} (stop with Ctrl-C)", highlight=False, soft_wrap=True
        )
        names = _names(options.address, port)
        server.append(
            uvicorn.Server(
                uvicorn.Config(
                    lambda: app(names, token),
                    factory=True,
                    log_level="warning",
                    access_log=False,
                    timeout_graceful_shutdown=1,
                )
            )
        )
        # Users end the server with Ctrl-C; uvicorn raises KeyboardInterrupt again after its end.
        with suppress(KeyboardInterrupt):
            server[0].run(sockets=[listener])

    server: list[uvicorn.Server] = []
    if options.edit:
        if options.condition or options.out is not None:
            raise InputError("--edit runs nothing; leave --condition and --out out")
        editor = FileEditor(Path(options.what))
        with listening(options) as listener:
            show(listener, lambda names, token: editor_app(editor, names, token))
        return
    with listening(options) as listener, _running(options) as folder:
        host = Host(lambda: _stores(folder), _open, options.depth)
        for fault in host.discover():
            sys.stderr.write(f"beliefnest: missing on the page until it can be read: {fault}\n")
        host.follow()
        show(
            listener,
            lambda names, token: page_app(host, names, token, lambda: server[0].should_exit),
        )


@contextmanager
def listening(options: ServeOptions) -> Iterator[socket.socket]:
    """Open a socket that accepts connections at the wanted address and port.

    Raises:
        InputError: The address cannot be listened on.
    """
    try:
        options.address.encode("idna")
    except UnicodeError:
        # `bind` would raise TypeError for it.
        raise InputError(
            f"{options.address} is no host name; give an address of this machine with --address"
        ) from None
    family = socket.AF_INET6 if ":" in options.address else socket.AF_INET
    with socket.socket(family, socket.SOCK_STREAM) as listener:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        for port in (_PORT, 0) if options.port is None else (options.port,):
            try:
                listener.bind((options.address, port))
                break
            except (OSError, OverflowError) as error:
                if port == 0 or options.port is not None:
                    raise InputError(
                        f"{options.address} port {port} cannot be listened on ({error}); "
                        "give an address of this machine, or another port with --port"
                    ) from None
        # Users may open the page as soon as its address is printed.
        listener.listen()
        yield listener


@contextmanager
def _running(options: ServeOptions) -> Iterator[Path]:
    """Yield the folder of the run; a scenario runs in a child process meanwhile."""
    path = Path(options.what)
    if path.is_dir() or path.suffix == Path(STORE).suffix:
        stores_in(path)
        yield path
        return
    scenarios = Scenario.load_all(options.what)
    for scenario in scenarios:
        # Refuse beliefs without room in memory here: the run itself may need fewer of them.
        node_memory.check_depth(context_of(scenario.setting), (), options.depth)
    name = scenarios[0].name
    for number in options.condition or ():
        # Refuse an unknown condition here: in the child it would leave an empty page.
        Scenario.load(options.what, number)
    folder = options.out or Path("runs") / f"{name}-{datetime.now():%Y%m%d-%H%M%S}"
    # -P: a `random.py` of the user in this folder is not ours to import.
    command = [sys.executable, "-P", "-m", "beliefnest", "run", options.what, "--out", str(folder)]
    for number in options.condition or ():
        command += ["--condition", str(number)]
    # Drop the table of the child, which would be mixed with our own lines.
    child = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    try:
        yield folder
    finally:
        child.terminate()
        child.wait()


def _stores(folder: Path) -> Sequence[Path]:
    return (folder,) if folder.is_file() else sorted(folder.rglob(STORE))


def _open(store: Path) -> OpenRun:
    journal = Journal.read(store)
    try:
        nest = RecordedNest(journal)
        return OpenRun(nest.reader, about_run(journal, nest), journal.close)
    except BaseException:
        journal.close()
        raise


def _is_loopback(address: str) -> bool:
    try:
        return ip_address(address).is_loopback
    except ValueError:
        return address == "localhost"


def _names(address: str, port: int) -> set[str]:
    """Return the allowed values of the header `Host` of requests."""
    names = {_host(address), "localhost", "127.0.0.1", "[::1]"}
    if not _is_loopback(address):
        # The token protects a page on other addresses. Allow all names of this machine.
        names |= {socket.gethostname(), socket.getfqdn(), *_own_addresses()}
    return {f"{name}:{port}" for name in names}


def _own_addresses() -> set[str]:
    try:
        addresses = socket.getaddrinfo(socket.gethostname(), None)
    except OSError:
        return set()
    return {_host(str(each[4][0])) for each in addresses}


def _host(address: str) -> str:
    return f"[{address}]" if ":" in address else address
