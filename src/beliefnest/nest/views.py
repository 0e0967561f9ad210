"""Read-only views of belief states, as users, prompts and pictures get them."""

from collections.abc import Iterator

import numpy as np

from beliefnest.belief.entries import Basis, PerceivedEvent
from beliefnest.belief.state import BeliefState
from beliefnest.belief.view import State
from beliefnest.errors import PositionError
from beliefnest.world.registry import Registry
from beliefnest.world.values import EventKind, Position

__all__ = ["view"]

_SPEECH = (EventKind.CHAT, EventKind.THINK)


class _Blocks:
    """The blocks of a belief state, by position."""

    def __init__(self, state: BeliefState, registry: Registry) -> None:
        self._state = state
        self._registry = registry

    def __getitem__(self, position: Position) -> str | None:
        state = int(self._state.terrain.blocks[self._index(position)])
        return None if state < 0 else self._registry.text(state)

    def __iter__(self) -> Iterator[Position]:
        return self._state.terrain.box.positions()

    def __len__(self) -> int:
        return int(self._state.terrain.blocks.size)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, _Blocks):
            return NotImplemented
        return bool(np.array_equal(self._state.terrain.blocks, other._state.terrain.blocks))

    __hash__ = None  # type: ignore[assignment]  # compared by value, and values are large

    def named(self, names: frozenset[str]) -> dict[Position, str]:
        states = [s for name in sorted(names) for s in self._registry.state_ids(name)]
        blocks = self._state.terrain.blocks
        low = self._state.terrain.box.low
        return {
            (low[0] + i, low[1] + j, low[2] + k): self._registry.text(int(blocks[i, j, k]))
            for i, j, k in np.argwhere(np.isin(blocks, states)).tolist()
        }

    def current(self, position: Position) -> bool:
        return bool(self._state.grounds.current[self._index(position)])

    def basis(self, position: Position) -> Basis | None:
        return self._state.grounds.basis(self._index(position))

    def _index(self, position: Position) -> tuple[int, int, int]:
        box = self._state.terrain.box
        if position not in box:
            raise PositionError(f"position {position} lies outside the box {box.low}..{box.high}")
        return box.index(position)


def view(path: tuple[str, ...], state: BeliefState, tick: int, registry: Registry) -> State:
    """The view of a state at a tick (a quiet one, perhaps, after the state's own)."""
    events = state.events()
    return State(
        path=path,
        tick=tick,
        box=state.terrain.box,
        blocks=_Blocks(state, registry),
        containers=dict(sorted(state.containers.items())),
        agents=dict(state.agents),
        items={number: belief.item for number, belief in state.items.items()},
        events=tuple(event for event in events if event.kind not in _SPEECH),
        chat=_said(events, EventKind.CHAT),
        thoughts=_said(events, EventKind.THINK),
    )


def _said(events: tuple[PerceivedEvent, ...], kind: EventKind) -> tuple[tuple[int, str, str], ...]:
    return tuple((e.tick, e.actor or "", e.detail["text"]) for e in events if e.kind is kind)
