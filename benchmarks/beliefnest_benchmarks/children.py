"""Processes of their own: for whole commands, and for figures that earlier ones would change."""

import subprocess
import sys
import tempfile
from pathlib import Path

from beliefnest.errors import BodyError

__all__ = ["play_scenario", "printed", "run_python"]


def run_python(*arguments: str, folder: str | None = None) -> str:
    """Run Python with arguments in a folder; return what it prints.

    Raises:
        BodyError: The process failed.
    """
    ended = subprocess.run(
        [sys.executable, *arguments], cwd=folder, capture_output=True, text=True, check=False
    )
    if ended.returncode != 0:
        raise BodyError(f"python {' '.join(arguments)} failed: {ended.stderr.strip()}")
    return ended.stdout


def play_scenario(name: str) -> None:
    """Run `beliefnest run` with a built-in scenario."""
    with tempfile.TemporaryDirectory() as folder:
        run_python("-m", "beliefnest", "run", name, "--out", str(Path(folder, "run")))


def printed(module: str, call: str) -> str:
    """Return the result of a function of a module, called in a new process, as text.

    Args:
        module: Name of the module; the function is in its `__all__`.
        call: Call of the function, a Python expression.

    Raises:
        BodyError: The process failed.
    """
    return run_python("-c", f"from {module} import *; print({call})")
