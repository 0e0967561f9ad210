"""Processes of their own for figures that earlier ones would change: peak memory above all."""

import subprocess
import sys

from beliefnest.errors import BodyError

__all__ = ["printed"]


def printed(module: str, call: str) -> str:
    """Return the result of a function of a module, called in a new process, as text.

    Args:
        module: Name of the module; the function is in its `__all__`.
        call: Call of the function, a Python expression.

    Raises:
        BodyError: The process failed.
    """
    code = f"from {module} import *; print({call})"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise BodyError(f"the process of {call} of {module} failed: {done.stderr.strip()}")
    return done.stdout
