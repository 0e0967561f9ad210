"""Reader of files with facts of Minecraft, which the build of the package writes."""

from pathlib import Path
from typing import TypeVar

import msgspec

from beliefnest.errors import BodyError

_BUNDLE = Path(__file__).parents[1] / "_bundle"


class Bundled(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Header of each such file: its format and its Minecraft version."""

    format: int
    minecraft: str


FileT = TypeVar("FileT", bound=Bundled)


def read_bundled(kind: str, version: str, form: type[FileT], file_format: int) -> FileT:
    """Read the file of one kind for one Minecraft version.

    Args:
        kind: Kind of facts, which is the first part of the file's name.
        version: Minecraft version.
        form: Type of the content.
        file_format: Expected format number.

    Raises:
        BodyError: The file is missing, damaged or from another build.
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
