"""Supplements: a study or run with everything to read it and to play it again, in one ZIP file."""

import hashlib
import json
import zipfile
from collections.abc import Mapping
from pathlib import Path, PurePosixPath
from typing import Any

import msgspec

from beliefnest.errors import InputError
from beliefnest.files import read_regular
from beliefnest.llm.secrets import Secrets
from beliefnest.scenarios.record_forms import read_json
from beliefnest.studies.comparing import HASH, Difference

__all__ = ["MANIFEST", "check_secrets", "damaged_files", "unpack", "with_manifest", "write_zip"]

MANIFEST = "bundle.json"
_FORM = "beliefnest bundle 1"
_EPOCH = (1980, 1, 1, 0, 0, 0)
"""Time of all files in a ZIP file, so that equal files give equal bytes."""
_LARGEST = 4 * 2**30
"""Greatest size of an unpacked supplement in bytes."""


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
        InputError: The file cannot be written.
    """
    draft = out.with_name(f"{out.name}.part")
    try:
        with zipfile.ZipFile(draft, "w") as archive:
            for name in sorted(files):
                entry = zipfile.ZipInfo(name, _EPOCH)
                entry.compress_type = zipfile.ZIP_DEFLATED
                # Otherwise the system that writes is in the bytes.
                entry.create_system = 3
                entry.external_attr = 0o644 << 16
                archive.writestr(entry, files[name], compresslevel=9)
        draft.replace(out)
    except OSError as error:
        raise InputError(f"{out} cannot be written: {error.strerror}") from None


def unpack(file: Path, folder: Path) -> Path:
    """Unpack a supplement and return its folder.

    Raises:
        InputError: The file is no supplement.
    """
    try:
        with zipfile.ZipFile(file) as archive:
            if sum(entry.file_size for entry in archive.infolist()) > _LARGEST:
                raise InputError(f"{file} is larger than {_LARGEST:,} bytes when unpacked")
            archive.extractall(folder)
    except FileNotFoundError:
        raise InputError(f"there is no file {file}; give a supplement's ZIP file") from None
    except (zipfile.BadZipFile, OSError, RuntimeError, NotImplementedError) as error:
        raise InputError(
            f"{file} cannot be unpacked: {error}; give a supplement's ZIP file"
        ) from None
    # Archives that were packed again by hand often have one folder around everything.
    inner = [each.parent for each in folder.glob(f"*/{MANIFEST}")]
    return folder if (folder / MANIFEST).is_file() or not inner else inner[0]


def damaged_files(folder: Path) -> list[Difference]:
    """Return the files of a supplement that are missing or have changed; empty without manifest.

    Raises:
        InputError: The manifest is damaged.
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
    found = []
    for name, known in manifest.sha256.items():
        if PurePosixPath(name).is_absolute() or ".." in PurePosixPath(name).parts:
            raise InputError(f"{file} names {name!r}, which is outside of the folder; {remedy}")
        path = folder / name
        there = hashlib.sha256(read_regular(path)).hexdigest() if path.is_file() else None
        if there != known:
            found.append(Difference(name, HASH, known, there))
    return found
