"""Codec that converts world values to bytes and back; no other module does this.

The bytes are msgpack. Floats keep every bit, block positions are map keys, and sequences inside the
details of events are decoded as tuples. Decoding is strict: a value of another type, or a missing
or misspelt kind, raises a StoreError that names the place inside the value.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Literal, TypeVar, cast

import msgspec
import numpy as np
from msgspec.structs import replace

from beliefnest.errors import StoreError
from beliefnest.timeline.journal import Edit, Entry
from beliefnest.world.frames import Frame, Snapshot
from beliefnest.world.limits import box_fault
from beliefnest.world.packing import packed, unpacked
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import AgentState, Box, DroppedItem, Event, Items, Position

T = TypeVar("T")

_COMPRESSION = 1
"""Compression level, as for the entries of timelines (see `timeline/chunks.py`)."""


class _FrameEntry(msgspec.Struct, tag="frame", array_like=True):
    value: Frame


class _EditEntry(msgspec.Struct, tag="edit", array_like=True):
    value: Edit


class _Tick(msgspec.Struct):
    tick: int


class _Agents(msgspec.Struct):
    agents: dict[str, msgspec.Raw] = {}


_Tag = Literal["frame", "edit"]


class _SnapshotBody(msgspec.Struct, forbid_unknown_fields=True, omit_defaults=True):
    """Snapshot as it is stored.

    A box of one chunk has the states of all cells in `blocks`, and `chunks` is 0. Otherwise
    `chunks` is the number of different chunks (see `world.terrain`), and `blocks` has, compressed,
    the number of the chunk at each place and then the states of each chunk.
    """

    tick: int
    low: Position
    high: Position
    blocks: bytes
    containers: Mapping[Position, Items]
    agents: Mapping[str, AgentState]
    items: Mapping[int, DroppedItem]
    signs: Mapping[Position, str] = {}
    sign_claims: Mapping[Position, tuple[Mapping[str, Any], ...]] = {}
    chunks: int = 0


def _plain(value: object) -> object:
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(f"{type(value).__name__} is not a value of a world")


_ENCODER = msgspec.msgpack.Encoder(enc_hook=_plain)
_ENTRY = msgspec.msgpack.Decoder(_FrameEntry | _EditEntry)
_ENTRY_TICK = msgspec.msgpack.Decoder(tuple[_Tag, _Tick])
_ENTRY_AGENTS = msgspec.msgpack.Decoder(tuple[_Tag, _Agents])
_AGENTS = msgspec.msgpack.Decoder(dict[str, AgentState | None])
_ENCODED = msgspec.msgpack.Decoder(list[msgspec.Raw])


def encode(value: object) -> bytes:
    """Encode values of a world or plain data; StoreError if there is any other value."""
    try:
        return _ENCODER.encode(value)
    except (TypeError, OverflowError, ValueError, msgspec.MsgspecError) as fault:
        raise StoreError(f"{type(value).__name__} cannot be stored: {fault}") from fault


def decode(data: bytes, kind: type[T]) -> T:
    """Decode a value of type `kind`; StoreError if the bytes hold none."""
    return cast(T, _with_tuples(_decoded(msgspec.msgpack.Decoder(kind), data, kind.__name__)))


def encode_entry(entry: Entry) -> bytes:
    """Encode a frame or an edit, with a tag that tells them apart; StoreError as above."""
    return encode(_FrameEntry(entry) if isinstance(entry, Frame) else _EditEntry(entry))


def decode_entry(data: bytes | msgspec.Raw) -> Entry:
    """Decode a frame or an edit; StoreError if the bytes hold neither."""
    return cast(Entry, _with_tuples(_decoded(_ENTRY, data, "entry of a timeline").value))


def decode_agents(data: bytes) -> dict[str, AgentState | None]:
    """Decode a mapping from names to agents; StoreError if the bytes hold none."""
    return _decoded(_AGENTS, data, "agents")


def decode_last_agents(entries: Iterable[msgspec.Raw]) -> dict[str, AgentState | None]:
    """Return the last state of each agent that encoded entries name.

    Raises:
        StoreError: Some bytes are not an entry.
    """
    # Keep the states encoded while scanning: most are overwritten by later entries.
    last: dict[str, msgspec.Raw] = {}
    for entry in entries:
        last.update(_decoded(_ENTRY_AGENTS, entry, "entry of a timeline")[1].agents)
    return decode_agents(_ENCODER.encode(last))


def join(entries: Iterable[bytes | msgspec.Raw]) -> bytes:
    """Concatenate encoded entries; `split` is the inverse."""
    return _ENCODER.encode([msgspec.Raw(entry) for entry in entries])


def split(data: bytes) -> list[msgspec.Raw]:
    """Split joined entries again; StoreError if the bytes are not joined entries."""
    return _decoded(_ENCODED, data, "entries of a timeline")


def decode_ticks(encoded: Sequence[msgspec.Raw]) -> list[int]:
    """Return the ticks of encoded entries without decoding the rest; StoreError as above."""
    return [_decoded(_ENTRY_TICK, entry, "entry of a timeline")[1].tick for entry in encoded]


def encode_snapshot(snapshot: Snapshot) -> bytes:
    """Encode a snapshot; equal snapshots have equal bytes.

    Block states become 32-bit little-endian integers, x slowest. Those of a box of several chunks
    are compressed, each different chunk once.

    Raises:
        StoreError: The shapes of grid and box differ, or the snapshot holds a value that is not a
            world's.
    """
    if snapshot.blocks.shape != snapshot.box.shape:
        raise StoreError(
            f"a grid of shape {snapshot.blocks.shape} does not fill {snapshot.box}, "
            f"which takes {snapshot.box.shape}"
        )
    blocks, chunks = _blocks_to(snapshot.blocks)
    return encode(
        _SnapshotBody(
            snapshot.tick,
            snapshot.box.low,
            snapshot.box.high,
            blocks,
            snapshot.containers,
            snapshot.agents,
            snapshot.items,
            dict(sorted(snapshot.signs.items())),
            dict(sorted(snapshot.sign_claims.items())),
            chunks,
        )
    )


def decode_snapshot(data: bytes) -> Snapshot:
    """Decode a snapshot with a read-only grid; StoreError if the bytes hold none."""
    body = decode(data, _SnapshotBody)
    box = Box(body.low, body.high)
    return Snapshot(
        body.tick,
        box,
        _blocks_from(body, box),
        body.containers,
        body.agents,
        body.items,
        signs=body.signs,
        sign_claims={at: _frozen(claims) for at, claims in body.sign_claims.items()},
    )


def _blocks_to(terrain: Terrain) -> tuple[bytes, int]:
    """Return `blocks` and `chunks` of `_SnapshotBody`."""
    if terrain.is_dense:
        return terrain.dense().astype("<i4").tobytes(), 0
    return packed(terrain, _COMPRESSION)


def _blocks_from(body: _SnapshotBody, box: Box) -> Terrain:
    """Return the block states of a stored snapshot; StoreError if they do not fill the box."""
    if min(box.shape) > 0 and not body.chunks and len(body.blocks) == 4 * math.prod(box.shape):
        return Terrain.of(np.frombuffer(body.blocks, "<i4").reshape(box.shape))
    if not body.chunks or (fault := box_fault(box)):
        reason = f": {fault}" if body.chunks else ""
        raise StoreError(f"stored grid of {len(body.blocks)} bytes does not fill {box}{reason}")
    try:
        return unpacked(body.blocks, box.shape, body.chunks)
    except ValueError as damage:
        raise StoreError(f"stored blocks of {box} are damaged: {damage}") from damage


def _decoded(decoder: msgspec.msgpack.Decoder[T], data: bytes | msgspec.Raw, what: str) -> T:
    try:
        return decoder.decode(data)
    except (msgspec.MsgspecError, UnicodeDecodeError) as fault:
        raise StoreError(f"stored bytes are no {what}: {fault}") from fault


def _with_tuples(value: Any) -> Any:
    """Return the value with every sequence inside the details of its events as a tuple."""
    if isinstance(value, Frame) and value.events:
        return replace(value, events=tuple(map(_with_tuples, value.events)))
    if isinstance(value, Event):
        return replace(value, detail=_frozen(value.detail))
    return value


def _frozen(value: Any) -> Any:
    if isinstance(value, list):
        return tuple(_frozen(item) for item in value)
    if isinstance(value, dict):
        return {name: _frozen(item) for name, item in value.items()}
    return value
