"""Checks of `beliefnest doctor` for conditions of a machine that hurt runs, each by its name."""

import os
import sys
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from tempfile import TemporaryDirectory

from beliefnest.errors import BodyError, InputError
from beliefnest.world.shell_limits import low_limits

_KEY = "_API_KEY"


def _limits() -> str:
    low_limit = low_limits()
    if low_limit is not None:
        raise BodyError(low_limit)
    return "memory, files and threads suffice for Node"


def _folder() -> str:
    """Write a small run file in the current folder, where runs are kept by default."""
    from beliefnest.locking import holding
    from beliefnest.nest.face.nest import Nest
    from beliefnest.worlds.scripted.world import ScriptedWorld

    try:
        with TemporaryDirectory(prefix=".beliefnest-doctor-", dir=Path()) as scratch:
            folder = Path(scratch)
            with holding(folder):
                soft = any(each.name.endswith("-soft") for each in folder.iterdir())
                world = ScriptedWorld(((0, 0, 0), (2, 2, 2)), {}, {"ann": (1.5, 0.0, 1.5)})
                Nest(world, store=folder / "run.bn").close()
    except OSError as error:
        raise InputError(
            f"the current folder cannot be written ({error.strerror}); go to another one"
        ) from None
    if soft:
        return (
            f"the disk of {Path.cwd()} has no locks (flock): a killed run leaves its folder locked "
            "until its process is known to be gone; keep runs on a local disk if you can"
        )
    return f"runs can be recorded in {Path.cwd()}"


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
            f"modules of Python's own are hidden by {', '.join(hiding[:3])} from "
            "`python -m beliefnest`, and from all that reads PYTHONPATH; rename the file, or set "
            "PYTHONSAFEPATH=1"
        )
    return "no file of yours hides a module of Python's own"


def _own_folders(environment: Mapping[str, str]) -> Iterator[Path]:
    yield Path()
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
        return f"{', '.join(proxies)}: for providers, never for servers of this machine"
    return "no proxy; certificates and keys are well formed"


MACHINE_CHECKS: tuple[tuple[str, Callable[[], str]], ...] = (
    ("limits", _limits),
    ("folder", _folder),
    ("modules", _imports),
    ("routes", _routes),
)
