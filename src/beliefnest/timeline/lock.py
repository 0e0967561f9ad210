"""The lock that lets one process at a time write a run file.

It is an advisory lock on a file beside the run file, so that the operating system gives it
up when the process ends, however it ends, and so that it does not meet SQLite's own locks.
"""

import os
from contextlib import suppress
from pathlib import Path

from filelock import lock_descriptor

from beliefnest.errors import StoreError
from beliefnest.owned import Owned

__all__ = ["WriterLock"]


class WriterLock(Owned):
    """The right to write one run file, held until `release` or the end of the process."""

    def __init__(self, descriptor: int, path: Path) -> None:
        super().__init__()
        self._descriptor: int | None = descriptor
        self._path = path

    @classmethod
    def acquire(cls, file: Path) -> "WriterLock":
        """Take the lock of a run file.

        Raises:
            StoreError: Another writer holds it, or no lock file can be made beside the run file.
        """
        real = file.resolve()
        path = real.with_name(real.name + "-lock")
        while True:
            descriptor = _opened(path, file)
            try:
                is_free = lock_descriptor(descriptor, blocking=False)
                if is_free and _is_at(descriptor, path):
                    os.truncate(descriptor, 0)
                    os.write(descriptor, f" {os.getpid()}".encode())
                    return cls(descriptor, path)
                holder = "" if is_free else _holder(descriptor)
            except OSError as fault:
                os.close(descriptor)
                raise StoreError(f"{file} cannot be locked for writing: {fault}") from fault
            os.close(descriptor)
            if holder:
                raise StoreError(
                    f"{file} is being written by {holder}; a run has one writer: "
                    "wait until it ends, or open the file for reading"
                )
            # The holder removed the file between our opening and our locking it.

    def release(self) -> None:
        """Give the lock up and remove its file; a second call does nothing."""
        if self._descriptor is None:
            return
        # Windows does not remove a file that is open; one that is left behind refuses nobody.
        with suppress(PermissionError):
            self._path.unlink(missing_ok=True)
        os.close(self._descriptor)
        self._descriptor = None

    def disown(self) -> None:
        """Close the file in a forked child, so that the lock ends with its parent."""
        if self._descriptor is not None:
            os.close(self._descriptor)
            self._descriptor = None


def _opened(path: Path, file: Path) -> int:
    try:
        return os.open(path, os.O_RDWR | os.O_CREAT, 0o644)
    except FileNotFoundError as fault:
        raise StoreError(f"{file} cannot be made: there is no folder {path.parent}") from fault
    except OSError as fault:
        raise StoreError(
            f"{file} cannot be written: no lock file can be made beside it ({fault.strerror}); "
            "make the folder writable, or open the file for reading"
        ) from fault


def _is_at(descriptor: int, path: Path) -> bool:
    try:
        return os.path.samestat(os.fstat(descriptor), path.stat())
    except FileNotFoundError:
        return False


def _holder(descriptor: int) -> str:
    # Windows lets nobody else read the first byte, which is the one that is locked.
    os.lseek(descriptor, 1, os.SEEK_SET)
    text = os.read(descriptor, 20)
    return f"process {int(text)}" if text.isdigit() else "another process"
