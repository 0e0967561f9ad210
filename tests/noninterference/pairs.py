"""Pairs of worlds that differ only behind a full wall, and so are the same to Ann.

Ann and Bob are in the western room. Carl and Dora are in the eastern room, out of sight and out
of hearing. The two worlds of a pair have the same western room, and the same happens in it at the
same ticks. The eastern rooms differ: containers and what is in them, levers, doors, signs, labels,
agents who walk, speak, think, deposit, mine and build. In some pairs the eastern rooms are the same
again before the wall is opened and Ann looks in.
"""

import functools
import random
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field, replace
from typing import Any

import beliefnest as bn
from beliefnest.nest.past.setting import Setting
from beliefnest.prompts import Renderer
from beliefnest.world.nameable import Nameable
from beliefnest.world.values import Items, Point, Position

__all__ = ["AGENTS", "BOX", "PATHS", "Pair", "Played", "Side", "pair_of", "played"]

BOX = ((0, 0, 0), (13, 3, 6))
WALL_X = 6
AGENTS = ("ann", "bob", "carl", "dora")
PATHS = ("/ann", "/ann/bob", "/ann/carl", "/ann/bob/ann")
"""Paths that must be the same in both worlds of a pair."""

_FLOOR: Mapping[Position, str] = {(x, 0, z): "stone" for x in range(14) for z in range(7)}
_WALL: Mapping[Position, str] = {(WALL_X, y, z): "bricks" for y in range(4) for z in range(7)}
_GAP: Position = (WALL_X, 1, 3)
_WEST = [(x, 1, z) for x in (1, 3, 5) for z in (0, 3, 6)]
_EAST = [(x, 1, z) for x in (7, 9, 11, 13) for z in (0, 2, 4, 6)]
_KINDS = ("chest", "barrel", "trapped_chest", "lever[face=floor]", "oak_sign", "oak_fence_gate")
_ITEMS = ("diamond", "apple", "emerald")
_LABELS = ("red box", "box, which looks as if it held candy", "toy chest")
_PLACES = {"west": [(2, 1, 1), (2, 1, 5), (4, 1, 2)], "east": [(8, 1, 1), (10, 1, 3), (12, 1, 5)]}
_CONTAINERS = frozenset({"chest", "barrel", "trapped_chest"})

Act = tuple[Any, ...]
"""Name of a method of `ScriptedWorld`, and its arguments."""


@dataclass(frozen=True)
class Side:
    """One room: its things at first.

    Attributes:
        blocks: Block state texts by position.
        contents: Contents of its containers.
        signs: Texts of its signs.
        labels: Labels of its things.
        agents: Feet of its agents.
        inventories: Items of its agents.
    """

    blocks: Mapping[Position, str]
    contents: Mapping[Position, Items]
    signs: Mapping[Position, str]
    labels: Mapping[Position, str]
    agents: Mapping[str, Point]
    inventories: Mapping[str, Items]


