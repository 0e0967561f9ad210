"""Lock that lets one process at a time write a run file.

A separate file beside the run file keeps it apart from SQLite's own locks.
"""

from pathlib import Path

from beliefnest.errors import StoreError
from beliefnest.locking import LockHeldError, ProcessLock


def writer_lock(file: Path) -> ProcessLock:
    """Take the right to write a run file, held until `release` or the end of the process.

    Raises:
        StoreError: Another writer holds the lock, or the lock file cannot be created.
    """
    real = file.resolve()
    path = real.with_name(real.name + "-lock")
    try:
        return ProcessLock.acquire(path)
    except LockHeldError as held:
        raise StoreError(
            f"{file} is being written by {held}; a run has one writer: "
            "wait until it ends, or open the file for reading"
        ) from None
    except FileNotFoundError as fault:
        raise StoreError(
            f"{file} cannot be created: there is no folder {path.parent}; create it"
        ) from fault
    except OSError as fault:
        raise StoreError(
            f"{file} cannot be written: its lock file cannot be created ({fault.strerror}); "
            "make the folder writable, or open the file for reading"
        ) from fault
