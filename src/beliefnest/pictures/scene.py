"""Scene: the content of a picture of one simulator, independent of points and colours."""

import math
from collections import Counter
from collections.abc import Collection, Iterable, Mapping
from functools import cache

import msgspec
import numpy as np
import numpy.typing as npt
from msgspec.structs import replace

from beliefnest.belief.grounds import AgentBelief, Basis, ContainerBelief, Source
from beliefnest.belief.view import State
from beliefnest.pictures.palette import Mark
from beliefnest.pictures.relief import Relief, ReliefWindow, is_wide, read_relief
from beliefnest.world.paths import path_text
from beliefnest.world.registry import Registry, block_name
from beliefnest.world.signs import sign_words
from beliefnest.world.texts import on_one_line
from beliefnest.world.values import Items, Point, Position
from beliefnest.world.words import contents_words, told_apart

DEVICES = (
    *("door", "lever", "button", "furnace", "smoker", "crafting_table", "gate", "plate"),
    "_sign",
)
"""Parts of the names of blocks that agents use."""

Labels = Mapping[Position, str]
"""Names that people use for containers and places."""

_NEAR = 2
"""Distance in blocks, up or down, within which a thing belongs to a storey."""
_WIDEST = 40
"""Greatest width of a plan in blocks. Larger boxes are cut to the part around agents and things.
"""
_EDGE = 4
_STEP = 16
"""Step in blocks of the corners of plans of wide worlds, so that they differ little over time, and
the least distance of things from the edge."""
_FLAT = 3
"""Difference in height up to which the things of a wide world belong to one storey."""


class Wrong(msgspec.Struct, frozen=True):
    """One difference between two simulators.

    Attributes:
        where: Position of a block or container, or name of an agent.
        held: Value in this simulator, in words.
        instead: Value in the other one, in words.
        is_owned: True if it is about an agent's possessions, False if it is about its place.
    """

    where: Position | str
    held: str
    instead: str
    is_owned: bool = False


class PlanColumn(msgspec.Struct, frozen=True):
    """One column of the plan.

    Attributes:
        ground: Block state text below the storey's height; None if it is unknown.
        standing: Block state text at the storey's height; None if it is unknown.
        wrong: True if one of them differs from the simulator that this one is compared with.
    """

    ground: str | None
    standing: str | None
    wrong: bool


class Device(msgspec.Struct, frozen=True):
    """A block that agents use: a door, a lever, a button, a crafting table.

    Attributes:
        position: Position of the block.
        name: Name of the block.
        on: True if it is open, switched on or pressed.
        parts: Boxes of the block inside its column, each as left, top, right, bottom from 0 to
            1.
        says: Text on it, if it is a sign.
        false: Its state here and in the other simulator, if they differ; otherwise None.
        teller: Speaker, if the state is only known from hearsay; otherwise empty.
        age: Ticks since the state was current.
        source: Source of the state, if it is not perceived now; otherwise None.
    """

    position: Position
    name: str
    on: bool
    parts: tuple[tuple[float, float, float, float], ...]
    says: str = ""
    false: tuple[str, ...] | None = None
    teller: str = ""
    age: int = 0
    source: Source | None = None


class Store(msgspec.Struct, frozen=True):
    """A container.

    Attributes:
        position: Position of the block.
        name: Name of the block; None if it is unknown.
        label: Name that people use for it.
        items: Items that are known to be in it.
        complete: True if there are no other items in it.
        mark: Mark for the state of this knowledge.
        age: Ticks since the contents were last perceived.
        instead: Contents in the other simulator, if these are false; otherwise empty.
        above: Blocks above the storey; negative below it.
        teller: Speaker, if the contents are only known from hearsay; otherwise empty.
        source: Source of known contents that are not perceived now; otherwise None.
    """

    position: Position
    name: str | None
    label: str
    items: Items
    complete: bool
    mark: Mark
    age: int
    instead: str
    above: int
    teller: str = ""
    source: Source | None = None

    @property
    def unknown(self) -> bool:
        """Return True if nothing is known about the contents."""
        return not self.items and not self.complete

    @property
    def words(self) -> str:
        """Return the known contents in words."""
        return contents_words(self.items, complete=self.complete, ones=False)