@dataclass(frozen=True)
class Pair:
    """Pair of worlds.

    Attributes:
        seed: Its seed, for messages.
        west: The western room of both worlds.
        east: The eastern rooms.
        seen: Acts in the western room by tick; empty: a quiet tick.
        unseen: Acts in the eastern rooms by tick, for each world.
        options: Options of perception.
        static: Names of the blocks that everybody knows.
        unique: Unique items.
        initial: Beliefs at the start.
        meet: True if the wall is opened at the end, onto rooms that are the same again.
    """

    seed: int
    west: Side
    east: tuple[Side, Side]
    seen: tuple[tuple[Act, ...], ...]
    unseen: tuple[tuple[tuple[Act, ...], ...], tuple[tuple[Act, ...], ...]]
    options: Mapping[str, Any]
    static: tuple[str, ...]
    unique: tuple[str, ...]
    initial: tuple[bn.InitialBelief, ...] = ()
    meet: bool = False
    meeting: Mapping[Position, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Played:
    """World of a pair after everything has happened.

    Attributes:
        nest: Its open nest.
        seed: Seed of the pair; doors may use it for choices of their own.
        places: Cells of the western room that have or had a thing.
        read: Words that were read for claims: speaker, text, and what the speaker can name.
    """

    nest: bn.Nest
    seed: int
    places: tuple[Position, ...]
    read: list[tuple[str, str, Nameable]]


def pair_of(seed: int) -> Pair:
    """Return the pair of a seed."""
    chance = random.Random(f"pair {seed}")
    meet = chance.random() < 0.3
    west = _side(chance, _WEST, {"ann": (2.5, 1, 2.5), "bob": (4.5, 1, 4.5)}, most=4)
    first, second = (
        _side(chance, _EAST, {"carl": (8.5, 1, 3.5), "dora": (12.5, 1, 1.5)}, most=6)
        for _ in range(2)
    )
    if not meet:
        first, second = _doubled(chance, first), _doubled(chance, second)
    things, far = dict(west.blocks), [*first.blocks, *second.blocks]
    seen = tuple(_seen(chance, things, far) for _ in range(chance.randint(3, 9)))
    unseen = tuple(
        tuple(_unseen(chance, side, meet=meet) for _ in seen) for side in (first, second)
    )
    hearing: Any = chance.choice(["sight", {"radius": 2}])
    return Pair(
        seed,
        west,
        (first, second),
        seen,
        (unseen[0], unseen[1]),
        {"hearing": hearing, "testimony": chance.choice(["none", "accept"])},
        chance.choice([(), ("stone", "bricks"), ("stone",)]),
        chance.choice([(), ("emerald",)]) if _has_one(west, first, second, "emerald") else (),
        meet=meet,
        meeting=_meeting(chance) if meet else {},
    )


@functools.cache
def _renderer() -> Renderer:
    """Return the renderer of all nests, which compiles each template once."""
    return Renderer()


@contextmanager
def played(pair: Pair, which: int) -> Iterator[Played]:
    """Play one world of a pair, and give it while its nest is open."""
    east, west = pair.east[which], pair.west
    world = bn.ScriptedWorld(
        BOX,
        {**_FLOOR, **_WALL, **west.blocks, **east.blocks},
        {**west.agents, **east.agents},
        inventories={**west.inventories, **east.inventories},
        containers={**west.contents, **east.contents},
        signs={**west.signs, **east.signs},
    )
    labels = {**west.labels, **east.labels}
    setting = Setting(
        "pair",
        world.snapshot(),
        bn.Perception(**pair.options),
        static_blocks=frozenset(pair.static),
        initial_beliefs=pair.initial,
        labels={at: label.partition(",")[0] for at, label in labels.items()},
        prompt_labels=labels,
        places={"yard": (1, 1, 5), "garden": (4, 1, 1)},
        unique=frozenset(pair.unique),
    )
    read: list[tuple[str, str, Nameable]] = []

    def claims(text: str, speaker: str, nameable: Nameable) -> list[bn.Claim]:
        read.append((speaker, text, nameable))
        places = (*nameable.containers, *nameable.doors)[-1:]
        return [bn.Claim.located(item, at) for item in nameable.items[-1:] for at in places]

    with bn.Nest.open(setting, "scripted", renderer=_renderer(), claims_from=claims) as nest:
        real = nest.scripted_world
        for seen, unseen in zip(pair.seen, pair.unseen[which], strict=True):
            _beat(real, [*seen, *unseen])
        if pair.meet:
            _beat(real, list(_alike(pair)))
            _beat(real, [("place_agent", name, at) for name, at in _STANDS.items()])
            _beat(real, [("set_block", _GAP, "air")])
            _beat(real, [("place_agent", "ann", (5.5, 1, 3.5))])
        yield Played(nest, pair.seed, tuple(sorted({*_WEST, *west.blocks})), read)


_STANDS: Mapping[str, Point] = {"carl": (9.5, 1, 1.5), "dora": (12.5, 1, 3.5)}


def _alike(pair: Pair) -> Iterator[Act]:
    """Yield the acts that make both eastern rooms the same."""
    for at in _EAST:
        yield ("set_block", at, "air")
        yield ("set_block", at, pair.meeting.get(at, "air"))


def _meeting(chance: random.Random) -> dict[Position, str]:
    """Return the things of the eastern room when Ann looks in."""
    kinds = ("chest", "barrel", "stone", "furnace")
    return {at: chance.choice(kinds) for at in chance.sample(_EAST, chance.randint(1, 5))}


def _beat(world: bn.ScriptedWorld, acts: list[Act]) -> None:
    """Do acts in one tick; leave out the impossible ones; without any, let one tick pass."""
    with world.tick():
        for act in acts:
            with suppress(bn.WorldError):
                _do(world, act)


def _do(world: bn.ScriptedWorld, act: Act) -> None:
    match act:
        case ("use_lever", who, at, on):
            world.use_lever(who, at, powered=on)
        case ("use_door", who, at, on):
            world.use_door(who, at, open=on)
        case (name, *arguments):
            getattr(world, name)(*arguments)


def _side(
    chance: random.Random, cells: list[Position], agents: Mapping[str, Point], most: int
) -> Side:
    blocks = {at: chance.choice(_KINDS) for at in chance.sample(cells, chance.randint(0, most))}
    holders = [at for at, block in blocks.items() if block in _CONTAINERS]
    return Side(
        blocks,
        {at: _items(chance) for at in holders},
        {at: chance.choice(["", "in", "out"]) for at, b in blocks.items() if b == "oak_sign"},
        {at: chance.choice(_LABELS) for at in holders if chance.random() < 0.4},
        agents,
        {name: {**_items(chance), "chest": 1, "cobblestone": 2} for name in agents},
    )


def _doubled(chance: random.Random, side: Side) -> Side:
    """Return an eastern room in which some chests are left halves of double chests."""
    halves: dict[Position, str] = {}
    for (x, y, z), block in side.blocks.items():
        if block == "chest" and x + 1 < _EAST[-1][0] and chance.random() < 0.7:
            halves[x, y, z] = "chest[facing=north,type=left]"
            halves[x + 1, y, z] = "chest[facing=north,type=right]"
    contents = {at: held for at, held in side.contents.items() if at not in halves}
    return replace(side, blocks={**side.blocks, **halves}, contents=contents)


def _items(chance: random.Random) -> dict[str, int]:
    return {name: chance.randint(1, 2) for name in _ITEMS if chance.random() < 0.4}


def _has_one(west: Side, first: Side, second: Side, item: str) -> bool:
    """Return True if there is at most one such item in each of the worlds."""
    counts = []
    for east in (first, second):
        sides = (west, east)
        held = [each for s in sides for each in (*s.contents.values(), *s.inventories.values())]
        counts.append(sum(each.get(item, 0) for each in held))
    return max(counts) <= 1


def _seen(
    chance: random.Random, things: dict[Position, str], far: list[Position]
) -> tuple[Act, ...]:
    """Return the acts of one tick in the western room; follow its blocks."""
    if chance.random() < 0.25:
        return ()
    who = chance.choice(("ann", "bob"))
    act = _act(chance, who, list(things), _PLACES["west"], _WEST, far)
    if act[0] == "set_block" or act[0] == "put":
        things.setdefault(act[1] if act[0] == "set_block" else act[3], "chest")
    return (act,)


def _unseen(chance: random.Random, side: Side, *, meet: bool) -> tuple[Act, ...]:
    """Return the acts of one tick in an eastern room.

    Args:
        chance: Random numbers.
        side: The room.
        meet: True if possessions must stay as Ann cannot yet know them: the rooms become the same.
    """
    acts = []
    for _ in range(chance.randint(0, 2)):
        who = chance.choice(("carl", "dora"))
        acts.append(_act(chance, who, list(side.blocks), _PLACES["east"], _EAST, _WEST))
    kept = {"place_agent", "arrive", "say", "think", "whisper", "open", "set_block", "use_lever"}
    return tuple(each for each in acts if not meet or each[0] in kept)


def _act(
    chance: random.Random,
    who: str,
    things: list[Position],
    spots: list[Position],
    cells: list[Position],
    far: list[Position],
) -> Act:
    """Return one act of an agent in a room; it may turn out to be impossible.

    Args:
        chance: Random numbers.
        who: The agent.
        things: Cells of the room that have or had a thing.
        spots: Floor on which the agent may stand.
        cells: Cells of the room that things may be put into.
        far: Cells behind the wall about which it may speak.
    """
    x, y, z = chance.choice(spots)
    feet = (x + 0.5, float(y), z + 0.5)
    at = chance.choice(things or cells)
    item = {chance.choice(_ITEMS): 1}
    other = {"ann": "bob", "bob": "ann", "carl": "dora", "dora": "carl"}[who]
    claim = bn.Claim.located("apple", chance.choice(far or [at]))
    acts: list[Callable[[], Act]] = [
        lambda: ("place_agent", who, feet),
        lambda: ("place_agent", who, feet),
        lambda: ("arrive", who, feet),
        lambda: ("open", who, at),
        lambda: ("deposit", who, at, item),
        lambda: ("withdraw", who, at, item),
        lambda: ("say", who, chance.choice(["hello", "look"]), chance.choice([[claim], []])),
        lambda: ("whisper", who, other, "psst"),
        lambda: ("think", who, "hm"),
        lambda: ("use_lever", who, at, chance.random() < 0.5),
        lambda: ("use_door", who, at, chance.random() < 0.5),
        lambda: ("write_sign", who, at, chance.choice(["new", "old"])),
        lambda: ("give", who, other, item),
        lambda: ("put", who, "chest", chance.choice(cells)),
        lambda: ("mine", who, at),
        lambda: ("set_block", at, chance.choice(["air", "barrel", "stone", "chest"])),
    ]
    return chance.choice(acts)()
