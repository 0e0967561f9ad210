"""Frames of compressed bytes, as run files hold them."""

import pytest

from beliefnest.errors import StoreError
from beliefnest.world.compression import compressed, decompressed

TEXT = b"Sally puts the marble into the basket. " * 40
FRAMES = {
    1: b"(\xb5/\xfd`\x18\x05m\x01\x00$\x02Sally puts the marble intobasket. \x02\x00\xee)\xf5\xb9#"
    b"\xcc1",
    19: b"(\xb5/\xfd`\x18\x05\x85\x01\x00t\x02Sally puts the marble into the basket. \x01\x00wO"
    b"\xfd\xea\t",
}
"""Frames of the text by the package zstandard 0.25, which wrote run files until November 2026."""


@pytest.mark.parametrize("level", FRAMES)
def test_frames_of_earlier_versions_are_read(level):
    assert decompressed(FRAMES[level], len(TEXT)) == TEXT


@pytest.mark.parametrize("text", [b"", TEXT], ids=["empty", "text"])
def test_what_is_compressed_is_read(text):
    frame = compressed(text, 1)
    assert decompressed(frame, len(text)) == text
    assert len(frame) < 100


@pytest.mark.parametrize(
    ("frame", "fault"),
    [
        (compressed(TEXT + b".", 1), "more than 1,560 bytes"),
        (FRAMES[1][:-1], "is cut"),
        (FRAMES[1].replace(b"\x18\x05", b"\x10\x05"), "is cut|decompress"),
        (FRAMES[1].replace(b"\x18\x05", b"\x18\x04"), "is cut|decompress"),
        (b"", "is cut"),
        (b"text", "decompress"),
    ],
    ids=["large", "cut", "less", "much less", "empty", "text"],
)
def test_damaged_frames_are_refused(frame, fault):
    with pytest.raises(StoreError, match=fault):
        decompressed(frame, len(TEXT))
