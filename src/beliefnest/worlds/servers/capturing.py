"""Capture of existing places: on a Minecraft server, or in a file of the game or of WorldEdit."""

from collections.abc import Collection, Sequence
from typing import Any, Literal

import msgspec
import numpy as np
from msgspec.structs import replace

from beliefnest.errors import BeliefNestError, InputError
from beliefnest.world.double_chests import holds_items
from beliefnest.world.frames import BlockGrid, Snapshot
from beliefnest.world.limits import box_fault
from beliefnest.world.registry import Registry
from beliefnest.world.signs import is_sign, sign_fault
from beliefnest.world.texts import quoted, shortened
from beliefnest.world.values import AgentState, Box, Items, Position
from beliefnest.worlds.minecraft import node_messages
from beliefnest.worlds.minecraft.channel import Channel
from beliefnest.worlds.minecraft.launching import started
from beliefnest.worlds.process_limits import ProcessLimits
from beliefnest.worlds.servers.address import ServerAddress
from beliefnest.worlds.servers.server_world import joined

_MOST_NAMED = 5
_LONGEST_NAMED = 40

Unknown = Literal["refuse", "air"]
"""Treatment of blocks and items that this version lacks."""

_Placed = tuple[int, int, int]


class Captured(msgspec.Struct, frozen=True):
    """Place as it was found.

    Attributes:
        snapshot: Everything that a scenario can express; its agents are the players present.
        left_out: Everything else, one sentence for each kind of thing.
    """

    snapshot: Snapshot
    left_out: tuple[str, ...] = ()


class _Found(msgspec.Struct, frozen=True):
    unread: list[_Placed] = []
    unasked: list[str] = []
    strange: list[str] = []


class _Place(msgspec.Struct, frozen=True):
    shape: tuple[int, int, int]
    palette: list[str]
    blocks: node_messages.Cubes
    containers: list[tuple[int, int, int, dict[str, int]]]
    signs: list[tuple[int, int, int, str]]
    special: list[_Placed]


def capture_server(address: ServerAddress, box: Box) -> Captured:
    """Read a place of a server without changing it.

    Args:
        address: The server; its operator moves around there, unseen.
        box: The place, in scenario coordinates, which equal the server's if `at` is 0, 0.

    Raises:
        BodyError: The server cannot be read; the message says what to do.
        InputError: The box is too large, or outside the world.
    """
    if fault := box_fault(box):
        raise InputError(fault)
    channel, _ = joined(address, 0, ProcessLimits())
    answer = _asked(channel, "capture", box=[box.low, box.high], cut=node_messages.CUT)
    seen = msgspec.convert(answer, _Found)
    snapshot, left_out = _said(node_messages.snapshot_of(answer, box), Registry.load())
    if seen.unread:
        left_out.append(f"what is in {_named(seen.unread)}: it does not open there")
    if seen.unasked:
        left_out.append(
            f"what {', '.join(seen.unasked)} have but do not wear or hold: the server has no "
            "/data that could be asked"
        )
    if seen.strange:
        left_out.append(
            "blocks that this version has not, now stone, or air where one can walk: "
            + _named(seen.strange)
        )
    return Captured(snapshot, tuple(left_out))


def capture_file(data: bytes, corner: Position, unknown: Unknown = "refuse") -> Captured:
    """Read a Sponge schematic (`.schem`) or a structure file of the game (`.nbt`).

    Args:
        data: Content of the file.
        corner: Position of the place's lowest corner.
        unknown: What to do if the file names blocks or items that this version of the game lacks:
            `refuse`, or `air`: the blocks become air, and the items are left out.

    Raises:
        WorldError: The file has another format, or the place is too large.
        InputError: The place does not fit into a world there, or this version lacks some of it.
    """
    if unknown not in ("refuse", "air"):
        raise InputError(f"unknown is {quoted(unknown)}; give 'refuse' or 'air'")
    channel, _ = started(0, ProcessLimits())
    answer = _asked(channel, "read_place", bytes=data, cut=node_messages.CUT)
    try:
        place = msgspec.convert(answer, _Place)
    except msgspec.ValidationError as error:
        raise InputError(f"the file is damaged: {shortened(str(error))}") from None
    high = tuple(low + side - 1 for low, side in zip(corner, place.shape, strict=True))
    box = Box(corner, (high[0], high[1], high[2]))
    if fault := box_fault(box):
        raise InputError(f"the file has a bad box: {fault}")
    registry = Registry.load()
    states, lacking = _states(place.palette, registry)
    items = {item for row in place.containers for item in row[3] if not registry.has_item(item)}
    if unknown == "refuse" and (lacking or items):
        raise InputError(_refused(lacking, items, registry))
    numbers = node_messages.terrain_of_cubes(place.blocks, box)
    blocks = numbers.mapped(lambda chunk: states[chunk])

    def there(at: Sequence[int]) -> Position:
        return (at[0] + corner[0], at[1] + corner[1], at[2] + corner[2])

    containers = {there(row[:3]): row[3] for row in place.containers}
    signs = {there(row[:3]): row[3] for row in place.signs}
    snapshot, left_out = _said(Snapshot(0, box, blocks, containers, {}, signs=signs), registry)
    if lacking:
        left_out.append(
            f"blocks that Minecraft {registry.version} has not, now air: {_named(lacking)}"
        )
    if place.special:
        left_out.append(f"names and enchantments of items in {_named(map(there, place.special))}")
    return Captured(snapshot, tuple(left_out))


