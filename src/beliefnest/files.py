"""Safe reading and replacing of files that a user names.

Regular files of limited size are read: a FIFO would block the reader, and a device could be
endless. A file is replaced as a whole or not at all.
"""

import errno
import os
import secrets
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO, TypeVar

import msgspec

from beliefnest.errors import InputError

_T = TypeVar("_T")
_LONGEST = 64 * 2**20
_LONGEST_STEM = 200
"""Characters of a file's name in the name of its draft: names have at most 255 bytes."""

_KINDS = (
    (stat.S_ISFIFO, "it is a FIFO"),
    (stat.S_ISSOCK, "it is a socket"),
    (stat.S_ISCHR, "it is a device"),
    (stat.S_ISBLK, "it is a device"),
)


def make_folder(folder: Path) -> None:
    """Make a folder and those above it, unless they are there.

    Raises:
        InputError: Something else is in its place, or it cannot be made.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except (FileExistsError, NotADirectoryError):
        places = (each for each in (folder, *folder.parents) if os.path.lexists(each))
        file = next(each for each in places if not each.is_dir())
        raise InputError(f"{file} is no folder; name another folder, or move it away") from None
    except OSError as error:
        raise InputError(
            f"the folder {folder} cannot be written: {error.strerror}; check its permissions, or "
            "name another folder"
        ) from None


@contextmanager
def os_errors_of(place: object, done: str, remedy: str = "") -> Iterator[None]:
    """Raise InputError in place of an error of the system, with the name of a file.

    Args:
        place: The file, or words for it.
        done: What cannot be done with it: `read` or `written`.
        remedy: What to do, for the end of the message.
    """
    try:
        yield
    except OSError as error:
        end = f"; {remedy}" if remedy else ""
        raise InputError(f"{place} cannot be {done}: {error.strerror}{end}") from None


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


def replace_file(path: Path, content: str | bytes) -> None:
    """Write a file anew, or leave it as it is if that fails.

    Args:
        path: The file; there need not be one. A symbolic link stays, and its target is replaced.
        content: Bytes, or a text that is written as UTF-8 as it is.

    Raises:
        OSError: The file cannot be written.
        UnicodeEncodeError: The text has half of a surrogate pair in it.
    """
    body = content.encode() if isinstance(content, str) else content
    with replacing(path) as file:
        file.write(body)


@contextmanager
def replacing(path: Path) -> Iterator[BinaryIO]:
    """Open a file for the block to write its new content to; replace it when the block ends.

    The content is written to a file beside it and synchronised with the disk; then that file gets
    the name. If the block raises, the old file stays. A FIFO or a device, such as `/dev/stdout`, is
    written directly: there is nothing to keep.

    Raises:
        OSError: The file cannot be written.
    """
    target = Path(os.path.realpath(path))
    old = target.stat() if target.exists() else None
    if old is not None and not stat.S_ISREG(old.st_mode):
        with target.open("wb") as file:
            yield file
        return
    if old is not None and not os.access(target, os.W_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(path))
    draft = target.with_name(f".{target.name[:_LONGEST_STEM]}.{secrets.token_hex(4)}.part")
    # The system takes the user's mask off the mode of a new file.
    descriptor = os.open(draft, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o666)
    try:
        with os.fdopen(descriptor, "wb") as file:
            if old is not None:
                draft.chmod(stat.S_IMODE(old.st_mode))
            yield file
            file.flush()
            os.fsync(file.fileno())
        draft.replace(target)
    except BaseException:
        draft.unlink(missing_ok=True)
        raise
    _sync_folder(target.parent)


@contextmanager
def new_file(path: Path) -> Iterator[BinaryIO]:
    """Open a file that does not exist yet for the block to write; remove it if the block raises.

    Raises:
        InputError: The file exists already, or it cannot be written.
    """
    with os_errors_of(path, "written"):
        try:
            opened = path.open("xb")
        except FileExistsError:
            raise InputError(f"{path} exists already; choose another name") from None
        with opened as file:
            try:
                yield file
                file.flush()
                os.fsync(file.fileno())
            except BaseException:
                path.unlink(missing_ok=True)
                raise


def _sync_folder(folder: Path) -> None:
    """Synchronise a folder with the disk, so that the new name of a file survives a loss of power.

    Some file systems cannot; the content of the file is synchronised already.
    """
    with suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY | os.O_CLOEXEC)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)


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
