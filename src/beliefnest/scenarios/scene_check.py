"""Warnings about what a scenario's file says, before anything is played."""

import math
from collections.abc import Iterator, Mapping
from itertools import combinations

import numpy as np
import numpy.typing as npt

from beliefnest.scenarios.content import Probe, ScenarioWarning
from beliefnest.scenarios.document import Document, KeyPath
from beliefnest.scenarios.format import ScenarioFile
from beliefnest.scenarios.space import parts_of
from beliefnest.skills.javascript import nodes_below, parsed
from beliefnest.world.frames import Snapshot
from beliefnest.world.registry import Registry
from beliefnest.world.texts import quoted
from beliefnest.world.values import Box, Position
from beliefnest.world.words import listed

_CATCHES = 4.0
"""Blocks from the receiver within which somebody else may catch what is thrown."""

_GIVING = "giveItemToOther"


def scene_warnings(
    document: Document, file: ScenarioFile, snapshot: Snapshot, probes: tuple[Probe, ...]
) -> tuple[ScenarioWarning, ...]:
    """Return warnings about names, walls, gifts and options of a scenario.

    Args:
        document: The document, with parameters, condition and map resolved.
        file: Its content as typed values.
        snapshot: Its world before the script.
        probes: Its probes.
    """
    faults = [
        *_names(file),
        *_walls(document, file, snapshot),
        *_gifts(file, snapshot),
        *_options(file),
        *_copies(file, snapshot, probes),
    ]
    return tuple(
        ScenarioWarning(f"{document.key_at(path)}{text}", f"{kind} {document.where(path)}")
        for kind, path, text in faults
    )


_Found = Iterator[tuple[str, KeyPath, str]]


def _names(file: ScenarioFile) -> _Found:
    """Yield names that differ from an earlier one only in case."""
    named: list[tuple[KeyPath, str]] = [(("agents", name), name) for name in file.agents]
    named += [
        (("containers", number, "label"), entry.label)
        for number, entry in enumerate(file.containers)
        if entry.label
    ]
    named += [(("places", name), name) for name in file.places]
    first: dict[str, str] = {}
    for path, name in named:
        other = first.setdefault(name.casefold(), name)
        if other != name:
            yield (
                "names",
                path,
                f"{quoted(name)} differs from {quoted(other)} only in case; rename one of them",
            )


def _walls(document: Document, file: ScenarioFile, snapshot: Snapshot) -> _Found:
    """Yield a wall inside of the scene if all such walls are one block high."""
    box, terrain, registry = snapshot.box, snapshot.blocks, Registry.load()
    if not terrain.is_dense or len(snapshot.agents) < 2:  # Landscapes have hills, not walls.
        return
    clear = frozenset(file.perception.transparent_blocks)
    grid = terrain.chunks[terrain.rows[0]]
    states, numbers = np.unique(grid, return_inverse=True)
    hiding = [
        registry.is_full(state)
        and not registry.default_transparent[state]
        and not registry.is_container(registry.name(state))
        and registry.name(state) not in clear
        for state in states.tolist()
    ]
    hides = np.array(hiding)[numbers.reshape(grid.shape)]
    for level in sorted({int(agent.position[1]) for agent in snapshot.agents.values()}):
        y = level - box.low[1]
        if not 0 <= y < box.shape[1]:
            continue
        low = hides[:, y]
        inner = _inner(low)
        above = hides[:, y + 1] if y + 1 < box.shape[1] else np.zeros_like(low)
        if inner.any() and not above[inner].any():
            x, z = (int(each[0]) for each in np.nonzero(inner))
            at = (x + box.low[0], level, z + box.low[2])
            yield (
                "walls",
                _block_path(document, file, at, box),
                f"the wall at {list(at)} is one block high, and so are all walls between rooms: "
                "agents see each other over them; make them 2 or more blocks high (`height: 3`)",
            )