class DrawnAgent(msgspec.Struct, frozen=True):
    """An agent in a scene.

    Attributes:
        name: Name of the agent.
        position: Position of its feet; None if it is unknown.
        yaw: Radians, 0 looks along -z, pi/2 along -x.
        mark: Current, stale, unknown or false.
        age: Ticks since it was perceived; 0 if it is perceived now.
        holds: Item in its main hand; empty if there is none or it is unknown.
        instead: Position in the other simulator, if this one is false; otherwise empty.
        above: Blocks above the storey; negative below it.
        believer: Owner of the belief that this position comes from, if it is another
            simulator's; otherwise empty.
        owned: False entry about its possessions; None if there is none.
        teller: Speaker, if the position is only known from hearsay; otherwise empty.
        source: Source of a known position that is not perceived now; otherwise None.
    """

    name: str
    position: Point | None
    yaw: float
    mark: Mark
    age: int
    holds: str
    instead: str
    above: int
    believer: str = ""
    owned: Wrong | None = None
    teller: str = ""
    source: Source | None = None


class AgentSight(msgspec.Struct, frozen=True):
    """Blocks that an agent sees in the simulator.

    Attributes:
        name: Name of the agent.
        seen: bool, shape of the plan.
    """

    name: str
    seen: npt.NDArray[np.bool_]


class Scene(msgspec.Struct, frozen=True):
    """One simulator at one tick, at one height.

    Attributes:
        path: Belief path.
        tick: The tick.
        agents: Names of all agents of the run, for their looks.
        low: x and z of the first column.
        height: The storey: y of the blocks that stand on its floor.
        cells: Columns along x, then along z.
        stores: Containers, in order of position.
        devices: Blocks that agents use.
        items: Dropped items: name and position.
        places: Names and positions of places.
        people: Agents in order of their names.
        sights: Sights of chosen agents.
        wrong: Number of false entries.
        against: Path of the simulator that this one is compared with.
        note: Further words for the title, such as the branch.
        heat: Probability of columns by x and z, drawn as a tint.
        heat_words: Question that these probabilities answer, for the legend.
        relief: Ground of a wide world, in place of `cells`, which are then empty.
    """

    path: str
    tick: int
    agents: tuple[str, ...]
    low: tuple[int, int]
    height: int
    cells: tuple[tuple[PlanColumn, ...], ...]
    stores: tuple[Store, ...]
    devices: tuple[Device, ...]
    items: tuple[tuple[str, Point], ...]
    places: tuple[tuple[str, Position], ...]
    people: tuple[DrawnAgent, ...]
    sights: tuple[AgentSight, ...]
    wrong: int
    against: str
    note: str = ""
    heat: Mapping[tuple[int, int], float] = msgspec.field(default_factory=dict)
    heat_words: str = ""
    relief: Relief | None = None

    @property
    def size(self) -> tuple[int, int]:
        """Number of columns along x and along z."""
        if self.relief is not None:
            width, depth = self.relief.blocks.shape
            return width, depth
        return len(self.cells), len(self.cells[0])


def best_height(states: Iterable[State]) -> int:
    """Return the y with the most containers, or else with the feet of the most agents.

    In a wide world with things at many heights it is the highest y: its plan hides nothing.
    """
    all_states = list(states)
    heights = [place[1] for state in all_states for place in state.containers] or [
        math.floor(agent.position[1] + 1e-6)
        for state in all_states
        for agent in state.agents.values()
        if agent.position is not None
    ]
    if not heights:
        return all_states[0].box.low[1] + 1
    if is_wide(all_states[0].box) and max(heights) - min(heights) > _FLAT:
        return all_states[0].box.high[1]
    counts = Counter(heights)
    return min(counts, key=lambda height: (-counts[height], height))


def read_scene(
    state: State,
    *,
    wrong: Collection[Wrong] = (),
    against: str = "/",
    labels: Labels | None = None,
    places: Mapping[str, Position] | None = None,
    sight: Mapping[str, npt.NDArray[np.bool_]] | None = None,
    height: int | None = None,
    note: str = "",
) -> Scene:
    """Return the scene of a simulator.

    Args:
        state: State of the simulator.
        wrong: Its differences from the simulator `against`.
        against: Path of the simulator to compare with.
        labels: Names that people use for containers.
        places: Names that people use for other places.
        sight: Blocks that chosen agents see, by name of the agent; shape of the box.
        height: The storey, y of the blocks that stand on its floor; None for the best one.
        note: Further words for the title.
    """
    level = best_height([state]) if height is None else height
    level = min(max(level, state.box.low[1]), state.box.high[1])
    window = _window(state, places or {})
    by_place = {each.where: each for each in wrong if not each.is_owned}
    owned = {each.where: each for each in wrong if each.is_owned}
    ground = _ground(state, window, level, by_place, sight or {})
    people = (
        replace(_person(name, agent, state.tick, level, by_place), owned=owned.get(name))
        for name, agent in sorted(state.agents.items())
    )
    stores = read_stores(state, level, labels or {}, by_place)
    if ground.relief is not None:
        # The ground shows what is below the height, too.
        people = (replace(each, above=max(0, each.above)) for each in people)
        stores = tuple(replace(each, above=max(0, each.above)) for each in stores)
    return Scene(
        path=path_text(state.path),
        tick=state.tick,
        agents=tuple(sorted(state.agents)),
        low=window[0],
        height=level,
        cells=ground.cells,
        stores=stores,
        devices=_devices(ground.standing, state, by_place),
        items=tuple((item.name, item.position) for _, item in sorted(state.items.items())),
        places=tuple((on_one_line(name), at) for name, at in sorted((places or {}).items())),
        people=tuple(people),
        sights=tuple(AgentSight(name, seen) for name, seen in ground.sights.items()),
        wrong=len(wrong),
        against=against,
        note=", ".join(filter(None, (note, _cut(state, window)))),
        relief=ground.relief,
    )


