"""Secret key of this user, by which the program knows the checkpoints that it wrote itself.

A checkpoint replaces entries, and its numbers go to compiled kernels. Nothing in a file can prove
that a checkpoint of a stranger is what its entries lead to. So only own ones are used; without them
a run reads the same, more slowly.
"""

import os
import secrets
from contextlib import suppress
from functools import cache
from hashlib import blake2b
from hmac import compare_digest
from pathlib import Path

from beliefnest.files import read_regular

MARK_BYTES = 32
_KEY_BYTES = 32


class Marks:
    """Marks that only somebody who has a key can make.

    Args:
        key: The key; None: a new one, which ends with this object.
    """

    def __init__(self, key: bytes | None = None) -> None:
        self._key = secrets.token_bytes(_KEY_BYTES) if key is None else key

    def of(self, name: str, number: int, body: bytes) -> bytes:
        """Return the mark of some bytes with a name and a number."""
        digest = blake2b(f"{number} {name}\0".encode(), key=self._key, digest_size=MARK_BYTES)
        digest.update(body)
        return digest.digest()

    def marked(self, name: str, number: int, body: bytes) -> bytes:
        """Return some bytes with their mark at the end."""
        return body + self.of(name, number, body)

    def unmarked(self, name: str, number: int, marked: bytes) -> bytes | None:
        """Return the bytes before a mark; None if the mark is not theirs."""
        body, mark = marked[:-MARK_BYTES], marked[-MARK_BYTES:]
        return body if compare_digest(mark, self.of(name, number, body)) else None


@cache
def own_marks() -> Marks:
    """Return the marks of this user: the key is in the user's folder for data.

    Where there is no such folder, or none that can be written, the key ends with the process.
    """
    # Imported here because most processes neither write checkpoints nor look for any.
    from platformdirs import user_data_path

    with suppress(OSError):
        return Marks(_key_in(user_data_path("beliefnest", appauthor=False)))
    return Marks()


def _key_in(folder: Path) -> bytes:
    """Return the key in a folder, which is made if there is none; OSError if it cannot be."""
    file = folder / "checkpoint-key"
    if not file.exists():
        folder.mkdir(parents=True, exist_ok=True)
        draft = folder / f"checkpoint-key.{secrets.token_hex(8)}"
        descriptor = os.open(draft, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
        try:
            os.write(descriptor, secrets.token_bytes(_KEY_BYTES))
            os.fsync(descriptor)
            # Of two processes that do this at once, the first one's key stays.
            with suppress(FileExistsError):
                os.link(draft, file)
        finally:
            os.close(descriptor)
            draft.unlink()
    key = read_regular(file)
    if len(key) != _KEY_BYTES:
        raise OSError(f"{file} holds no key")
    return key
