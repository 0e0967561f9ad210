"""Facts of Minecraft in files that are written when the package is built."""

from pathlib import Path
from typing import TypeVar

import msgspec

from beliefnest.errors import BodyError

__all__ = ["Bundled", "read_bundled"]

_BUNDLE = Path(__file__).parents[1] / "_bundle"


class Bundled(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What every such file says of itself: its format and the version it is about."""

    format: int
    minecraft: str


FileT = TypeVar("FileT", bound=Bundled)


def read_bundled(kind: str, version: str, form: type[FileT], file_format: int) -> FileT:
    """Return the facts of one kind about one Minecraft version.

    Args:
        kind: What the file is called before its version.
        version: Of Minecraft.
        form: Its content.
        file_format: The one that is read.

    Raises:
        BodyError: There is no such file, or it is damaged or of another build.
    """
    path = _BUNDLE / f"{kind}-{version}.msgpack"
    try:
        content = path.read_bytes()
    except FileNotFoundError:
        raise BodyError(
            f"there is no {kind} of Minecraft {version} at {path}: "
            "build the package with `pip install .`"
        ) from None
    try:
        file = msgspec.msgpack.decode(content, type=form)
    except msgspec.MsgspecError as error:
        raise BodyError(
            f"{path} is damaged ({error}): build it anew with `pip install .`"
        ) from None
    if (file.format, file.minecraft) != (file_format, version):
        raise BodyError(
            f"{path} holds Minecraft {file.minecraft}, format {file.format}, where {version}, "
            f"format {file_format} was expected: build it anew with `pip install .`"
        )
    return file
