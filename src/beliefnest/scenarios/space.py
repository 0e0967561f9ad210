"""Blocks, containers and signs of a scenario: from a file's entries to block states of a box."""

from collections import Counter
from collections.abc import Iterable, Mapping

from beliefnest.facts.reading import claimed
from beliefnest.scenarios.checks import check_inside, check_items
from beliefnest.scenarios.document import Document, KeyPath
from beliefnest.scenarios.format import BlockEntry, ContainerEntry, ScenarioFile
from beliefnest.scenarios.terrain_entry import terrain_in
from beliefnest.world.double_chests import container_at, holds_items, states_in, whole_chests
from beliefnest.world.frames import PlainClaims
from beliefnest.world.limits import box_fault, slots_at
from beliefnest.world.memory import MEGABYTE, memory_limit
from beliefnest.world.registry import Registry
from beliefnest.world.signs import text_of, written
from beliefnest.world.terrain import Terrain
from beliefnest.world.texts import quoted
from beliefnest.world.values import Box, Items, Position

UNKNOWN = -1
"""Block state id of unknown blocks."""

_BELIEVED_BYTES = 300
"""Bytes of a block that an initial belief gives."""


def build_box(document: Document, file: ScenarioFile) -> Box:
    """Return the box of a scenario; raise ScenarioError if it is too large."""
    box = Box.between(*file.box)
    if fault := box_fault(box):
        raise document.fault(("box",), fault)
    return box


def build_blocks(document: Document, file: ScenarioFile, box: Box, registry: Registry) -> Terrain:
    """Return the block states of the box.

    They are air or those of `terrain`, then the entries in order, then containers and signs. A
    half of a double chest without its other half becomes a single chest.
    """
    ground = Terrain.full(box.shape, registry.air)
    if file.terrain is not None:
        with document.naming(("terrain",)):
            ground = terrain_in(file.terrain, box.shape, registry)
    blocks = ground.draft()
    for number, entry in enumerate(file.blocks):
        path = ("blocks", number)
        if entry.block is None:
            raise document.fault((*path, "block"), "is null; in the real world no block is unknown")
        with document.naming((*path, "block")):
            state = registry.state_id(entry.block)
        for part in parts_of(document, path, entry, box):
            x, y, z = box.index(part.high)
            blocks.fill(box.index(part.low), (x + 1, y + 1, z + 1), state)
    for number, container in enumerate(file.containers):
        path = ("containers", number)
        with document.naming((*path, "block")):
            state = registry.state_id(container.block)
        if not registry.is_container(registry.name(state)):
            raise document.fault((*path, "block"), f"{quoted(container.block)} is no container")
        check_inside(document, (*path, "at"), container.at, box)
        blocks[box.index(container.at)] = state
    for number, sign in enumerate(file.signs):
        path = ("signs", number)
        with document.naming((*path, "block")):
            state = registry.state_id(sign.block)
        check_inside(document, (*path, "at"), sign.at, box)
        blocks[box.index(sign.at)] = state
    return whole_chests(registry, box, blocks.terrain())


def build_signs(
    document: Document, file: ScenarioFile, blocks: Terrain, box: Box, registry: Registry
) -> dict[Position, str]:
    """Return the texts of signs by position; signs without a text are left out."""
    places: set[Position] = set()
    containers = {container.at for container in file.containers}
    texts = {}
    for number, entry in enumerate(file.signs):
        path = ("signs", number)
        if entry.at in containers:
            raise document.fault(
                (*path, "at"),
                f"{list(entry.at)} has a container already; put the sign beside or above it",
            )
        if entry.at in places:
            raise document.fault((*path, "at"), f"{list(entry.at)} has a sign already")
        places.add(entry.at)
        with document.naming(path):
            texts[entry.at] = text_of(written(registry, blocks[box.index(entry.at)], entry.text))
    return {place: text for place, text in sorted(texts.items()) if text}


def build_sign_claims(
    document: Document,
    file: ScenarioFile,
    texts: Mapping[Position, str],
    box: Box,
) -> dict[Position, PlainClaims]:
    """Return the claims of signs by position, as plain data."""
    claims_by_place: dict[Position, PlainClaims] = {}
    for number, entry in enumerate(file.signs):
        for index, fact in enumerate(entry.claims):
            path = ("signs", number, "claims", index)
            with document.naming(path):
                claims = claimed(fact)
                for claim in claims:
                    claim.check(box, file.agents)
            if entry.at not in texts:
                raise document.fault(path, "is for signs with a text; add `text`")
            plain = (claim.plain() for claim in claims)
            claims_by_place[entry.at] = (*claims_by_place.get(entry.at, ()), *plain)
    return claims_by_place


def build_containers(
    document: Document,
    entries: Iterable[ContainerEntry],
    blocks: Terrain,
    box: Box,
    registry: Registry,
) -> dict[Position, Items]:
    """Return the contents of every container in the box; containers without entry are empty.

    What is given for both halves of a double chest is added up.
    """
    containers: dict[Position, Items] = {}
    places_given: set[Position] = set()
    state_at = states_in(box, blocks, registry.air)
    for number, entry in enumerate(entries):
        path = ("containers", number)
        if entry.at in places_given:
            raise document.fault((*path, "at"), f"{list(entry.at)} has a container already")
        places_given.add(entry.at)
        whole = container_at(registry, state_at, entry.at)
        items = Counter(containers.get(whole, {}))
        items.update(entry.items)
        name = registry.name(registry.state_id(entry.block))
        slots = slots_at(registry, state_at, whole)
        check_items(document, (*path, "items"), items, registry, slots, f"a {name}")
        containers[whole] = dict(items)
    empty = [state for state in blocks.states if holds_items(registry, state)]
    x, y, z = box.low
    for i, j, k in blocks.find(empty).tolist() if empty else ():
        containers.setdefault((x + i, y + j, z + k), {})
    return dict(sorted(containers.items()))


def parts_of(document: Document, path: KeyPath, entry: BlockEntry, box: Box) -> list[Box]:
    """Return the cuboids that an entry fills; no two of them overlap."""
    keys = [key for key in ("at", "fill", "walls") if getattr(entry, key) is not None]
    if len(keys) != 1:
        named = " and ".join(keys) or "none of them"
        raise document.fault(path, f"give exactly one of 'at', 'fill' and 'walls'; found {named}")
    key = keys[0]
    corners = (entry.at, entry.at) if entry.at is not None else (entry.fill or entry.walls)
    assert corners is not None  # one of the three is given
    for corner in corners:
        check_inside(document, (*path, key), corner, box)
    whole = Box.between(*corners)
    (x, y, z), (far, top, back) = whole.low, whole.high
    if key != "walls" or far - x < 2 or back - z < 2:
        return [whole]
    return [
        Box((x, y, z), (x, top, back)),
        Box((far, y, z), (far, top, back)),
        Box((x + 1, y, z), (far - 1, top, z)),
        Box((x + 1, y, back), (far - 1, top, back)),
    ]


def believed_fault(count: int) -> str | None:
    """Return the fault of an initial belief that gives a number of blocks, or None."""
    limit = memory_limit()
    if limit is None or count * _BELIEVED_BYTES <= limit.bytes:
        return None
    needed, most = (-(-size // MEGABYTE) for size in (count * _BELIEVED_BYTES, limit.bytes))
    return (
        f"gives {count:,} blocks with the entries before it, which need {needed:,} MB; this "
        f"process may use {most:,} MB, {limit.source}: name blocks that everybody knows in "
        "'static_blocks', or give a smaller part"
    )
