"""Compression of bytes in files, by Zstandard."""

import sys

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
        largest: Greatest number of bytes in it. Damaged or hostile files may declare any size.

    Raises:
        ValueError: The frame is damaged, states no number of bytes, or a larger one.
    """
    reader = zstd.ZstdDecompressor()
    try:
        size = zstd.get_frame_info(frame).decompressed_size
        # A stream of unknown size would be unpacked up to any size.
        if size is None or size > largest:
            raise ValueError(f"a part would unpack to more than {largest:,} bytes")
        data = reader.decompress(frame, max_length=size)
    except zstd.ZstdError as fault:
        raise ValueError(str(fault)) from fault
    if not reader.eof:
        raise ValueError(f"a frame of {len(frame)} bytes ends too early")
    return data
