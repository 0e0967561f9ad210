"""Random stories for the laws of the nest: a small world, agents, and what they do.

A story prints as Python and is replayed by `Stage`; an act that is impossible when its
turn comes is left out, so that a story shrinks to any part of itself.
"""

from collections.abc import Callable, Mapping
from functools import cached_property
from itertools import pairwise
from math import pi
from pathlib import Path
from typing import Any

import msgspec
from hypothesis import strategies as st

import beliefnest as bn
from beliefnest.world.registry import Registry
from beliefnest.world.values import Items, Point, Position

LOW, HIGH = (0, 0, 0), (7, 3, 7)
BOXES = {
    "small": (LOW, HIGH),
    # With borders of chunks between the cells 3 and 4 along x and z, and 0 and 1 along y.
    "straddling": ((-4, -6, -4), (8, 3, 8)),
    "large": ((-12, -6, -12), (19, 9, 19)),
}
NAMES = ("ann", "bob", "cat")
REGISTRY = Registry.load()
CONTAINERS = ((2, 0, 3), (5, 0, 4))
SIGNS = ((4, 0, 3), (3, 1, 5))

Act = tuple[Any, ...]
"""Name of a method of `ScriptedWorld`, or `tick`, `edit`, `switch` or `in`, and its arguments."""


class Story(msgspec.Struct, frozen=True):
    """A start and what happens then."""

    blocks: Mapping[Position, str]
    agents: Mapping[str, Point]
    options: Mapping[str, Any]
    acts: tuple[Act, ...] = ()
    static: tuple[str, ...] = ()
    contents: Mapping[Position, Items] = msgspec.field(
        default_factory=lambda: {place: {"emerald": 2} for place in CONTAINERS}
    )
    initial: tuple[bn.InitialBelief, ...] = ()
    yaws: Mapping[str, float] = msgspec.field(default_factory=dict)
    signs: Mapping[Position, str] = msgspec.field(default_factory=dict)
    sign_claims: Mapping[Position, list[bn.Claim]] = msgspec.field(default_factory=dict)
    unique: Mapping[str, str] = msgspec.field(default_factory=dict)
    """Unique item to who has it at first; `hand NAME`: in the hand."""
    box: str = "small"
    """Key of `BOXES`."""

    def world(self) -> bn.ScriptedWorld:
        """Return the world at the start; every agent owns an apple and two diamonds."""
        own = {name: {"apple": 1, "diamond": 2} for name in self.agents}
        hands = {}
        for item, holder in self.unique.items():
            own[holder.split()[-1]][item] = 1
            if " " in holder:
                hands[holder.split()[-1]] = {"main_hand": item}
        world = bn.ScriptedWorld(
            BOXES[self.box],
            self.blocks | dict.fromkeys(self.signs, "oak_sign"),
            self.agents,
            inventories=own,
            equipment=hands,
            containers=self.contents,
            signs=self.signs,
            sign_claims={at: c for at, c in self.sign_claims.items() if self.signs.get(at)},
        )
        with world.tick():
            for name, yaw in self.yaws.items():
                world.place_agent(name, self.agents[name], yaw)
        return world

    def perception(self) -> bn.Perception:
        """Return the options of the agents' perception."""
        return bn.Perception(**self.options)


class Stage:
    """A story being played in a world, with its nest.

    Attributes:
        story: The story.
        world: The real world.
        nest: Its nest.
        start: The nest's first tick.
    """

    def __init__(self, story: Story, store: Path | None = None) -> None:
        self.story = story
        self.world = story.world()
        self.start = self.world.now
        self.nest = bn.Nest(
            self.world,
            story.perception(),
            static_blocks=story.static,
            initial_beliefs=story.initial,
            store=store,
            unique=story.unique,
        )

    def do(self, act: Act) -> bool:
        """Do one act of the story; false if it was impossible."""
        name, *args = act
        try:
            if name in ("edit", "switch"):
                path, *rest = args
                getattr(self.nest[path], name)(*rest)
            elif name == "in":
                path, inner = args
                do_in(self.nest[path].scripted, inner)
            else:
                do_in(self.world, act)
        except (bn.WorldError, bn.BranchError, bn.InputError):
            return False
        return True

    def play(self, after_each: Callable[[], object] = lambda: None) -> "Stage":
        """Do all acts; `after_each` is called once before them and after each."""
        after_each()
        for act in self.story.acts:
            self.do(act)
            after_each()
        return self


