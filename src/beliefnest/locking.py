"""Locks that let one process at a time use a run file or a folder of results.

A lock is an advisory lock on a file of its own. The operating system releases it when the process
ends, even after a crash. Some disks have no such locks (Lustre as it is often mounted). There, the
existence of a file is the lock; it is left over if its process on the same machine is gone.
"""

import errno
import getpass
import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from datetime import datetime
from pathlib import Path

import msgspec
from filelock import SoftFileLock, Timeout, lock_descriptor

from beliefnest.errors import InputError
from beliefnest.files import make_folder
from beliefnest.owned import Owned

_FOLDER_LOCK = ".in-use"
"""Name of the lock file of a folder of results, while a process writes there."""

_NO_LOCKS = (errno.ENOSYS, errno.EOPNOTSUPP, errno.ENOLCK)
"""Errors of `flock` on disks without such locks."""
_LONGEST = 4096


class Holder(msgspec.Struct, frozen=True):
    """Process that holds a lock.

    Attributes:
        process: Its number.
        machine: Name of the machine on which it runs.
        user: Name of its user.
        since: Local time at which it took the lock, as ISO 8601 without a zone.
    """

    process: int
    machine: str
    user: str
    since: str

    def __str__(self) -> str:
        where = "" if self.machine == socket.gethostname() else f" on {self.machine}"
        return f"process {self.process} of {self.user}{where} since {self.since}"


class LockHeldError(Exception):
    """Refusal of a lock that another process holds; `str()` describes the holder."""


class ProcessLock(Owned):
    """Lock that this process holds until `release` or its end."""

    def __init__(self, path: Path, descriptor: int | None, soft: SoftFileLock | None) -> None:
        super().__init__()
        self._path, self._descriptor, self._soft = path, descriptor, soft

    @classmethod
    def acquire(cls, path: Path) -> "ProcessLock":
        """Take a lock without waiting.

        Args:
            path: File that stands for the lock; it exists while the lock is held.

        Raises:
            LockHeldError: Another process, or another part of this one, holds the lock.
            OSError: The file cannot be created.
        """
        while True:
            descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o644)
            try:
                is_free = lock_descriptor(descriptor, blocking=False)
                if is_free and _is_at(descriptor, path):
                    _note_holder(descriptor)
                    return cls(path, descriptor, None)
                holder = "" if is_free else _read_holder(os.pread(descriptor, _LONGEST, 1))
            except OSError as fault:
                os.close(descriptor)
                if fault.errno in _NO_LOCKS:
                    return cls._acquire_soft(path)
                raise
            os.close(descriptor)
            if holder:
                raise LockHeldError(holder)
            # The holder removed the file after this process opened it and before it locked it.
            # The lock is then on a deleted file: try again with a new one.

    @classmethod
    def _acquire_soft(cls, path: Path) -> "ProcessLock":
        soft = SoftFileLock(f"{path}-soft", timeout=0, thread_local=False)
        try:
            soft.acquire()
        except Timeout:
            raise LockHeldError(_read_holder(path.read_bytes()[:_LONGEST])) from None
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o644)
        _note_holder(descriptor)
        return cls(path, descriptor, soft)

    def release(self) -> None:
        """Release the lock and remove its file; a second call does nothing."""
        if self._descriptor is None:
            return
        # Windows does not remove an open file. A leftover file does no harm: it is not locked.
        with suppress(PermissionError):
            self._path.unlink(missing_ok=True)
        os.close(self._descriptor)
        self._descriptor = None
        if self._soft is not None:
            self._soft.release()

    def disown(self) -> None:
        """Close the lock file in a forked child, so that only the parent holds the lock."""
        if self._descriptor is not None:
            os.close(self._descriptor)
            self._descriptor = None


@contextmanager
def holding(folder: Path, otherwise: str = "name another folder with --out") -> Iterator[None]:
    """Hold a folder of results while its content is written; no other process may write there.

    Args:
        folder: The folder; made if it does not exist.
        otherwise: Advice for the user if the folder is in use, besides waiting.

    Raises:
        InputError: The folder cannot be made, another process writes to it, or it is not writable.
    """
    make_folder(folder)
    try:
        lock = ProcessLock.acquire(folder / _FOLDER_LOCK)
    except LockHeldError as held:
        raise InputError(
            f"the folder {folder} is in use by {held}; wait until it ends, or {otherwise}"
        ) from None
    except OSError as error:
        raise InputError(f"the folder {folder} cannot be written: {error.strerror}") from None
    try:
        yield
    finally:
        lock.release()


def is_lock(file: Path) -> bool:
    """Return True if a file of a folder of results is only the lock on that folder."""
    return file.name.startswith(_FOLDER_LOCK)


def _is_at(descriptor: int, path: Path) -> bool:
    try:
        return os.path.samestat(os.fstat(descriptor), path.stat())
    except FileNotFoundError:
        return False


def _note_holder(descriptor: int) -> None:
    now = datetime.now().isoformat(" ", "seconds")
    holder = Holder(os.getpid(), socket.gethostname(), _user(), now)
    os.truncate(descriptor, 0)
    # On Windows no other process can read the locked byte, which is the first.
    os.pwrite(descriptor, b" " + msgspec.json.encode(holder), 0)


def _read_holder(content: bytes) -> str:
    """Return a description of a holder; its file may be empty for a moment."""
    try:
        return str(msgspec.json.decode(content, type=Holder))
    except (msgspec.DecodeError, UnicodeDecodeError):
        return "another process"


def _user() -> str:
    """Return the name of the user; a container may have none for its number."""
    try:
        return getpass.getuser()
    except (KeyError, OSError):
        return f"user {os.getuid()}"
