"""Supplements: a study or run with everything to read it and to play it again, in one ZIP file."""

import hashlib
import io
import json
import lzma
import stat
import struct
import zipfile
import zlib
from collections.abc import Mapping
from pathlib import Path, PurePosixPath
from typing import Any

import msgspec

from beliefnest.errors import InputError
from beliefnest.files import open_regular, os_errors_of, read_regular, replacing
from beliefnest.llm.secrets import Secrets
from beliefnest.scenarios.record_forms import read_json
from beliefnest.studies.comparing import ADDED, HASH, PairedDifference
from beliefnest.world.texts import is_well_formed, quoted, shortened

MANIFEST = "bundle.json"
_FORM = "beliefnest bundle 1"
_EPOCH = (1980, 1, 1, 0, 0, 0)
"""Time of all files in a ZIP file, so that equal files give equal bytes."""
_LARGEST = 4 * 2**30
"""Greatest size of an unpacked supplement in bytes."""
_MOST_TIMES = 100
"""Greatest ratio of the unpacked size to the size of an archive that unpacks to `_MUCH` bytes."""
_MUCH = 2**28
_MOST_FILES = 50_000
_LONGEST_LIST = 2**23
"""Greatest size in bytes of an archive's list of files."""
_BLOCK = 2**20
_READ_BELOW = ("inputs", "answers", "cells")
"""Folders of a supplement whose files are all in its manifest."""
_UNREADABLE = (
    *(zipfile.BadZipFile, zlib.error, lzma.LZMAError, struct.error, EOFError),
    *(OSError, RuntimeError, NotImplementedError, ValueError, OverflowError),
)
"""Exceptions by which `zipfile` refuses a damaged file, or a kind of packing that it lacks."""


class _Manifest(msgspec.Struct):
    form: str
    kind: str
    versions: dict[str, str]
    sha256: dict[str, str]


def with_manifest(
    files: Mapping[str, bytes], kind: str, versions: Mapping[str, str]
) -> dict[str, bytes]:
    """Return files with a manifest: the versions of programs, and the hash of each file.

    Args:
        files: Contents by path.
        kind: `study` or `run`.
        versions: Versions of the programs that wrote the results.
    """
    manifest = {
        "form": _FORM,
        "kind": kind,
        "versions": dict(versions),
        "sha256": {name: hashlib.sha256(content).hexdigest() for name, content in files.items()},
    }
    text = json.dumps(manifest, indent=1, sort_keys=True) + "\n"
    return {**files, MANIFEST: text.encode()}


def check_secrets(files: Mapping[str, bytes], secrets: Secrets) -> None:
    """Refuse files that contain a key or password of this machine.

    Raises:
        InputError: A file contains one; the message names the file.
    """
    for name, content in files.items():
        text = content.decode("utf-8", errors="replace")
        if secrets.masked_answer(text) != text:
            raise InputError(
                f"{name} contains a key or password that is set on this machine; remove it there, "
                "and bundle again"
            )


def write_zip(files: Mapping[str, bytes], out: Path) -> None:
    """Write a ZIP file; the same files give the same bytes.

    Raises:
        InputError: There are too many files to be read back, or the file cannot be written.
    """
    if len(files) > _MOST_FILES:
        raise InputError(
            f"{out} would hold {len(files):,} files; a supplement has at most {_MOST_FILES:,}: "
            "bundle the study in parts"
        )
    with (
        os_errors_of(out, "written"),
        replacing(out) as file,
        zipfile.ZipFile(file, "w") as archive,
    ):
        for name in sorted(files):
            entry = zipfile.ZipInfo(name, _EPOCH)
            entry.compress_type = zipfile.ZIP_DEFLATED
            # Otherwise the system that writes is in the bytes.
            entry.create_system = 3
            entry.external_attr = 0o644 << 16
            archive.writestr(entry, files[name], compresslevel=9)


class _InParts(io.BufferedReader):
    """File that is read in parts; `zipfile` reads the list of files, and nothing else, at once."""

    def read(self, size: int | None = -1, /) -> bytes:
        """Read at most `size` bytes; more than such a list may have are refused."""
        if size is not None and size > _LONGEST_LIST:
            raise zipfile.BadZipFile(
                f"its list of files has {size:,} bytes, of at most {_LONGEST_LIST:,}"
            )
        return super().read(size)


