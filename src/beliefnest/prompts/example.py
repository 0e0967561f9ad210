"""A small hand-made belief for the filter reference and for trying out filters."""

from collections.abc import Iterator, Mapping
from types import MappingProxyType

import msgspec
import numpy as np

from beliefnest.belief.grounds import AgentBelief, Basis, ContainerBelief, PerceivedEvent, Source
from beliefnest.belief.view import FixedState
from beliefnest.errors import PathError, PositionError
from beliefnest.prompts.mind_view import MindView, ToldMind
from beliefnest.prompts.observations import Found, Happened, Outset, Read, SightChange
from beliefnest.world.event_kinds import EventKind
from beliefnest.world.frames import BlockGrid
from beliefnest.world.paths import BeliefPath
from beliefnest.world.registry import Registry, block_name
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import Box, Position

_BOX = Box((-11, -52, -11), (11, -49, 11))
_LEFT: Position = (-2, -51, -4)
_RIGHT: Position = (2, -51, -4)
_LEVER: Position = (0, -51, -4)
_SIGN: Position = (4, -51, -4)


class ExampleBlocks(msgspec.Struct, frozen=True):
    """Believed blocks given one by one; the rest of the box is unknown.

    Attributes:
        box: Region of the scenario.
        known: Canonical block state texts by position.
        visible: Positions that are seen at this tick.
    """

    box: Box
    known: Mapping[Position, str]
    visible: frozenset[Position] = frozenset()

    def __getitem__(self, position: Position) -> str | None:
        """Return the block state text; None if the block is unknown.

        Raises:
            PositionError: The position is outside the box.
        """
        if position not in self.box:
            raise PositionError(f"{position} is outside the box {self.box.low} to {self.box.high}")
        return self.known.get(position)

    def __iter__(self) -> Iterator[Position]:
        """Yield all positions of the box."""
        return self.box.positions()

    def __len__(self) -> int:
        """Return the number of positions in the box."""
        width, height, depth = self.box.shape
        return width * height * depth

    def named(self, names: frozenset[str]) -> dict[Position, str]:
        """Return the known blocks with one of the names, in order of position."""
        return {at: block for at, block in sorted(self.known.items()) if block_name(block) in names}

    @property
    def grid(self) -> BlockGrid:
        """Block state ids, shape of the box, -1 where unknown."""
        grid = np.full(self.box.shape, -1, dtype=np.int32)
        for at, block in self.known.items():
            grid[self.box.index(at)] = Registry.load().state_id(block)
        return grid

    @property
    def terrain(self) -> Terrain:
        """Block state ids, -1 where unknown."""
        return Terrain.of(self.grid)

    def current(self, position: Position) -> bool:
        """Return True if the block is seen at this tick."""
        return position in self.visible

    def basis(self, position: Position) -> Basis | None:
        """Return "seen at tick 0" for known blocks, None for others."""
        return Basis(0, Source.SEEN) if position in self.known else None


def example_mind(
    state: FixedState,
    children: Mapping[str, MindView] = MappingProxyType({}),
    mind: ToldMind | None = None,
) -> MindView:
    """Return a simulator that consists of its state, the nested beliefs, and what is observed."""

    def below(agent: str) -> MindView:
        if agent not in children:
            raise PathError(f"the example has no belief of {agent!r}")
        return children[agent]

    return MindView(state, lambda: mind or ToldMind((), {}, {}, {}), below)


def example_branch() -> MindView:
    """Return Sally's belief at tick 240, and her belief about Anne's belief."""
    deposit = PerceivedEvent(
        69, EventKind.DEPOSIT_ITEM_INTO_CHEST, "sally", {"position": _LEFT, "items": {"diamond": 1}}
    )
    lever = PerceivedEvent(131, EventKind.USE_LEVER, "anne", {"position": _LEVER, "powered": True})
    outer = example_mind(_state(("sally", "anne", "sally"), (deposit,), frozenset()))
    anne = example_mind(
        _state(("sally", "anne"), (deposit, lever), frozenset({_RIGHT})), {"sally": outer}
    )
    names = {_LEFT: "western chest", _RIGHT: "eastern chest", _LEVER: "lever", _SIGN: "sign"}
    observations = (
        Outset(
            0,
            "sally",
            {"sally": (-0.5, -51, 3.5), "anne": (2.5, -51, -0.5)},
            {"sally": {"diamond": 1}, "anne": {"iron_helmet": 1}},
        ),
        SightChange(0, "sally", {"anne": (2.5, -51, -0.5)}, (_LEFT, _RIGHT, _SIGN)),
        Read(0, _SIGN, "keep shut\nplease"),
        Happened(68, PerceivedEvent(68, EventKind.OPEN_CONTAINER, "sally", {"position": _LEFT})),
        Found(68, _LEFT, {}),
        Happened(69, deposit),
        Happened(80, PerceivedEvent(80, EventKind.CHAT, "anne", {"text": "Where are you going?"})),
        Happened(95, PerceivedEvent(95, EventKind.CHAT, "sally", {"text": "Out. Back soon!"})),
        Happened(131, lever),
        SightChange(131, "sally", lost_agents={"anne": (2.5, -51, -5.5)}, lost_places=(_RIGHT,)),
    )
    return example_mind(
        _state(("sally",), (deposit, lever), frozenset({_LEFT, _LEVER})),
        {"anne": anne},
        ToldMind(observations, names, {}, {}),
    )


def _state(
    path: BeliefPath, events: tuple[PerceivedEvent, ...], visible: frozenset[Position]
) -> FixedState:
    seen, opened = Basis(240, Source.SEEN), Basis(69, Source.WITNESSED)
    return FixedState(
        path=path,
        tick=240,
        box=_BOX,
        blocks=ExampleBlocks(
            _BOX,
            {
                _LEFT: "chest[facing=south,type=single,waterlogged=false]",
                _RIGHT: "chest[facing=south,type=single,waterlogged=false]",
                _LEVER: "lever[face=floor,facing=north,powered=true]",
                _SIGN: "oak_sign[rotation=0,waterlogged=false]",
            },
            visible,
        ),
        containers={
            _LEFT: ContainerBelief({"diamond": 1}, True, opened, True),
            _RIGHT: ContainerBelief({}, False, seen, False),
        },
        agents={
            "sally": AgentBelief(
                position=(-4.551, -51.0, -5.871),
                equipment={},
                inventory_complete=True,
                basis=seen,
                current=True,
            ),
            "anne": AgentBelief(
                position=(2.5, -51.0, -5.5),
                equipment={"head": "iron_helmet", "main_hand": "iron_chestplate"},
                inventory={"iron_chestplate": 1, "iron_helmet": 1},
                basis=Basis(131, Source.SEEN),
            ),
        },
        items={},
        events=events,
        chat=((80, "anne", "Where are you going?"), (95, "sally", "Out. Back soon!")),
        thoughts=((100, "sally", "The diamond is safe."),),
        addressees=(None, None),
        signs={_SIGN: "keep shut\nplease"},
    )
