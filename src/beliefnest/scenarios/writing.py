"""Scenario files of places and tasks, written so that people can read and change them."""

from collections.abc import Iterator, Mapping, Sequence
from io import StringIO
from typing import Any

import numpy as np
from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedMap, CommentedSeq
from ruamel.yaml.scalarstring import LiteralScalarString

from beliefnest.errors import InputError, ScenarioError
from beliefnest.scenarios.document import MAX_VALUES
from beliefnest.scenarios.loading import scenario_in
from beliefnest.scenarios.terrain_entry import entry_of
from beliefnest.scenarios.yaml_reading import LONGEST, parse_yaml
from beliefnest.world.cuboids import cuboids, distinct_cells
from beliefnest.world.frames import Snapshot
from beliefnest.world.registry import Registry
from beliefnest.world.signs import is_sign
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import EQUIPMENT_SLOTS, AgentState, Box, Position

_VISITOR = "visitor"
_WIDTH = 100
_UNBROKEN = 10_000
"""Width at which entries stay on their lines."""
_MOST_CELLS = 8_000_000
"""Most different cells that are divided into cuboids; more are not divided."""
_FULL = 20.0


def scenario_text(name: str, description: str, place: Snapshot) -> str:
    """Return the text of a scenario file for a place.

    A place without agents gets an agent `visitor` without items. Blocks are cuboids in the list
    `blocks`, or compressed in `terrain` if they are more than a file may list.

    Args:
        name: Short name of the scenario.
        description: Description of the scenario.
        place: Snapshot of the place, with all blocks known.

    Raises:
        InputError: An agent cannot stand there, or a scenario cannot express the place.
    """
    registry = Registry.load()
    agents = place.agents or {_VISITOR: AgentState(_standing(place, registry))}
    blocks = _blocks(place, registry)
    content = {
        "name": name,
        "description": description,
        "box": [in_flow(place.box.low), in_flow(place.box.high)],
        "terrain": _terrain(place, registry) if blocks is None else None,
        "blocks": blocks,
        "containers": list(_containers(place, registry)),
        "signs": list(_signs(place, registry)),
        "agents": {agent: _agent(state) for agent, state in agents.items()},
    }
    if _values(_filled(content)) > MAX_VALUES:
        content |= {"terrain": _terrain(place, registry), "blocks": []}
    text = _yaml(_filled(content))
    if len(text) > LONGEST:
        raise InputError(
            f"the place needs {len(text):,} bytes as a scenario; at most {LONGEST:,} are possible: "
            "capture a smaller place"
        )
    _check(text, place)
    return text


def content_text(content: Mapping[str, Any], heading: str) -> str:
    """Return the text of a scenario file with a content.

    Each entry of a list or mapping at the top stands on a line of its own.

    Args:
        content: Content of the file, as dicts, lists and scalars.
        heading: First line, a comment.
    """
    laid_out = {key: _by_line(value) for key, value in content.items()}
    return f"# {heading}\n{_yaml(laid_out, _UNBROKEN)}"


def _by_line(value: Any) -> Any:
    """Return a value whose entries stand on lines of their own; positions stay on one line."""
    if isinstance(value, Mapping) and value:
        return CommentedMap((key, in_flow(part)) for key, part in value.items())
    if isinstance(value, list | tuple) and any(isinstance(each, Mapping) for each in value):
        return CommentedSeq(in_flow(part) for part in value)
    return in_flow(value)


def _blocks(place: Snapshot, registry: Registry) -> list[CommentedMap] | None:
    """Return entries of all blocks but containers and signs; None: they are too many for a file."""
    draft = place.blocks.draft()
    for position in [*place.containers, *_sign_places(place, registry)]:
        draft[place.box.index(position)] = registry.air
    blocks = draft.terrain()
    if distinct_cells(blocks) > _MOST_CELLS:
        return None
    entries, values = [], 0
    for state, part in cuboids(blocks, registry.air):
        low, high = (_at(place.box, corner) for corner in (part.low, part.high))
        where: dict[str, Any] = {"at": low} if low == high else {"fill": in_flow([low, high])}
        entries.append(in_flow({"block": registry.text(state), **where}))
        values += _values(entries[-1])
        if values > MAX_VALUES:
            return None
    return entries


def _terrain(place: Snapshot, registry: Registry) -> CommentedMap:
    entry = entry_of(place.blocks, registry)
    cells = LiteralScalarString(entry["cells"])
    return CommentedMap({**entry, "states": in_flow(entry["states"]), "cells": cells})


