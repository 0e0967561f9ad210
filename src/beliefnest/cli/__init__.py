"""The command line: composes the other rooms and runs them."""

import sys

__all__ = ["main"]


def main() -> None:
    """Run the command line; the process ends with its exit status."""
    from beliefnest.cli.app import run_command_line

    sys.exit(run_command_line(sys.argv[1:]))