class _Ground(msgspec.Struct, frozen=True):
    """Blocks of a plan.

    Attributes:
        cells: Columns of one storey; empty in a wide world.
        sights: Columns that agents see, by name of the agent.
        standing: Blocks that may be devices, by position.
        relief: Ground of a wide world.
    """

    cells: tuple[tuple[PlanColumn, ...], ...]
    sights: Mapping[str, npt.NDArray[np.bool_]]
    standing: Mapping[Position, str | None]
    relief: Relief | None = None


def _ground(
    state: State,
    window: ReliefWindow,
    level: int,
    wrong: Mapping[Position | str, Wrong],
    sights: Mapping[str, npt.NDArray[np.bool_]],
) -> _Ground:
    (x0, z0), (x1, z1) = window
    if is_wide(state.box):
        relief, seen = read_relief(state, window, level, sights)
        false = [each for each in wrong if isinstance(each, tuple) and each[1] <= level]
        blocks = [place for place in false if place not in state.containers]
        spots = {(x - x0, z - z0) for x, _, z in blocks if x0 <= x <= x1 and z0 <= z <= z1}
        # All devices of a wide world would cover its plan. These are worth it.
        standing = {place: state.blocks[place] for place in (*state.signs, *blocks)}
        return _Ground((), seen, standing, replace(relief, wrong=tuple(sorted(spots))))
    cut = (
        slice(x0 - state.box.low[0], x1 - state.box.low[0] + 1),
        level - state.box.low[1],
        slice(z0 - state.box.low[2], z1 - state.box.low[2] + 1),
    )
    cells = tuple(
        tuple(_cell(state, (x, level, z), wrong) for z in range(z0, z1 + 1))
        for x in range(x0, x1 + 1)
    )
    standing = {
        (x0 + i, level, z0 + k): cell.standing
        for i, row in enumerate(cells)
        for k, cell in enumerate(row)
    }
    return _Ground(cells, {name: seen[cut] for name, seen in sights.items()}, standing)