def unpack(file: Path, folder: Path) -> Path:
    """Unpack a supplement and return its folder.

    Raises:
        InputError: The file is no supplement.
    """
    try:
        with (
            open_regular(file) as opened,
            _InParts(io.FileIO(opened.fileno(), closefd=False)) as parts,
            zipfile.ZipFile(parts) as archive,
        ):
            _unpack_all(archive, file, folder)
    except FileNotFoundError:
        raise InputError(f"there is no file {file}; give a supplement's ZIP file") from None
    except _UNREADABLE as error:
        raise InputError(
            f"{file} cannot be unpacked: {shortened(str(error))}; give a supplement's ZIP file"
        ) from None
    # Archives that were packed again by hand often have one folder around everything.
    inner = [each.parent for each in folder.glob(f"*/{MANIFEST}")]
    return folder if (folder / MANIFEST).is_file() or not inner else inner[0]


def _unpack_all(archive: zipfile.ZipFile, file: Path, folder: Path) -> None:
    entries = archive.infolist()
    size = sum(entry.file_size for entry in entries)
    if size > _LARGEST or len(entries) > _MOST_FILES:
        raise InputError(
            f"{file} would unpack to {len(entries):,} files of {size:,} bytes; at most "
            f"{_MOST_FILES:,} files of {_LARGEST:,} bytes are read"
        )
    if size > max(_MUCH, _MOST_TIMES * file.stat().st_size):
        raise InputError(
            f"{file} would unpack to more than {_MOST_TIMES} times its size; it is no supplement"
        )
    # Names that differ in capitals alone are one file on some systems.
    seen: set[str] = set()
    for entry in entries:
        name = entry.filename
        if not _is_inside(name) or name.casefold() in seen:
            why = "twice" if name.casefold() in seen else "outside of its folder"
            raise InputError(f"{file} has the file {quoted(name)} {why}; it is no supplement")
        if stat.S_IFMT(entry.external_attr >> 16) not in (0, stat.S_IFREG, stat.S_IFDIR):
            raise InputError(f"{file}: {quoted(name)} is no regular file; it is no supplement")
        seen.add(name.casefold())
        path = folder / name
        if entry.is_dir():
            path.mkdir(parents=True, exist_ok=True)
            continue
        path.parent.mkdir(parents=True, exist_ok=True)
        with archive.open(entry) as packed, path.open("xb") as unpacked:
            # An entry may hold more than it declares.
            left = entry.file_size
            while block := packed.read(min(_BLOCK, left + 1)):
                left -= len(block)
                if left < 0:
                    raise InputError(f"{file}: {quoted(name)} is longer than it says")
                unpacked.write(block)


def _is_inside(name: str) -> bool:
    """Return True if the name of a file is relative, and stays in its folder on any system."""
    path = PurePosixPath(name)
    strange = path.is_absolute() or ".." in path.parts or any(c in name for c in "\\:\0")
    return bool(path.parts) and not strange and is_well_formed(name)


def inside(folder: Path, name: str) -> Path:
    """Return the path of a file that a supplement names.

    Raises:
        InputError: The file is not inside the supplement.
    """
    path = folder / name
    if not _is_inside(name) or not path.resolve().is_relative_to(folder.resolve()):
        raise InputError(
            f"{folder} names the file {quoted(name)}, which is not inside of it; a supplement "
            "holds all that it needs"
        )
    return path


def damaged_files(folder: Path, kind: str) -> list[PairedDifference]:
    """Return the files of a supplement that are missing, have changed, or were added.

    The list is empty if there is no manifest: the folder is no supplement.

    Args:
        folder: The folder.
        kind: What the folder holds: `study` or `run`.

    Raises:
        InputError: The manifest is damaged, or is that of another kind of results.
    """
    file = folder / MANIFEST
    if not file.is_file():
        return []
    remedy = "unpack the supplement again"
    content: dict[str, Any] = read_json(file, remedy)
    try:
        manifest = msgspec.convert(content, _Manifest)
    except msgspec.ValidationError as error:
        raise InputError(f"{file} is damaged: {error}; {remedy}") from None
    damaged = []
    if manifest.form != _FORM or manifest.kind != kind:
        raise InputError(
            f"{file} is that of a {quoted(manifest.kind)} in the form {quoted(manifest.form)}, "
            f"and the folder holds a {kind} of the form {quoted(_FORM)}; {remedy}"
        )
    for name, digest in manifest.sha256.items():
        path = inside(folder, name)
        there = hashlib.sha256(read_regular(path)).hexdigest() if path.is_file() else None
        if there != digest:
            damaged.append(PairedDifference(name, HASH, digest, there))
    present = {
        path.relative_to(folder).as_posix()
        for name in _READ_BELOW
        for path in (folder / name).rglob("*")
        if path.is_file() and path.suffix != ".lock"
    }
    added = sorted(present - manifest.sha256.keys())
    return [*damaged, *(PairedDifference(name, ADDED, None, None) for name in added)]
