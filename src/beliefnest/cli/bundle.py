"""`beliefnest bundle`, `beliefnest methods`: the supplement and the methods of a study or run."""

import os
from collections.abc import Mapping
from pathlib import Path

from beliefnest.cli.console import progress_on
from beliefnest.cli.terminal_text import say
from beliefnest.studies.archive import write_zip
from beliefnest.studies.bundling import bundled, opened
from beliefnest.studies.methods import MethodsForm, methods_text
from beliefnest.world.words import counted


def print_methods(folder: Path, form: MethodsForm) -> None:
    """Print the paragraph for a methods section; raise InputError if there are no results."""
    say(methods_text(opened(folder), form))


def write_bundle(folder: Path, out: Path | None, *, runs: bool) -> None:
    """Write the supplement of a study or run.

    Args:
        folder: Folder of the study or run.
        out: The ZIP file; None: `FOLDER.zip` in the current folder.
        runs: Include the recorded run files.

    Raises:
        InputError: There are no results, or a file contains a secret.
    """
    with progress_on("bundle") as on_progress:
        on_progress("reading", 0, 0)
        files = bundled(opened(folder), os.environ, runs=runs)
        target = out or Path(f"{folder.resolve().name}.zip")
        on_progress(f"writing {counted(len(files), 'file')}", 0, 0)
        write_zip(files, target)
    say(f"{target}: {counted(len(files), 'file')}, {target.stat().st_size:,} bytes\n")
    if not any(name == "figure.svg" or name.endswith("picture.png") for name in files):
        say('without a figure; install "beliefnest[plot]" to add it\n')
    named = _naming_home(files)
    if named:
        say(
            f"{counted(len(named), 'file')} with the path of your home folder, such as {named[0]}; "
            "change this before an anonymous review\n"
        )


def _naming_home(files: Mapping[str, bytes]) -> list[str]:
    home = str(Path.home())
    # The home of a system user, such as `/` or `/root`, names nobody.
    if home in ("/", "/root"):
        return []
    return [name for name, content in files.items() if home.encode() in content]