def do_in(world: bn.ScriptedWorld, act: Act) -> None:
    """Do one act in a world; several, in one tick, if it is a `tick`."""
    name, *args = act
    if name != "tick":
        getattr(world, name)(*args)
        return
    with world.tick():
        for inner in args:
            do_in(world, inner)


class Stories:
    """Strategies for stories.

    Args:
        blocks: Texts of the blocks that are built with.
        options: Options of perception that differ from the default, and their values.
        max_acts: Greatest number of acts.
        forks: Whether beliefs are forked, acted in and edited as well.
        ticks: Whether several acts may happen in one tick.
        priors: Whether there are static blocks and initial beliefs.
        whispers: Whether agents whisper as well.
        claims: Whether they claim something, which hearers may take up.
        signs: Whether there are signs, and agents write on them.
        unique: Whether there is a gold ingot, of which there is one.
        signed: Whether signs carry claims.
    """

    def __init__(
        self,
        blocks: tuple[str, ...] = ("stone", "glass", "oak_slab", "oak_slab[type=top]"),
        options: Mapping[str, Any] | None = None,
        max_acts: int = 15,
        *,
        forks: bool = False,
        ticks: bool = True,
        priors: bool = True,
        whispers: bool = True,
        claims: bool = False,
        signs: bool = False,
        unique: bool = False,
        signed: bool = False,
    ) -> None:
        self._blocks = st.sampled_from(blocks)
        self._options = options
        self._max_acts = max_acts
        self._forks = forks
        self._ticks = ticks
        self._priors = priors
        self._whispers = whispers
        self._claims = claims
        self._signs = signs
        self._unique = unique
        self._signed = signed

    @cached_property
    def story(self) -> st.SearchStrategy[Story]:
        """Whole stories."""
        act = self.act
        if self._forks:
            acts = [act] * 6 + [self._edit, self._switch, self._inside, self._inside]
            act = st.one_of(*acts)
        static, priors = [(), ("stone",), ("stone", "chest")], 2
        if self._signs:
            static.append(("stone", "oak_sign"))
        if not self._priors:
            static, priors = [()], 0
        initial = st.lists(self._initial, max_size=priors, unique_by=lambda belief: belief.path)
        return st.builds(
            Story,
            blocks=self._walls,
            agents=st.fixed_dictionaries(dict.fromkeys(NAMES, self._feet)),
            options=self._perception,
            acts=st.lists(act, max_size=self._max_acts).map(tuple),
            static=st.sampled_from(static),
            initial=initial.map(tuple),
            yaws=st.fixed_dictionaries(dict.fromkeys(NAMES, self._yaw)),
            signs=self._writing if self._signs else st.just({}),
            sign_claims=self._signing if self._signed else st.just({}),
            unique=self._holder if self._unique else st.just({}),
        )

    @cached_property
    def _signing(self) -> st.SearchStrategy[dict[Position, list[bn.Claim]]]:
        claims = st.lists(self._claim, min_size=1, max_size=2)
        return st.dictionaries(st.sampled_from(SIGNS), claims, max_size=2)

    @cached_property
    def _holder(self) -> st.SearchStrategy[dict[str, str]]:
        holders = st.sampled_from([*NAMES, *(f"hand {name}" for name in NAMES)])
        return holders.map(lambda holder: {"gold_ingot": holder})

    @cached_property
    def _initial(self) -> st.SearchStrategy[bn.InitialBelief]:
        """A prior of a node of depth 1 to 3."""
        paths = st.lists(st.sampled_from(NAMES), min_size=1, max_size=3).filter(
            lambda names: all(a != b for a, b in pairwise(names))
        )
        states = st.sampled_from([-1, *map(REGISTRY.state_id, ("air", "stone", "chest"))])
        held = st.just({"emerald": 1})
        who = st.sampled_from(NAMES)
        # Two priors may speak of one node, and have to agree about where it is.
        place = CONTAINERS
        if self._unique:
            held |= st.just({"emerald": 1, "gold_ingot": 1})
            place = CONTAINERS[:1]
        contents = st.tuples(held, st.booleans())
        return st.builds(
            bn.InitialBelief,
            path=st.one_of(
                paths.map(tuple), paths.map(lambda names: (*names[:2], "**")), st.just(("**",))
            ),
            containers=st.dictionaries(st.sampled_from(place), contents, max_size=1),
            blocks=st.dictionaries(self._cell(range(2)), states, max_size=3),
            agents=st.dictionaries(st.sampled_from(NAMES), self._feet, max_size=1),
            inventories=st.dictionaries(who, st.just({"diamond": 1}), max_size=1),
        )

    @cached_property
    def act(self) -> st.SearchStrategy[Act]:
        """One act in a world."""
        single = self._single
        if not self._ticks:
            return single
        ticks = st.lists(single, min_size=2, max_size=3).map(lambda acts: ("tick", *acts))
        return st.one_of(single, single, single, ticks, st.just(("step", 1)))

    @cached_property
    def _single(self) -> st.SearchStrategy[Act]:
        who = st.sampled_from(NAMES)
        container = st.sampled_from(CONTAINERS)
        items = st.sampled_from([{"diamond": 1}, {"emerald": 1}, {"diamond": 2, "apple": 1}])
        if self._unique:
            gold = st.just({"gold_ingot": 1})
            items = gold | gold | items | st.just({"gold_ingot": 1, "apple": 1})
        place = st.tuples(st.just("place_agent"), who, self._feet, self._yaw)
        anywhere = st.one_of(self._cell(range(4)), container)
        block = st.one_of(self._blocks, st.sampled_from(["air", "chest", "barrel"]))
        speech = st.tuples(st.sampled_from(["say", "think"]), who, st.sampled_from(["hi", "hm"]))
        if self._whispers:
            speech |= st.tuples(st.just("whisper"), who, who, st.sampled_from(["hi", "hm"]))
        if self._claims:
            claims = st.lists(self._claim, min_size=1, max_size=2)
            told = st.tuples(st.just("say"), who, st.just("so"), claims)
            told |= st.tuples(st.just("whisper"), who, who, st.just("so"), claims)
            speech = st.one_of(speech, told, told, told)
        signs = []
        if self._signs:
            place_of = st.sampled_from(SIGNS)
            kinds = st.sampled_from(["oak_sign", "oak_sign[rotation=4]", "stone", "air"])
            write = st.tuples(st.just("write_sign"), who, place_of, self._text)
            if self._signed:
                told = st.lists(self._claim, max_size=2)
                text = st.sampled_from(["in", "out"])
                write = st.tuples(st.just("write_sign"), who, place_of, text, told)
            signs = [write, write, st.tuples(st.just("set_block"), place_of, kinds)]
        return st.one_of(
            *signs,
            *([speech] if self._claims else []),
            place,
            place,
            st.tuples(st.just("set_block"), anywhere, block),
            st.tuples(st.sampled_from(["deposit", "withdraw"]), who, container, items),
            st.tuples(st.just("open"), who, container),
            speech,
            st.tuples(st.just("give"), who, who, items),
        )

    @cached_property
    def _claim(self) -> st.SearchStrategy[bn.Claim]:
        """A claim, sometimes about a place without a container."""
        place = st.sampled_from(CONTAINERS) | self._cell(range(2))
        item = st.sampled_from(["gold_ingot"] if self._unique else ["diamond", "emerald"])
        block = self._blocks | st.sampled_from(["air", "chest", "chest[facing=east]", "barrel"])
        if self._signs:
            place |= st.sampled_from(SIGNS)
            block |= st.sampled_from(["oak_sign", "oak_sign[rotation=4]"])
        return st.one_of(
            st.builds(bn.Claim.located, item, st.sampled_from(CONTAINERS)),
            st.builds(bn.Claim.located, item, place),
            st.builds(bn.Claim.absent, item, place),
            st.builds(bn.Claim.position, st.sampled_from(NAMES), self._feet),
            st.builds(bn.Claim.block, place, block),
        )

    @cached_property
    def _text(self) -> st.SearchStrategy[str]:
        return st.sampled_from(["in", "out", ""])

    @cached_property
    def _writing(self) -> st.SearchStrategy[dict[Position, str]]:
        return st.dictionaries(st.sampled_from(SIGNS), self._text, max_size=2)

    @cached_property
    def _path(self) -> st.SearchStrategy[str]:
        pairs = [f"/{a}/{b}" for a in NAMES for b in NAMES if a != b]
        return st.sampled_from([f"/{name}" for name in NAMES] + pairs)

    @cached_property
    def _edit(self) -> st.SearchStrategy[Act]:
        blocks = st.dictionaries(self._cell(range(2)), self._blocks, max_size=1)
        held = st.just({"apple": 3})
        if self._unique:
            held |= st.just({"apple": 1, "gold_ingot": 1})
        contents = st.dictionaries(st.sampled_from(CONTAINERS), held, max_size=1)
        signs = self._writing if self._signs else st.just({})
        return st.tuples(st.just("edit"), self._path, blocks, contents, signs)

    @cached_property
    def _switch(self) -> st.SearchStrategy[Act]:
        return st.tuples(st.just("switch"), self._path, st.sampled_from(["one", "two", "follow"]))

    @cached_property
    def _inside(self) -> st.SearchStrategy[Act]:
        return st.tuples(st.just("in"), self._path, self.act)

    @cached_property
    def _walls(self) -> st.SearchStrategy[dict[Position, str]]:
        wall = st.builds(
            _wall, self._blocks, st.booleans(), *[st.integers(0, 7)] * 3, st.integers(1, 4)
        )
        return st.lists(wall, max_size=4).map(_without_containers)

    @cached_property
    def _perception(self) -> st.SearchStrategy[dict[str, Any]]:
        if self._options is not None:
            return st.just(dict(self._options))
        testimony = {
            "testimony": st.sampled_from(["accept", "informed", "informed", "informed"]),
            "grace": st.integers(0, 3),
            "sincere": st.booleans(),
        }
        return st.fixed_dictionaries(
            testimony if self._claims else {},
            optional={
                "hearing": st.sampled_from(["sight", {"radius": 3}]),
                "containers": st.just("transparent"),
                "negative_evidence": st.just(True),
                "max_visible_distance": st.sampled_from([4, 5.5, None]),
                "field_of_view": st.sampled_from([90, 200]),
            },
        )

    @cached_property
    def _feet(self) -> st.SearchStrategy[Point]:
        return self._cell([0]).map(lambda cell: (cell[0] + 0.5, float(cell[1]), cell[2] + 0.5))

    @cached_property
    def _yaw(self) -> st.SearchStrategy[float]:
        return st.sampled_from([0.0, pi / 2, pi, -pi / 2])

    def _cell(self, heights: "range | list[int]") -> st.SearchStrategy[Position]:
        level = st.integers(0, 7)
        return st.tuples(level, st.sampled_from(list(heights)), level)


def _wall(
    block: str, along_x: bool, where: int, a: int, b: int, height: int
) -> dict[Position, str]:
    span = range(min(a, b), max(a, b) + 1)
    cells = [(k, where) if along_x else (where, k) for k in span]
    return {(x, y, z): block for x, z in cells for y in range(height)}


def _without_containers(walls: list[dict[Position, str]]) -> dict[Position, str]:
    return {p: block for wall in walls for p, block in wall.items() if p not in CONTAINERS}
