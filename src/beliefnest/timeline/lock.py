"""Lock that lets one process at a time write a run file.

It is an advisory lock on a separate file beside the run file. The operating system releases it when
the process ends, even after a crash. The separate file keeps it apart from SQLite's own locks.
"""

import os
from contextlib import suppress
from pathlib import Path

from filelock import lock_descriptor

from beliefnest.errors import StoreError
from beliefnest.owned import Owned

__all__ = ["WriterLock"]


class WriterLock(Owned):
    """Right to write one run file, held until `release` or the end of the process."""

    def __init__(self, descriptor: int, path: Path) -> None:
        super().__init__()
        self._descriptor: int | None = descriptor
        self._path = path

    @classmethod
    def acquire(cls, file: Path) -> "WriterLock":
        """Take the lock of a run file.

        Raises:
            StoreError: Another writer holds the lock, or the lock file cannot be created.
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
            # The holder removed the file after this process opened it and before it locked it.
            # The lock is then on a deleted file: try again with a new one.

    def release(self) -> None:
        """Release the lock and remove its file; a second call does nothing."""
        if self._descriptor is None:
            return
        # Windows does not remove an open file. A leftover file does no harm: it is not locked.
        with suppress(PermissionError):
            self._path.unlink(missing_ok=True)
        os.close(self._descriptor)
        self._descriptor = None

    def disown(self) -> None:
        """Close the lock file in a forked child, so that only the parent holds the lock."""
        if self._descriptor is not None:
            os.close(self._descriptor)
            self._descriptor = None


def _opened(path: Path, file: Path) -> int:
    try:
        return os.open(path, os.O_RDWR | os.O_CREAT, 0o644)
    except FileNotFoundError as fault:
        raise StoreError(
            f"{file} cannot be created: there is no folder {path.parent}; create it"
        ) from fault
    except OSError as fault:
        raise StoreError(
            f"{file} cannot be written: its lock file cannot be created ({fault.strerror}); "
            "make the folder writable, or open the file for reading"
        ) from fault


def _is_at(descriptor: int, path: Path) -> bool:
    try:
        return os.path.samestat(os.fstat(descriptor), path.stat())
    except FileNotFoundError:
        return False


def _holder(descriptor: int) -> str:
    # On Windows no other process can read the locked byte, which is the first.
    os.lseek(descriptor, 1, os.SEEK_SET)
    text = os.read(descriptor, 20)
    return f"process {int(text)}" if text.isdigit() else "another process"
