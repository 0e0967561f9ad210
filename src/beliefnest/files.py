"""Reading files that a person names: regular ones, and no larger than what is asked for allows.

A FIFO would keep a reader waiting, a device could go on for ever.
"""

import errno
import os
import stat
from pathlib import Path
from typing import BinaryIO, TypeVar

import msgspec

__all__ = ["decode_json", "open_regular", "read_regular", "read_regular_text"]

_T = TypeVar("_T")
_LONGEST = 64 * 2**20
_KINDS = (
    (stat.S_ISFIFO, "it is a FIFO"),
    (stat.S_ISSOCK, "it is a socket"),
    (stat.S_ISCHR, "it is a device"),
    (stat.S_ISBLK, "it is a device"),
)


def open_regular(path: Path) -> BinaryIO:
    """Return a file opened to be read in binary.

    Raises:
        OSError: It cannot be opened or is no regular file; `strerror` says what it is.
    """
    # Not to wait for whoever might write into a FIFO; it changes nothing for regular files.
    descriptor = os.open(path, os.O_RDONLY | os.O_CLOEXEC | os.O_NONBLOCK)
    mode = os.fstat(descriptor).st_mode
    if not stat.S_ISREG(mode):
        os.close(descriptor)
        if stat.S_ISDIR(mode):
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
        raise OSError(errno.EINVAL, f"{_kind(mode)}, not a regular file", str(path))
    return os.fdopen(descriptor, "rb")


def read_regular(path: Path, longest: int = _LONGEST) -> bytes:
    """Return all of a file, if it is no longer than `longest` bytes.

    Raises:
        OSError: It cannot be read, is no regular file or is too long; `strerror` says which.
    """
    with open_regular(path) as file:
        content = file.read(longest + 1)
    if len(content) > longest:
        raise OSError(errno.EFBIG, f"it is longer than {longest:,} bytes", str(path))
    return content


def read_regular_text(path: Path, longest: int = _LONGEST) -> str:
    """Return all of a file as text, its line ends as those of Unix.

    Raises:
        OSError: As `read_regular`.
        UnicodeDecodeError: It is not UTF-8.
    """
    text = read_regular(path, longest).decode()
    return text.replace("\r\n", "\n").replace("\r", "\n")


def decode_json(content: bytes | str, form: type[_T]) -> _T:
    """Return a value of a form from JSON.

    Raises:
        msgspec.DecodeError: The content is no JSON, is nested without end, or has another form.
    """
    try:
        return msgspec.json.decode(content, type=form)
    except RecursionError:
        raise msgspec.DecodeError("it is nested too deep") from None
    except UnicodeError as fault:
        raise msgspec.DecodeError(f"it is no UTF-8 text: {fault}") from None


def _kind(mode: int) -> str:
    return next((name for is_kind, name in _KINDS if is_kind(mode)), "it is something else")
