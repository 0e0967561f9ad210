"""`beliefnest new`: write a scenario to start from."""

from importlib.resources import files
from pathlib import Path

from beliefnest.cli.terminal_text import say
from beliefnest.errors import InputError
from beliefnest.files import new_file
from beliefnest.scenarios.sources import builtin_names, scenario_name


def write_starter(name: str) -> None:
    """Write `NAME.yaml`, a commented scenario that runs, into the current folder.

    Raises:
        InputError: The name is not valid or is taken, or the file cannot be written.
    """
    if scenario_name(name) != name:
        raise InputError(f"{name!r} is no scenario name; use up to 64 letters, digits, - and _")
    if name in builtin_names():
        raise InputError(f"{name!r} is the name of a built-in scenario; choose another")
    text = (files("beliefnest.scenarios") / "starter" / "starter.yaml").read_text(encoding="utf-8")
    path = Path(f"{name}.yaml")
    with new_file(path) as file:
        file.write(text.replace("{name}", name).encode())
    say(f"{path} is written; run it with: beliefnest run {path}\n")