def _window(state: State, places: Mapping[str, Position]) -> ReliefWindow:
    """Return the corners of the plan: the box, or the part of it around things and agents."""
    (x0, _, z0), (x1, _, z1) = state.box.low, state.box.high
    if max(x1 - x0, z1 - z0) < _WIDEST:
        return (x0, z0), (x1, z1)
    spots = [
        *((place[0], place[2]) for place in state.containers),
        *((place[0], place[2]) for place in places.values()),
        *(
            (math.floor(agent.position[0]), math.floor(agent.position[2]))
            for agent in state.agents.values()
            if agent.position is not None
        ),
    ] or [(x0, z0)]
    xs, zs = zip(*spots, strict=True)
    edge = _STEP if is_wide(state.box) else _EDGE
    low, high = [min(xs) - edge, min(zs) - edge], [max(xs) + edge, max(zs) + edge]
    if is_wide(state.box):
        low = [
            first + (at - first) // _STEP * _STEP for at, first in zip(low, (x0, z0), strict=True)
        ]
        high = [
            first + -(-(at + 1 - first) // _STEP) * _STEP - 1
            for at, first in zip(high, (x0, z0), strict=True)
        ]
    return ((max(x0, low[0]), max(z0, low[1])), (min(x1, high[0]), min(z1, high[1])))


def _cut(state: State, window: ReliefWindow) -> str:
    """Return which part of the box is shown, in words; empty if all of it is."""
    shown = zip("xz", *window, state.box.low[::2], state.box.high[::2], strict=True)
    parts = (
        f"{x} {a} to {b} of {low} to {high}"
        for x, a, b, low, high in shown
        if (a, b) != (low, high)
    )
    return ", ".join(parts)


def _cell(state: State, at: Position, wrong: Mapping[Position | str, Wrong]) -> PlanColumn:
    x, y, z = at
    below = (x, y - 1, z)
    ground = state.blocks[below] if y > state.box.low[1] else None
    container = at in state.containers
    return PlanColumn(ground, state.blocks[at], not container and (at in wrong or below in wrong))


def read_stores(
    state: State, level: int, labels: Labels, wrong: Mapping[Position | str, Wrong]
) -> tuple[Store, ...]:
    """Return the containers of a state.

    Args:
        state: State of a simulator.
        level: The storey.
        labels: Names that people use for containers.
        wrong: Differences from the other simulator, by position.
    """
    stores = []
    for place, content in sorted(state.containers.items()):
        text = state.blocks[place]
        false = wrong.get(place)
        stores.append(
            Store(
                position=place,
                name=None if text is None else block_name(text),
                label=on_one_line(labels.get(place, f"({', '.join(map(str, place))})")),
                items=content.items,
                complete=content.complete,
                mark=_store_mark(content, false=false is not None),
                age=0 if content.current else state.tick - content.basis.observed_at,
                instead="" if false is None else false.instead,
                above=place[1] - level,
                teller=_teller(content.basis) if content.items or content.complete else "",
                source=_source(content),
            )
        )
    return tuple(stores)


def _source(store: ContainerBelief) -> Source | None:
    """Return the source of known contents that are not perceived now; None: there is none."""
    return store.basis.source if not store.current and (store.items or store.complete) else None


def _teller(basis: Basis | None) -> str:
    """Return the speaker that an entry is known from; empty if it is not hearsay."""
    if basis is None or basis.source is not Source.HEARD:
        return ""
    return basis.speaker or "a sign"


def _store_mark(content: ContainerBelief, *, false: bool) -> Mark:
    if false:
        return Mark.FALSE
    if content.complete:
        return Mark.CURRENT if content.current else Mark.STALE
    return Mark.INCOMPLETE if content.items else Mark.UNKNOWN


def _person(
    name: str, agent: AgentBelief, tick: int, level: int, wrong: Mapping[Position | str, Wrong]
) -> DrawnAgent:
    false = wrong.get(name)
    mark = Mark.CURRENT if agent.current else Mark.STALE
    age = 0
    if agent.position is None:
        mark = Mark.UNKNOWN
    elif not agent.current and agent.basis is not None:
        age = tick - agent.basis.observed_at
    if false is not None and agent.position is not None:
        mark = Mark.FALSE
    above = 0 if agent.position is None else math.floor(agent.position[1] + 1e-6) - level
    return DrawnAgent(
        name=name,
        position=agent.position,
        yaw=agent.yaw,
        mark=mark,
        age=age,
        holds=(agent.equipment or {}).get("main_hand", "").replace("_", " "),
        instead="" if false is None else false.instead,
        above=above if abs(above) >= _NEAR else 0,
        teller="" if agent.current or agent.position is None else _teller(agent.basis),
        source=None if agent.current or agent.basis is None else agent.basis.source,
    )


_ON = ("open", "powered", "lit")


def _devices(
    standing: Mapping[Position, str | None], belief: State, wrong: Mapping[Position | str, Wrong]
) -> tuple[Device, ...]:
    registry = Registry.load()
    devices = []
    for place, text in standing.items():
        if text is None or not _is_device(text):
            continue
        state = registry.state_id(text)
        properties = registry.properties(state)
        name = registry.name(state)
        # The first property of _ON decides: a door also has `powered`, but may be shut then.
        states = [properties[key] == "true" for key in _ON if key in properties]
        parts = tuple((b[0], b[2], b[3], b[5]) for b in registry.boxes(state))
        says = sign_words(belief.signs.get(place, ""))
        false = wrong.get(place)
        basis = None if belief.blocks.current(place) else belief.blocks.basis(place)
        devices.append(
            Device(
                place,
                name,
                bool(states and states[0]),
                parts,
                says,
                None if false is None else told_apart((false.held, false.instead)),
                _teller(basis),
                0 if basis is None else belief.tick - basis.observed_at,
                None if basis is None else basis.source,
            )
        )
    return tuple(devices)


@cache
def _is_device(text: str) -> bool:
    return any(kind in text for kind in DEVICES)
