"""Blocks, containers and signs of a scenario: from a file's entries to a grid of block states."""

from collections.abc import Iterable, Mapping

import msgspec
import numpy as np
import numpy.typing as npt

from beliefnest.scenarios.checks import check_inside, check_items
from beliefnest.scenarios.document import Document, KeyPath
from beliefnest.scenarios.format import BlockEntry, ContainerEntry, ScenarioFile
from beliefnest.world.claims import claims_from_plain
from beliefnest.world.frames import BlockGrid, PlainClaims, places_of
from beliefnest.world.limits import box_fault, container_slots
from beliefnest.world.registry import Registry
from beliefnest.world.signs import text_of, written
from beliefnest.world.values import Box, Items, Position

__all__ = [
    "UNKNOWN",
    "build_box",
    "build_containers",
    "build_grid",
    "build_sign_claims",
    "build_signs",
    "entry_mask",
]

UNKNOWN = -1
"""Block state id of unknown blocks."""


def build_box(document: Document, file: ScenarioFile) -> Box:
    """Return the box of a scenario; raise ScenarioError if it is too large."""
    box = Box.between(*file.box)
    if fault := box_fault(box):
        raise document.fault(("box",), fault)
    return box


def build_grid(document: Document, file: ScenarioFile, box: Box, registry: Registry) -> BlockGrid:
    """Return the block states of the box: air, then the entries in order, then containers."""
    grid: BlockGrid = np.full(box.shape, registry.air, dtype=np.int32)
    for number, entry in enumerate(file.blocks):
        path = ("blocks", number)
        if entry.block is None:
            raise document.fault((*path, "block"), "is null; in the real world no block is unknown")
        with document.naming((*path, "block")):
            state = registry.state_id(entry.block)
        grid[entry_mask(document, path, entry, box)] = state
    for number, container in enumerate(file.containers):
        path = ("containers", number)
        with document.naming((*path, "block")):
            state = registry.state_id(container.block)
        if not registry.is_container(registry.name(state)):
            raise document.fault((*path, "block"), f"{container.block!r} is no container")
        check_inside(document, (*path, "at"), container.at, box)
        grid[box.index(container.at)] = state
    for number, sign in enumerate(file.signs):
        path = ("signs", number)
        with document.naming((*path, "block")):
            state = registry.state_id(sign.block)
        check_inside(document, (*path, "at"), sign.at, box)
        grid[box.index(sign.at)] = state
    return grid


def build_signs(
    document: Document,
    file: ScenarioFile,
    grid: BlockGrid,
    box: Box,
    registry: Registry,
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
            texts[entry.at] = text_of(written(registry, int(grid[box.index(entry.at)]), entry.text))
    return {place: text for place, text in sorted(texts.items()) if text}


def build_sign_claims(
    document: Document, file: ScenarioFile, texts: Mapping[Position, str], box: Box
) -> dict[Position, PlainClaims]:
    """Return the claims of signs by position, as plain data."""
    found: dict[Position, PlainClaims] = {}
    for number, entry in enumerate(file.signs):
        for index, told in enumerate(entry.claims):
            path = ("signs", number, "claims", index)
            with document.naming(path):
                (claim,) = claims_from_plain((msgspec.to_builtins(told),))
                claim.check(box, file.agents)
            if entry.at not in texts:
                raise document.fault(path, "is for signs with a text; add `text`")
            found[entry.at] = (*found.get(entry.at, ()), claim.plain())
    return found


def build_containers(
    document: Document,
    entries: Iterable[ContainerEntry],
    grid: BlockGrid,
    box: Box,
    registry: Registry,
) -> dict[Position, Items]:
    """Return the contents of every container in the grid; containers without entry are empty."""
    found: dict[Position, Items] = {}
    for number, entry in enumerate(entries):
        path = ("containers", number)
        if entry.at in found:
            raise document.fault((*path, "at"), f"{list(entry.at)} has a container already")
        name = registry.name(registry.state_id(entry.block))
        slots = container_slots(name)
        check_items(document, (*path, "items"), entry.items, registry, slots, f"a {name}")
        found[entry.at] = dict(entry.items)
    for state in np.unique(grid).tolist():
        if registry.is_container(registry.name(state)):
            for place, _ in places_of(grid == state, box):
                found.setdefault(place, {})
    return dict(sorted(found.items()))


def entry_mask(
    document: Document, path: KeyPath, entry: BlockEntry, box: Box
) -> npt.NDArray[np.bool_]:
    """Return a mask of the positions of an entry: bool of shape `box.shape`."""
    given = [key for key in ("at", "fill", "walls") if getattr(entry, key) is not None]
    if len(given) != 1:
        found = " and ".join(given) or "none of them"
        raise document.fault(path, f"give exactly one of 'at', 'fill' and 'walls'; found {found}")
    key = given[0]
    corners = (entry.at, entry.at) if entry.at is not None else (entry.fill or entry.walls)
    assert corners is not None  # one of the three is given
    for corner in corners:
        check_inside(document, (*path, key), corner, box)
    low = np.minimum(*corners) - box.low
    high = np.maximum(*corners) - box.low
    i, j, k = (slice(a, b + 1) for a, b in zip(low.tolist(), high.tolist(), strict=True))
    mask = np.zeros(box.shape, dtype=np.bool_)
    mask[i, j, k] = True
    if key == "walls":
        mask[low[0] + 1 : high[0], j, low[2] + 1 : high[2]] = False
    return mask
