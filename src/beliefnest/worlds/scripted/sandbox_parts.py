"""Parts of the bots' sandbox for the scripted world: names, limits, and first states.

`worlds/minecraft/node/build.js` writes it, so that both worlds hold programs to the same rules.
"""

import gzip
from functools import cache
from importlib.resources import files
from pathlib import Path

import msgspec

INTERPRETER = "quickjs.wasm"
_FILE = "sandbox.msgpack.gz"


class MachineState(msgspec.Struct, frozen=True):
    """Whole state of an interpreter in which no code runs.

    Attributes:
        pieces: Addresses and contents of the parts of its memory that are not empty.
        runtime: Address of its runtime.
        context: Address of its context.
        functions: Functions in it for the host, by name.
    """

    pieces: tuple[tuple[int, bytes], ...]
    runtime: int
    context: int
    functions: dict[str, int]


class Limits(msgspec.Struct, frozen=True, rename="camel"):
    """Limits of a program.

    Attributes:
        fuel: Units of computation.
        memory: Bytes that it may allocate.
        message: Characters that leave it at once.
        calls: Calls under way.
        listeners: Listeners to events.
        log_lines: Lines of its console.
        log_characters: Characters of its console.
    """

    fuel: int
    memory: int
    message: int
    calls: int
    listeners: int
    log_lines: int
    log_characters: int


class Meter(msgspec.Struct, frozen=True, rename="camel"):
    """Constants of the meter in the interpreter.

    Attributes:
        unmetered: Fuel of code that is not a program's.
        grace: Fuel kept back for loops that cannot be stopped politely.
        crossing_stack_bytes: Estimated bytes of the host's frames.
        last_breath: Fuel of a program that ended while it called the host.
        jobs_at_once: Jobs of promises that run between two looks at the limits.
        most_strays: Rejected promises that are kept in mind.
        wake_cost: Fuel for sending a message to the program.
        initial_pages: Pages of 64 KiB of a new memory.
    """

    unmetered: int
    grace: int
    crossing_stack_bytes: int
    last_breath: int
    jobs_at_once: int
    most_strays: int
    wake_cost: int
    initial_pages: int


class Cost(msgspec.Struct, frozen=True):
    """Fuel for a request.

    Attributes:
        each: For every request.
        character: For each of its characters.
        answered: For each character of the answer.
    """

    each: int
    character: int
    answered: int


class Parts(msgspec.Struct, frozen=True):
    """All of it.

    Attributes:
        exports: Letters of the interpreter's functions, by name.
        imports: Letters of what it imports, by what that does.
        scope: Names in scope of a program, in order.
        events: Events of the bot, in Minecraft.
        announced: Those of them that tell what its agent perceived otherwise than by sight.
        limits: Limits of a program.
        meter: Constants of the meter.
        cost: Fuel for a request.
        guest: State in which every program begins.
        desk: State of the desk (`Desk`).
    """

    exports: dict[str, str]
    imports: dict[str, str]
    scope: tuple[str, ...]
    events: tuple[str, ...]
    announced: tuple[str, ...]
    limits: Limits
    meter: Meter
    cost: Cost
    guest: MachineState
    desk: MachineState


def bundled(name: str) -> Path:
    """Return a file that the build has made."""
    return Path(str(files("beliefnest"))) / "_bundle" / name


@cache
def parts() -> Parts:
    """Return what the build has made, which is read once."""
    packed = gzip.decompress(bundled(_FILE).read_bytes())
    return msgspec.msgpack.decode(packed, type=Parts)