def _asked(channel: Channel, op: str, **more: Any) -> Any:
    try:
        answer = channel.request(op, **more)
        channel.request("shutdown")
    finally:
        channel.close()
    return answer


def _refused(blocks: Collection[str], items: Collection[str], registry: Registry) -> str:
    """Return the message about a file with blocks or items that this version lacks."""
    parts = [
        f"{what} that Minecraft {registry.version} has not: {_named(names)}"
        for what, names in (("blocks", blocks), ("items", items))
        if names
    ]
    return (
        f"the file has {'; and '.join(parts)}. Replace them there, or give --unknown air "
        "(unknown='air' in Python): the blocks become air, and the items are left out"
    )


def _states(palette: Sequence[str], registry: Registry) -> tuple[BlockGrid, set[str]]:
    """Return the state ids of a palette, and the names in it that this version does not know."""
    states = np.full(len(palette), registry.air, dtype=np.int32)
    unknown: set[str] = set()
    for index, text in enumerate(palette):
        try:
            states[index] = registry.state_id(text)
        except BeliefNestError:
            unknown.add(text)
    return states, unknown


def _said(snapshot: Snapshot, registry: Registry) -> tuple[Snapshot, list[str]]:
    """Return the part of a place that a scenario can express, and sentences about the rest."""
    left_out = []
    blocks = snapshot.blocks.mapped(
        lambda states: np.where(np.isin(states, registry.airs), registry.air, states)
    )
    snapshot = replace(snapshot, blocks=blocks)
    names = {state: registry.name(state) for state in blocks.states}

    def name_at(place: Position) -> str:
        return names[snapshot.blocks[snapshot.box.index(place)]]

    containers: dict[Position, Items] = {}
    others, strange = set(), set()
    for place, items in snapshot.containers.items():
        strange |= {item for item in items if not registry.has_item(item)}
        if registry.is_container(name_at(place)):
            containers[place] = {i: count for i, count in items.items() if registry.has_item(i)}
        elif items:
            others.add(name_at(place))
    for place in snapshot.places([state for state in names if holds_items(registry, state)]):
        containers.setdefault(place, {})
    signs = {
        place: text
        for place, text in snapshot.signs.items()
        if text and is_sign(name_at(place)) and sign_fault(text) is None
    }
    agents = {name: _known(agent, registry, strange) for name, agent in snapshot.agents.items()}
    if others:
        left_out.append(f"what is in blocks that are no containers here: {_named(others)}")
    if strange:
        left_out.append(f"items that Minecraft {registry.version} has not: {_named(strange)}")
    if unsaid := {place for place, text in snapshot.signs.items() if text} - signs.keys():
        left_out.append(f"what is written at {_named(unsaid)}: it does not fit on a sign here")
    return (
        replace(snapshot, containers=dict(sorted(containers.items())), signs=signs, agents=agents),
        left_out,
    )


def _known(agent: AgentState, registry: Registry, strange: set[str]) -> AgentState:
    strange |= {item for item in agent.inventory if not registry.has_item(item)}
    return replace(
        agent,
        inventory={i: n for i, n in agent.inventory.items() if registry.has_item(i)},
        equipment={slot: i for slot, i in agent.equipment.items() if registry.has_item(i)},
    )


def _named(things: Any) -> str:
    named = sorted(shortened(str(thing), _LONGEST_NAMED) for thing in things)
    more = len(named) - _MOST_NAMED
    return ", ".join(named[:_MOST_NAMED]) + (f" and {more} more" if more > 0 else "")
