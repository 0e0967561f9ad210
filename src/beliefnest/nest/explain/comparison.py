"""Differences between two simulators, and false beliefs."""

import itertools
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np
import numpy.typing as npt

from beliefnest.belief.context import BeliefContext
from beliefnest.belief.grounds import AgentBelief, ContainerBelief, Source
from beliefnest.belief.node_view import NodeView
from beliefnest.nest.explain.parts import Contents
from beliefnest.nest.past.recording import Recording
from beliefnest.nest.past.shown_words import html_lines, html_table, where_words
from beliefnest.world.paths import BeliefPath, path_text
from beliefnest.world.terrain import Counts
from beliefnest.world.values import Point, Position
from beliefnest.world.words import contents_words, point_words

_MOST = 12
"""Number of differences that a terminal shows; the others are only counted."""

_APART = 0.5
"""Smallest distance in blocks at which a believed position counts as false."""


class BelievedThings(Protocol):
    """Beliefs about containers and agents."""

    @property
    def containers(self) -> Mapping[Position, ContainerBelief]:
        """The known containers by position."""

    @property
    def agents(self) -> Mapping[str, AgentBelief]:
        """All agents by name."""


@dataclass(frozen=True, slots=True)
class Pose:
    """Position of an agent, and the direction of its look.

    Attributes:
        position: Middle of the feet, blocks.
        yaw: Radians, Mineflayer's convention; None: unknown.
        pitch: Radians, positive upwards; None: unknown.
    """

    position: Point
    yaw: float | None
    pitch: float | None


@dataclass(frozen=True, slots=True)
class Difference:
    """Element with different values in two simulators `a` and `b`.

    Attributes:
        kind: Kind of the element.
        where: Position of a block or container, or name of the agent with the pose or inventory.
        a: Block state text, `Pose` or `Contents` in `a`; None: unknown, or there is none.
        b: The same in `b`.
    """

    kind: Literal["block", "container", "agent", "inventory"]
    where: Position | str
    a: str | Pose | Contents | None
    b: str | Pose | Contents | None


class Differences(list[Difference]):
    """List of differences that a terminal and a notebook show as a table.

    Args:
        found: The differences.
        a: Heading of the column of `a`.
        b: Heading of the column of `b`.
    """

    def __init__(self, differences: Iterable[Difference], a: str, b: str) -> None:
        super().__init__(differences)
        self._headings = ("what", a, b)

    def __repr__(self) -> str:
        _, a, b = self._headings
        lines = [
            f"  {what}: {one} in {a}, {other} in {b}" for what, one, other in self._rows()[:_MOST]
        ]
        more = len(self) - len(lines)
        lines += [f"  and {more} more"] if more else []
        count = f"{len(self)} {self._about()}"
        return "\n".join([f"<{count}{':' if lines else ''}", *lines]) + ">"

    def _repr_html_(self) -> str:
        if not self:
            return html_lines([f"No {self._about()}."])
        return html_table(self._headings, self._rows())

    def _about(self) -> str:
        _, a, b = self._headings
        return f"difference{'s' * (len(self) != 1)} of {a} and {b}"

    def _rows(self) -> list[tuple[str, str, str]]:
        return [(_what(each), value_words(each.a), value_words(each.b)) for each in self]


def value_words(value: str | Pose | Contents | None) -> str:
    """Return one value of a difference in words."""
    match value:
        case Pose(position=position):
            return where_words(position)
        case Contents(items=items, complete=complete):
            return contents_words(items, complete=complete)
        case None:
            return "not known"
        case text:
            return text


def _what(difference: Difference) -> str:
    where = difference.where
    return f"{difference.kind} {where if isinstance(where, str) else point_words(where)}"


def compare(
    recording: Recording, a: BeliefPath, b: BeliefPath, tick: int | None, *, unknown: bool
) -> list[Difference]:
    """Return the differences between two nodes at a tick (None: now); see `ShownNest.compare`.

    Blocks come first, then containers, agents and inventories, each in order.
    """
    one, other = recording.state(a, tick), recording.state(b, tick)
    known_blocks: Counts | None = None if unknown else lambda a, b: (a >= 0) & (b >= 0)
    blocks = _blocks_in(known_blocks, one, other, recording.context)
    things = _different_things(one, other)
    both = (each for each in things if each.a is not None and each.b is not None)
    differences = itertools.chain(blocks, things if unknown else both)
    return Differences(differences, path_text(a), path_text(b))


