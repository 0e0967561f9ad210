"""Compression of bytes in files, by Zstandard."""

import sys

from beliefnest.errors import StoreError

if sys.version_info >= (3, 14):
    from compression import zstd
else:
    from backports import zstd

ZSTD_VERSION = zstd.zstd_version


def compressed(data: bytes, level: int) -> bytes:
    """Return bytes as one frame, which states their number; `level` is 1 to 22."""
    return zstd.compress(data, level)


def decompressed(frame: bytes, largest: int) -> bytes:
    """Return the bytes of a frame.

    Args:
        frame: The frame.
        largest: Greatest number of bytes in it. Damaged or hostile frames may hold any number.

    Raises:
        StoreError: The frame is damaged, or holds more bytes.
    """
    reader = zstd.ZstdDecompressor()
    try:
        data = reader.decompress(frame, max_length=largest)
    except zstd.ZstdError as fault:
        raise StoreError(str(fault)) from fault
    if not reader.eof:
        raise StoreError(f"a part is cut, or would unpack to more than {largest:,} bytes")
    return data