def _inner(walls: npt.NDArray[np.bool_]) -> npt.NDArray[np.bool_]:
    """Return the cells of walls that stand between free cells, shape as the given one."""
    inner = np.zeros_like(walls)
    middle = walls[1:-1, 1:-1]
    beside_x, beside_z = (walls[:-2, 1:-1], walls[2:, 1:-1]), (walls[1:-1, :-2], walls[1:-1, 2:])
    for along, across in ((beside_x, beside_z), (beside_z, beside_x)):
        inner[1:-1, 1:-1] |= middle & along[0] & along[1] & ~across[0] & ~across[1]
    return inner


def _block_path(document: Document, file: ScenarioFile, at: Position, box: Box) -> KeyPath:
    """Return the path of the last entry that puts a block at a position."""
    for number, entry in reversed([*enumerate(file.blocks)]):
        path: KeyPath = ("blocks", number)
        if any(at in part for part in parts_of(document, path, entry, box)):
            return path
    return ("blocks",)


def _gifts(file: ScenarioFile, snapshot: Snapshot) -> _Found:
    """Yield gifts to agents near whom others stand at first, or since an earlier gift."""
    near = {
        frozenset(pair)
        for pair in combinations(snapshot.agents, 2)
        if math.dist(*(snapshot.agents[name].position for name in pair)) <= _CATCHES
    }
    met: set[frozenset[str]] = set()
    for number, step in enumerate(file.script):
        programs: Mapping[str, str] = dict(step.programs)
        if step.agent is not None and step.program is not None:
            programs = {**programs, step.agent: step.program}
        for giver, program in programs.items():
            for receiver in _receivers(program):
                others = [
                    name
                    for name in snapshot.agents
                    if name not in (giver, receiver)
                    and (
                        frozenset((name, receiver)) in near | met or frozenset((name, giver)) in met
                    )
                ]
                met.add(frozenset((giver, receiver)))
                if others:
                    verb = "stands" if len(others) == 1 else "stand"
                    yield (
                        "gifts",
                        ("script", number),
                        f"{giver} throws a gift to {receiver}, and {listed(others)} {verb} so near "
                        "that they may catch it; let others go away first, or use a container",
                    )


def _receivers(program: str) -> Iterator[str]:
    """Yield the agent of each gift of a program, of those gifts whose agent it names as a text."""
    for node in nodes_below(parsed(program.encode())) if _GIVING in program else ():
        if node.type == "arguments" and node.parent.children[0].text == _GIVING.encode():
            texts = [each for each in node.named_children if each.type != "comment"][1:2]
            strings = ("string", "template_string")
            yield from (each.text.decode()[1:-1] for each in texts if each.type in strings)


def _options(file: ScenarioFile) -> _Found:
    """Yield options that differ by no word from another one."""
    for number, probe in enumerate(file.probes):
        answers = [] if probe.expect is None else probe.expect.answers
        for place, asked in enumerate(answers if isinstance(answers, list) else [answers]):
            options = () if asked is None else asked.options
            bare = sorted((each.casefold().split() for each in options), key=len)
            for one, other in combinations(bare, 2):
                if any(other[at : at + len(one)] == one for at in range(len(other))):
                    yield (
                        "options",
                        ("probes", number, "expect", "answers", place, "options"),
                        f"{quoted(' '.join(one))} is contained in {quoted(' '.join(other))}, so "
                        "that an answer may name both; give options without a common name",
                    )


def _copies(file: ScenarioFile, snapshot: Snapshot, probes: tuple[Probe, ...]) -> _Found:
    """Yield questions where an item is of which there are several, in several places."""
    for number, probe in enumerate(probes):
        asked = {
            str(question.believed.thing)
            for question in probe.questions
            if question.believed is not None and question.believed.kind == "item"
        }
        for item in sorted(asked):
            holders = [name for name, each in snapshot.agents.items() if each.inventory.get(item)]
            holders += [str(list(at)) for at, has in snapshot.containers.items() if has.get(item)]
            if len(holders) > 1:
                yield (
                    "copies",
                    ("probes", number),
                    f"asks where the {item} is, and there are several: {listed(holders)} have one; "
                    "ask for an item of which there is one",
                )