def false_beliefs(
    recording: Recording,
    path: BeliefPath,
    tick: int | None,
    against: BeliefPath = (),
    against_tick: int | None = None,
) -> list[Difference]:
    """Return the beliefs of a node that another node contradicts. Unknown values are never false.

    Contents are compared by `are_false`, positions of agents by `are_elsewhere`.

    Args:
        recording: Recording of the nest.
        path: Path of the node.
        tick: Tick of the node; None: now.
        against: Path of the node that is taken for true.
        against_tick: Tick of that node; None: `tick`.
    """
    belief = recording.state(path, tick)
    real = recording.state(against, tick if against_tick is None else against_tick)
    blocks = _blocks_in(lambda _, believed: believed >= 0, real, belief, recording.context)
    differences = itertools.chain(blocks, false_things(real, belief))
    return Differences(differences, path_text(against), path_text(path))


def false_things(real: BelievedThings, belief: BelievedThings) -> Iterator[Difference]:
    """Yield the false beliefs about contents, positions and inventories; see `false_beliefs`."""
    return (difference for difference in _different_things(real, belief) if _is_false(difference))


def _is_false(thing: Difference) -> bool:
    match thing.b:
        case Contents() as believed:
            return are_false(thing.a if isinstance(thing.a, Contents) else None, believed)
        case Pose(position=believed):
            true = thing.a.position if isinstance(thing.a, Pose) else None
            return true is None or bool(are_elsewhere(np.array(true), np.array(believed)))
    return False


def are_elsewhere(
    real: npt.NDArray[np.float64], believed: npt.NDArray[np.float64]
) -> npt.NDArray[np.bool_]:
    """Return for each agent True if its believed position is at least half a block off.

    A smaller distance does not count as a change of place. Angles are not compared: agents turn all
    the time, and a remembered position makes no statement about them.

    Args:
        real: Feet positions, shape (..., 3).
        believed: Believed feet positions, same shape.

    Returns:
        bool, shape (...).
    """
    apart: npt.NDArray[np.bool_] = np.linalg.norm(real - believed, axis=-1) >= _APART
    return apart


def are_false(real: Contents | None, belief: Contents) -> bool:
    """Return True if believed contents are false.

    They are if they have an item that is missing in reality, or if they count as complete and lack
    an item.

    Args:
        real: Real contents; None: there is no container.
        belief: Believed contents.
    """
    true, claimed = {} if real is None else real.items, belief.items
    too_much = any(count > true.get(name, 0) for name, count in claimed.items())
    return too_much or (belief.complete and dict(claimed) != dict(true))


def _blocks_in(
    counts: Counts | None, a: NodeView, b: NodeView, context: BeliefContext
) -> Iterator[Difference]:
    """Yield the blocks that differ between two nodes; `counts` is that of `Terrain.differing`."""
    x, y, z = context.box.low
    for i, j, k in a.numbers.differing(b.numbers, counts).tolist():
        texts = (context.block_text(view.numbers[i, j, k]) for view in (a, b))
        yield Difference("block", (x + i, y + j, z + k), *texts)


def _different_things(a: BelievedThings, b: BelievedThings) -> Iterator[Difference]:
    for place in sorted(a.containers.keys() | b.containers.keys()):
        contents = (reading.containers.get(place) for reading in (a, b))
        both = [None if c is None else Contents(dict(c.items), c.complete) for c in contents]
        if both[0] != both[1]:
            yield Difference("container", place, both[0], both[1])
    for name in a.agents:
        poses = _pose(a.agents[name]), _pose(b.agents[name])
        if _differ(*poses):
            yield Difference("agent", name, *poses)
    for name in a.agents:
        owned = [_owned(reading.agents[name]) for reading in (a, b)]
        if owned[0] != owned[1]:
            yield Difference("inventory", name, owned[0], owned[1])


def _pose(agent: AgentBelief) -> Pose | None:
    if agent.position is None:
        return None
    # A prior gives a position only: its angles of 0 are no belief.
    if agent.basis is not None and agent.basis.source is Source.PRIOR:
        return Pose(agent.position, None, None)
    return Pose(agent.position, agent.yaw, agent.pitch)


def _differ(a: Pose | None, b: Pose | None) -> bool:
    """Return True if two poses differ. Unknown angles count as equal to any angles."""
    if a is None or b is None:
        return a is not b
    if a.yaw is None or b.yaw is None:
        return a.position != b.position
    return a != b


def _owned(agent: AgentBelief) -> Contents:
    return Contents(dict(agent.inventory), agent.inventory_complete)