def _filled(content: Mapping[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in content.items() if value}


def _values(content: Any) -> int:
    """Return the number of values and keys that a reader of a content counts."""
    if isinstance(content, Mapping):
        return 1 + sum(1 + _values(value) for value in content.values())
    if isinstance(content, list | tuple):
        return 1 + sum(map(_values, content))
    return 1


def _containers(place: Snapshot, registry: Registry) -> Iterator[CommentedMap]:
    for position, items in sorted(place.containers.items()):
        block = registry.text(place.blocks[place.box.index(position)])
        yield in_flow({"at": position, "block": block, **({"items": dict(items)} if items else {})})


def _signs(place: Snapshot, registry: Registry) -> Iterator[CommentedMap]:
    for position in _sign_places(place, registry):
        block = registry.text(place.blocks[place.box.index(position)])
        text = place.signs.get(position, "")
        yield in_flow({"at": position, "block": block, **({"text": text} if text else {})})


def _sign_places(place: Snapshot, registry: Registry) -> list[Position]:
    states = [s for s in place.blocks.states if is_sign(registry.name(s))]
    return place.places(states)


def _agent(state: AgentState) -> Any:
    worn = {slot: state.equipment[slot] for slot in EQUIPMENT_SLOTS if slot in state.equipment}
    said: dict[str, Any] = {"position": state.position, "yaw": state.yaw, "pitch": state.pitch}
    said |= {"inventory": dict(state.inventory)} if state.inventory else {}
    said |= {"equipment": worn} if worn else {}
    said |= {"health": state.health} if state.health != _FULL else {}
    said |= {"food": state.food} if state.food != _FULL else {}
    return in_flow(said)


def _standing(place: Snapshot, registry: Registry) -> tuple[float, float, float]:
    """Return the lowest place to stand; of several, the nearest to the middle."""
    states = place.blocks.states
    empty = [s for s in states if not registry.boxes(s)]
    floor = [s for s in states if registry.is_full(s)]
    if above := _above_floor(place.blocks, floor, empty):
        x, y, z = _at(place.box, above)
        return (x + 0.5, y + 1.0, z + 0.5)
    raise InputError(
        "there is no agent in the box, and no place for one; choose a box that contains a floor "
        "with two free blocks above it"
    )


def _above_floor(
    blocks: Terrain, floor: Sequence[int], empty: Sequence[int]
) -> tuple[int, int, int] | None:
    """Return the index of the block of the lowest floor that is nearest to the middle.

    Args:
        blocks: The blocks.
        floor: States on which agents stand.
        empty: States of the two blocks above.
    """
    width, height, depth = blocks.shape
    # Above a floor the layer is another one.
    for layer in (blocks.borders[1] - 1).tolist():
        if not 0 <= layer < height - 2:
            continue
        stack = blocks.cut((0, layer, 0), (width, layer + 3, depth))
        free = np.isin(stack[:, 0], floor) & np.isin(stack[:, 1:], empty).all(axis=1)
        cells = np.argwhere(free)
        if len(cells):
            far = ((cells - np.array([width / 2, depth / 2])) ** 2).sum(axis=1)
            i, k = cells[far.argmin()].tolist()
            return (i, layer, k)
    return None


def _at(box: Box, index: Any) -> Position:
    x, y, z = (int(i) + low for i, low in zip(index, box.low, strict=True))
    return (x, y, z)


def in_flow(value: Any) -> Any:
    """Return the value as YAML on one line."""
    made: Any
    if isinstance(value, Mapping):
        made = CommentedMap((key, in_flow(part)) for key, part in value.items())
    elif isinstance(value, list | tuple):
        made = CommentedSeq(in_flow(part) for part in value)
    else:
        return value
    made.fa.set_flow_style()
    return made


def _yaml(content: Mapping[str, Any], width: int = _WIDTH) -> str:
    yaml = YAML()
    yaml.width = width
    yaml.indent(mapping=2, sequence=4, offset=2)
    out = StringIO()
    yaml.dump(dict(content), out)
    return out.getvalue()


def _check(text: str, place: Snapshot) -> None:
    """Load the text as a scenario, and check that it describes the same place."""
    try:
        read = scenario_in(parse_yaml(text, "what was captured"), None).setting.snapshot
    except ScenarioError as error:
        raise InputError(f"a scenario cannot express the place: {error}") from error
    same = read.blocks == place.blocks and read.containers == place.containers
    if not same or read.signs != place.signs:
        raise AssertionError("a scenario says something else than what was captured")
