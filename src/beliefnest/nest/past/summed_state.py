"""States of a timeline's own simulator, summed up from its entries without a forest.

The simulator of a timeline perceives nothing: its state is the sum of all changes. Imagined
histories share a beginning and differ in few entries, so a state of one of them costs only what is
read of it.
"""

from bisect import bisect_left, bisect_right
from collections.abc import Mapping, Sequence
from itertools import accumulate

import numpy as np
import numpy.typing as npt
from msgspec.structs import replace

from beliefnest.belief.columns import cell_of, place_of
from beliefnest.belief.grounds import AgentBelief, Basis, ContainerBelief, PerceivedEvent, Source
from beliefnest.belief.holdings import Content, Holdings
from beliefnest.belief.node_view import Part
from beliefnest.nest.past.timeline_state import TimelineState
from beliefnest.timeline.journal import Entry, TimelineKey
from beliefnest.world.claims import claims_written
from beliefnest.world.double_chests import ByEitherHalf
from beliefnest.world.frames import Frame
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import AgentState, DroppedItem, Position


class StateSums:
    """Sums of the entries of a timeline after a known state of its own simulator.

    Args:
        base: The known state. It may be of another timeline with an equal beginning.
        key: The timeline.
        first: Number of its entries that led to the known state.
        entries: Its further entries.
        until: Last tick of the timeline.

    Attributes:
        frames: The further entries up to the first that has to be folded: an edit, or a frame in
            which an agent leaves.
        moves: Numbers of the frames with new states of an agent, and these, by name.
        events: Number of events before each of the frames, and after the last.
    """

    def __init__(
        self,
        base: TimelineState,
        key: TimelineKey,
        first: int,
        entries: Sequence[Entry],
        until: int,
    ) -> None:
        self.base, self.key, self.first, self.until = base, key, first, until
        self.frames: list[Frame] = []
        self.moves: dict[str, tuple[list[int], list[AgentState]]] = {}
        self._ticks = [entry.tick for entry in entries]
        self._reached: tuple[int, Terrain, Holdings] | None = None
        for number, entry in enumerate(entries):
            if not isinstance(entry, Frame) or None in entry.agents.values():
                break
            self.frames.append(entry)
            for name, state in entry.agents.items():
                numbers, states = self.moves.setdefault(name, ([], []))
                if state is not None:
                    numbers.append(number)
                    states.append(state)
        self.events = [0, *accumulate(len(frame.events) for frame in self.frames)]

    def state(self, tick: int | None) -> TimelineState | None:
        """Return the state at a tick, None: the last one. The result is None if it is not summed.

        That is so for ticks outside the timeline, and after an entry that has to be folded.
        """
        then = self.until if tick is None else tick
        count = bisect_right(self._ticks, then)
        if count > len(self.frames) or not self.base.tick <= then <= self.until:
            return None
        return _SummedState(self, count, then)

    def after(self, count: int) -> tuple[Terrain, Holdings]:
        """Return the numbers of the blocks, and the holdings, after the first `count` frames."""
        if self._reached is None or self._reached[0] > count:
            self._reached = (0, self.base.numbers, _holdings(self.base))
        reached, numbers, holdings = self._reached
        if reached == count:
            return numbers, holdings
        context, changed = self.base._context, {}
        for frame in self.frames[reached:count]:
            holdings.take(frame, context.box)
            for place, block in frame.blocks.items():
                number = context.number(block, claims_written(frame, place))
                changed[context.box.index(place)] = number
                name = context.container_name(number)
                holdings.take_block(cell_of(context.box, place), name, frame.tick)
        if changed:
            draft = numbers.draft()
            for index, number in changed.items():
                draft[index] = number
            numbers = draft.terrain()
        self._reached = (count, numbers, holdings)
        return numbers, holdings


class _SummedState(TimelineState):
    """State after some frames. Its forest is that of the known state."""

    def __init__(self, sums: StateSums, count: int, tick: int) -> None:
        base = sums.base
        super().__init__(base._forest, base.path, tick, sums.key, base._source)
        self._sums, self._base, self._count = sums, base, count
        self._position, self._is_left = sums.first + count, True
        self.count_of_events = base.count_of_events + sums.events[count]

    def keep(self) -> None:
        """Do nothing: all parts follow from the known state, which keeps its own."""

    @Part
    def numbers(self) -> Terrain:
        """The numbers of the blocks."""
        return self._sums.after(self._count)[0]

    @Part
    def agents(self) -> Mapping[str, AgentBelief]:
        """The states of all agents, by name."""
        return {name: self._moved(name, belief) for name, belief in self._base.agents.items()}

    @Part
    def containers(self) -> Mapping[Position, ContainerBelief]:
        """The contents, in order of position; found at either half of a double chest."""
        contents = self._sums.after(self._count)[1].containers
        beliefs, ground = {}, self._ground
        for cell in sorted(contents):
            content = contents[cell]
            if not self._count:
                ground = replace(content.basis, observed_at=self.tick)
            place = place_of(self.box, cell)
            beliefs[place] = ContainerBelief(content.items, content.complete, ground, True)
        return ByEitherHalf(beliefs, self.container_at)

    @Part
    def items(self) -> Mapping[int, DroppedItem]:
        """The dropped items, by number."""
        return dict(self._sums.after(self._count)[1].items)

    @Part
    def perceived(self) -> tuple[PerceivedEvent, ...]:
        """All events, oldest first."""
        return (*self._base.perceived, *self.events_since(self._base.count_of_events))

    def events_since(self, count: int) -> tuple[PerceivedEvent, ...]:
        """Return the events except the timeline's first `count`, oldest first."""
        new = [
            PerceivedEvent(frame.tick, event.kind, event.actor, event.detail)
            for frame in self._sums.frames[: self._count]
            for event in frame.events
        ]
        before = self._base.count_of_events
        early = self._base.events_since(count) if count < before else ()
        return (*early, *new[max(count - before, 0) :])

    def perceived_since(self, count: int) -> npt.NDArray[np.bool_]:
        """Return a mask of the events after the first `count`, all of which count as perceived."""
        return np.ones(max(self.count_of_events - count, 0), dtype=np.bool_)

    @property
    def _ground(self) -> Basis:
        return Basis(self.tick, Source.SEEN)

    def _moved(self, name: str, belief: AgentBelief) -> AgentBelief:
        """Return the state of an agent, from the known one and its last move."""
        numbers, states = self._sums.moves.get(name, _NO_MOVES)
        count = bisect_left(numbers, self._count)
        ground, moved = belief.basis, states[count - 1] if count else belief
        if count:
            ground = self._ground
        elif ground is not None and belief.current:
            ground = Basis(self.tick, ground.source, ground.event, ground.speaker)
        return AgentBelief(
            moved.position,
            moved.yaw,
            moved.pitch,
            moved.on_ground,
            moved.equipment,
            moved.inventory,
            belief.inventory_complete,
            moved.health,
            moved.food,
            ground,
            belief.current or count > 0,
        )


_NO_MOVES: tuple[list[int], list[AgentState]] = ([], [])


def _holdings(state: TimelineState) -> Holdings:
    """Return the contents and dropped items of a state, by cell."""
    containers = {
        cell_of(state.box, place): Content(each.items, each.complete, each.basis)
        for place, each in state.containers.items()
    }
    return Holdings(containers, items=dict(state.items))
