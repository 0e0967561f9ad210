"""The command line: composes the other rooms and runs them."""

import gc
import sys

__all__ = ["main"]


def main() -> None:
    """Run the command line; the process ends with its exit status."""
    from beliefnest.cli.streams import open_streams, print_warnings_as_lines

    # Most objects of a command stay. Searching them for cycles after every 700 new ones takes a
    # twelfth of the processor time of `run sally-anne`, which makes 230,000 objects that stay.
    gc.set_threshold(300_000)
    open_streams()
    print_warnings_as_lines()
    from beliefnest.cli.app import run_command_line

    status = run_command_line(sys.argv[1:])
    # The memory is returned with the process. Without this the interpreter searches all objects for
    # cycles before it ends, which takes 0.3 s once numba is imported.
    gc.freeze()
    sys.exit(status)
