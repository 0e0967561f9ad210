"""Checks of `beliefnest doctor` for conditions of a machine that hurt runs, each by its name."""

import os
import sys
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from tempfile import TemporaryDirectory

from beliefnest.errors import BodyError, InputError
from beliefnest.world.shell_limits import low_limits

__all__ = ["MACHINE_CHECKS"]

_KEY = "_API_KEY"


def _limits() -> str:
    found = low_limits()
    if found is not None:
        raise BodyError(found)
    return "memory, files and threads suffice for Node"


def _folder() -> str:
    """Write a small run file in the current folder, where runs are kept by default."""
    from beliefnest.locking import holding
    from beliefnest.timeline.store import SqliteJournal

    here = Path.cwd()
    try:
        with TemporaryDirectory(prefix=".beliefnest-doctor-", dir=here) as scratch:
            folder = Path(scratch)
            with holding(folder):
                soft = any(each.name.endswith("-soft") for each in folder.iterdir())
                SqliteJournal.create(folder / "run.bn").close()
    except OSError as error:
        raise InputError(
            f"{here} cannot be written ({error.strerror}); name a folder with --out"
        ) from None
    if soft:
        return (
            f"the disk of {here} has no locks (flock): a run that is killed leaves its folder "
            "locked until its process is known to be gone; keep runs on a local disk if you can"
        )
    return f"runs can be recorded in {here}"


def _imports() -> str:
    """Name files in the folders of the user that hide modules of Python from our processes."""
    if sys.flags.safe_path:
        return "no folder of yours is searched for modules"
    hiding = sorted(
        str(file)
        for folder in _own_folders(os.environ)
        for file in folder.glob("*.py")
        if file.stem in sys.stdlib_module_names
    )
    if hiding:
        raise InputError(
            f"{', '.join(hiding[:3])} hides a module of Python's own from `python -m beliefnest` "
            "and from whatever reads PYTHONPATH; rename the file, or set PYTHONSAFEPATH=1"
        )
    return "no file of yours hides a module of Python's own"


def _own_folders(environment: Mapping[str, str]) -> Iterator[Path]:
    yield Path.cwd()
    yield from map(Path, filter(None, environment.get("PYTHONPATH", "").split(os.pathsep)))


def _routes() -> str:
    """Check what the environment says about proxies, certificates and keys of models."""
    from beliefnest.llm.routes import check_route

    check_route("https://example.org/", os.environ)
    for name, value in os.environ.items():
        if name.endswith(_KEY) and value != value.strip():
            raise InputError(
                f"{name} begins or ends with white space, such as a line end of Windows; "
                "remove it from the file that sets the variable"
            )
    proxies = sorted(name for name in os.environ if name.lower().endswith("_proxy"))
    if proxies:
        return f"{', '.join(proxies)} apply to providers, never to servers of this machine"
    return "no proxy; certificates and keys are well formed"


MACHINE_CHECKS: tuple[tuple[str, Callable[[], str]], ...] = (
    ("limits", _limits),
    ("folder", _folder),
    ("modules", _imports),
    ("routes", _routes),
)
