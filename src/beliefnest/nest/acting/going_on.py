"""What a run file keeps of programs that went on where they were cut."""

import msgspec

from beliefnest.bodies.protocol import ProgramPast

__all__ = ["decoded_past", "encoded_past"]


def encoded_past(past: ProgramPast | None) -> bytes | msgspec.UnsetType:
    """What a program had done before, as it is kept; unset if it began anew."""
    return msgspec.UNSET if past is None else msgspec.json.encode(past)


def decoded_past(kept: bytes | msgspec.UnsetType) -> ProgramPast | None:
    """The inverse of `encoded_past`."""
    return None if kept is msgspec.UNSET else msgspec.json.decode(kept, type=ProgramPast)
