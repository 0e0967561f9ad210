"""`beliefnest capture`: write a place on a server, or in a file, as a scenario."""

import sys
from collections.abc import Mapping
from pathlib import Path

from beliefnest.cli.options import CaptureOptions
from beliefnest.cli.terminal_text import printable, say
from beliefnest.errors import BeliefNestError, InputError
from beliefnest.files import new_file, read_regular
from beliefnest.scenarios.sources import scenario_name
from beliefnest.scenarios.writing import scenario_text
from beliefnest.world.texts import quoted
from beliefnest.world.values import Box
from beliefnest.worlds.servers.address import ServerAddress, is_server
from beliefnest.worlds.servers.capturing import Captured, Unknown, capture_file, capture_server

_LARGEST_FILE = 64 * 2**20
_SUFFIX = ".yaml"
_UNKNOWN: Mapping[str, Unknown] = {"refuse": "refuse", "air": "air"}


def write_capture(options: CaptureOptions) -> None:
    """Write the scenario; list on stderr what a scenario cannot express.

    Raises:
        InputError: The options do not fit together, or the file cannot be written.
        BodyError: The place on the server cannot be read.
    """
    out = options.out
    if out.suffix not in (_SUFFIX, ".yml"):
        raise InputError(f"{out} is no name of a scenario file; give a name that ends in {_SUFFIX}")
    if out.exists():
        raise InputError(f"{out} exists already; choose another name")
    captured = _captured(options)
    name = options.name or scenario_name(out.stem)
    text = scenario_text(name, _description(options), captured.snapshot)
    with new_file(out) as file:
        file.write(text.encode())
    for sentence in captured.left_out:
        sys.stderr.write(printable(f"left out: {sentence}") + "\n")
    say(f"{out} is written; run it with: beliefnest run {out}\n")


def _captured(options: CaptureOptions) -> Captured:
    if is_server(options.where):
        if options.box is None or options.at is not None:
            raise InputError("a server needs a box: give --box X1 Y1 Z1 X2 Y2 Z2, and no --at")
        x1, y1, z1, x2, y2, z2 = options.box
        low = (min(x1, x2), min(y1, y2), min(z1, z2))
        high = (max(x1, x2), max(y1, y2), max(z1, z2))
        return capture_server(ServerAddress.parse(options.where), Box(low, high))
    if options.box is not None:
        raise InputError("a file is captured whole: give --at X Y Z, and no --box")
    unknown = _UNKNOWN.get(options.unknown)
    if unknown is None:
        raise InputError(f"--unknown is {quoted(options.unknown)}; give refuse or air")
    path = Path(options.where)
    try:
        data = read_regular(path, _LARGEST_FILE)
    except OSError as error:
        raise InputError(
            f"{path} cannot be read: {error.strerror or error}; give minecraft://HOST:PORT, or "
            "a .schem or .nbt file"
        ) from None
    try:
        return capture_file(data, options.at or (0, 0, 0), unknown)
    except BeliefNestError as error:
        raise InputError(f"{path}: {error}") from error


def _description(options: CaptureOptions) -> str:
    if not is_server(options.where):
        return f"Captured from the file {Path(options.where).name}."
    return f"Captured from {ServerAddress.parse(options.where)}."
