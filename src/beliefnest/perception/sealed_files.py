"""Files of machine code with checksums: damaged code would crash the process that runs it."""

import io
from collections.abc import Iterator
from contextlib import contextmanager
from hashlib import blake2b
from pathlib import Path
from pickle import loads
from typing import Any, BinaryIO

from numba.core import caching

_SEAL = 16
"""Length of a checksum in bytes; it stands at the beginning of a file."""


class DamagedFileError(Exception):
    """Content that does not match its checksum; `str()` is the path of the file."""


class SealedFiles(caching.IndexDataCacheFile):
    """Index and data files of one kernel, in numba's form behind a checksum."""

    def _load_index(self) -> dict[Any, str]:
        """Return the names of data files by signature; empty: nothing is stored."""
        try:
            content = _unsealed(Path(self._index_path))
        except FileNotFoundError:
            return {}
        stamp, overloads = loads(content)
        return overloads if stamp == self._stamp else {}

    def _save_index(self, overloads: dict[Any, str]) -> None:
        with self._open_for_write(self._index_path) as file:
            file.write(self._dump((self._stamp, overloads)))

    def _load_data(self, name: str) -> Any:
        return loads(_unsealed(Path(self._data_path(name))))

    @property
    def _stamp(self) -> tuple[str, Any]:
        return self._version, self._source_stamp

    @contextmanager
    def _open_for_write(self, filepath: str) -> Iterator[BinaryIO]:
        content = io.BytesIO()
        yield content
        written = content.getvalue()
        with super()._open_for_write(filepath) as file:
            file.write(_seal(written) + written)


def _unsealed(path: Path) -> bytes:
    content = path.read_bytes()
    if _seal(content[_SEAL:]) != content[:_SEAL]:
        raise DamagedFileError(str(path))
    return content[_SEAL:]


def _seal(content: bytes) -> bytes:
    return blake2b(content, digest_size=_SEAL).digest()
