"""Safe reading of files that a user names: regular files of limited size.

A FIFO would block the reader, and a device could be endless.
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
    """Open a regular file for binary reading.

    Raises:
        OSError: The file cannot be opened or is not regular; `strerror` says which.
    """
    # O_NONBLOCK: do not wait for a writer of a FIFO. It has no effect on regular files.
    descriptor = os.open(path, os.O_RDONLY | os.O_CLOEXEC | os.O_NONBLOCK)
    mode = os.fstat(descriptor).st_mode
    if not stat.S_ISREG(mode):
        os.close(descriptor)
        if stat.S_ISDIR(mode):
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
        raise OSError(errno.EINVAL, f"{_kind(mode)}, not a regular file", str(path))
    return os.fdopen(descriptor, "rb")


def read_regular(path: Path, longest: int = _LONGEST) -> bytes:
    """Return the content of a regular file of at most `longest` bytes.

    Raises:
        OSError: The file cannot be read, is not regular or is too long; `strerror` says which.
    """
    with open_regular(path) as file:
        content = file.read(longest + 1)
    if len(content) > longest:
        raise OSError(errno.EFBIG, f"it is longer than {longest:,} bytes", str(path))
    return content


def read_regular_text(path: Path, longest: int = _LONGEST) -> str:
    """Return the text of a regular file, with Unix line ends.

    Raises:
        OSError: As `read_regular`.
        UnicodeDecodeError: The file is not UTF-8.
    """
    text = read_regular(path, longest).decode()
    return text.replace("\r\n", "\n").replace("\r", "\n")


def decode_json(content: bytes | str, form: type[_T]) -> _T:
    """Decode JSON and validate it against a type.

    Raises:
        msgspec.DecodeError: The content is not JSON, is nested too deeply, or has another form.
    """
    try:
        return msgspec.json.decode(content, type=form)
    except RecursionError:
        raise msgspec.DecodeError("it is nested too deeply") from None
    except UnicodeError as fault:
        raise msgspec.DecodeError(f"it is not UTF-8 text: {fault}") from None


def _kind(mode: int) -> str:
    return next((name for is_kind, name in _KINDS if is_kind(mode)), "it is something else")
