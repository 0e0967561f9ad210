"""Scripted world: a world without Minecraft and physics that does exactly what it is told.

It serves tests, imported traces and studies that need only beliefs. Every act takes one tick;
`tick()` combines several acts into one tick. An impossible act raises WorldError and changes
nothing.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager, nullcontext, suppress
from copy import copy
from typing import Any

from beliefnest.errors import InputError, WorldError
from beliefnest.facts.reading import ClaimLike, as_claims
from beliefnest.world.claims import claims_from_plain, with_claims
from beliefnest.world.doors import used_door
from beliefnest.world.event_kinds import EventKind
from beliefnest.world.frames import Frame, Snapshot
from beliefnest.world.handling import (
    Handling,
    check_holds_nothing,
    pressed_button,
    put_block,
    switched_lever,
)
from beliefnest.world.limits import AGENT_SLOTS, WORN_SLOTS, slots_at, snapshot_fault
from beliefnest.world.registry import AIR, parse_state
from beliefnest.world.signs import plain_state, text_of
from beliefnest.world.values import AgentState, Event, Items, Point, Position
from beliefnest.worlds.scripted.facts import (
    Pending,
    ScriptedFacts,
    checked_equipment,
    checked_name,
    checked_utterance,
    due_from,
    rest_of,
    sum_of,
    whole_position,
)
from beliefnest.worlds.scripted.powered import PoweredState, plates_in

Listener = Callable[[Frame], None]
"""Callback that receives a frame for every tick, empty frames included."""


class ScriptedWorld(PoweredState):
    """World whose moves are calls of its methods.

    Args:
        box: Two inclusive corners of block positions.
        blocks: Block state texts by position; the rest is air, or what `fills` sets.
        agents: Feet positions by agent name.
        inventories: Items by agent name.
        containers: Contents by position; a chest is added if `blocks` has no block there. What is
            given for both halves of a double chest is added up.
        equipment: Item names by slot (`EQUIPMENT_SLOTS`), by agent name.
        tick: The first tick.
        signs: Texts of signs by position; `blocks` must have a sign there.
        sign_claims: Claims of the texts by position.
        fills: Cuboids of one block: its state text and two inclusive corners, the lower one first;
            later ones win, and `blocks` win over all. They cost next to nothing, whatever their
            size. Containers and pressure plates are given as single blocks.

    Raises:
        WorldError: A position is outside the box, or a block, item or agent name is invalid.
    """

    def __init__(
        self,
        box: tuple[Position, Position],
        blocks: Mapping[Position, str] | None = None,
        agents: Mapping[str, Point] | None = None,
        inventories: Mapping[str, Items] | None = None,
        containers: Mapping[Position, Items] | None = None,
        equipment: Mapping[str, Mapping[str, str]] | None = None,
        tick: int = 0,
        signs: Mapping[Position, str] | None = None,
        sign_claims: Mapping[Position, Iterable[ClaimLike]] | None = None,
        fills: Iterable[tuple[str, Position, Position]] = (),
    ) -> None:
        super().__init__(box)
        self._tick = tick
        self._listeners: list[Listener] = []
        self._pending: Pending | None = None
        for block, low, high in fills:
            self._fill(block, self._inside(low), self._inside(high))
        for position, text in (blocks or {}).items():
            self._put(self._inside(position), text)
        for position, items in (containers or {}).items():
            place = self.container_at(self._inside(position))
            if place not in self._facts.containers:
                if place in {whole_position(p) for p in blocks or {}}:
                    raise WorldError(f"the block at {place} is no container; it cannot hold items")
                self._put(place, "chest")
            # A double chest may be given by its halves.
            self._facts.containers[place] = sum_of(
                self._facts.containers[place], self._items(items)
            )
        for position, text in (signs or {}).items():
            self._write(self._inside(position), text)
        for name, feet in (agents or {}).items():
            self._facts.agents[checked_name(name)] = AgentState(self._feet(feet))
        for name, items in (inventories or {}).items():
            self._set_agent(name, inventory=self._items(items))
        for name, worn in (equipment or {}).items():
            self._set_agent(name, equipment=checked_equipment(worn, self._items))
        for position, claims in (sign_claims or {}).items():
            self._claim_on(self._inside(position), self._claiming({}, claims).get("claims", ()))
        if fault := snapshot_fault(self.snapshot(), self._registry):
            raise WorldError(fault)

    @classmethod
    def from_snapshot(cls, snapshot: Snapshot) -> "ScriptedWorld":
        """Return a world with the state of a snapshot."""
        world = cls((snapshot.box.low, snapshot.box.high), tick=snapshot.tick)
        world.set_state(snapshot)
        return world

    def again(self) -> "ScriptedWorld":
        """Return a copy of this world, without its listeners."""
        other = copy(self)
        other._listeners, other._pending = [], None
        other._facts = self._facts.copied()
        other._facts.blocks = self.terrain.draft()
        return other

    @property
    def now(self) -> int:
        """Latest tick."""
        return self._tick

    @property
    def under_way(self) -> bytes:
        """Internal state for snapshots, which nobody can perceive: buttons and others that wait."""
        return self._facts.under_way(self._tick)

    def listen(self, listener: Listener) -> None:
        """Call `listener` with every further frame."""
        self._listeners.append(listener)

    def unlisten(self, listener: Listener) -> None:
        """Stop calling `listener`."""
        self._listeners.remove(listener)

    def snapshot(self) -> Snapshot:
        """Return the current state."""
        facts = self._facts
        return Snapshot(
            self._tick,
            self._box,
            self.terrain,
            {place: dict(items) for place, items in facts.containers.items()},
            dict(facts.agents),
            dict(facts.items),
            self.under_way,
            dict(facts.signs),
            dict(facts.sign_claims),
        )

    def set_state(self, snapshot: Snapshot) -> None:
        """Set the state to that of a snapshot, without a frame."""
        if snapshot.box != self._box:
            raise WorldError(f"a snapshot of {snapshot.box} does not fit into {self._box}")
        self._tick = snapshot.tick
        self._facts = ScriptedFacts(
            snapshot.blocks.draft(),
            {place: dict(items) for place, items in snapshot.containers.items()},
            dict(snapshot.agents),
            dict(snapshot.items),
            dict(snapshot.signs),
            dict(snapshot.sign_claims),
            due_from(snapshot.internal_state, snapshot.tick),
            plates_in(self._box, snapshot.blocks),
        )

    def tick(self) -> AbstractContextManager[object]:
        """Combine the acts of a `with` block into one tick; all of them happen, or none."""
        if self._pending is not None:
            raise WorldError(f"tick {self._tick + 1} has begun already; do not nest tick()")
        return self._new_tick()

    def step(self, ticks: int = 1) -> None:
        """Let ticks without acts pass."""
        if self._pending is not None:
            raise WorldError("step() takes ticks of its own; call it outside tick()")
        if ticks < 0:
            raise WorldError(f"step() got {ticks} ticks; give 0 or more")
        for _ in range(ticks):
            with self.tick():
                pass

    @property
    def is_still(self) -> bool:
        """True if nothing happens by itself: no block is about to change or senses a step."""
        return not (self._facts.due or self._facts.plates)

    def skip(self, ticks: int) -> None:
        """Let ticks pass at once in a world that is still; listeners do not hear of them.

        Raises:
            WorldError: Something would happen by itself, or a tick is under way.
        """
        if self._pending is not None or not self.is_still:
            raise WorldError("ticks in which something may happen cannot be skipped; use step()")
        self._tick += ticks

    def place_agent(
        self, name: str, position: Point, yaw: float | None = None, pitch: float | None = None
    ) -> None:
        """Move an agent to a feet position in blocks; angles are Mineflayer's radians."""
        with self._act() as pending:
            agent = self.agent(name)
            turn = float(agent.yaw if yaw is None else yaw)
            tilt = float(agent.pitch if pitch is None else pitch)
            if not (math.isfinite(turn) and math.isfinite(tilt)):
                raise WorldError(f"{name} cannot look along yaw {yaw}, pitch {pitch}")
            self._facts.agents[name] = agent.moved(self._feet(position), turn, tilt)
            pending.agents.add(name)

    def set_block(self, position: Position, block: str, actor: str | None = None) -> None:
        """Replace a block; the content of a removed container is lost."""
        with self._act() as pending:
            place = self._inside(position)
            if actor is not None:
                self.agent(actor)
            before, state = self.state_at(place), self._state(block)
            if state != before:
                self._change(pending, place, state, actor)

    def use_door(self, name: str, position: Position, *, open: bool) -> None:
        """Let an agent open or shut a wooden door (both halves), trapdoor or fence gate."""
        with self._act() as pending:
            self.agent(name)
            place = self._inside(position)
            moved = used_door(self._registry, self.state_at, place, opens=open)
            for part, state in moved.items():
                self._change(pending, part, state, None)
            detail = {"position": min(moved), "open": open}
            pending.events.append(Event(EventKind.USE_DOOR, name, detail))

    def use_lever(self, name: str, position: Position, *, powered: bool) -> None:
        """Let an agent switch a lever on or off, and with it what the lever powers."""
        with self._act() as pending:
            self.agent(name)
            place = self._inside(position)
            moved = switched_lever(self._registry, self.state_at, place, powered=powered)
            self._alter(pending, place, moved)
            detail = {"position": place, "powered": powered}
            pending.events.append(Event(EventKind.USE_LEVER, name, detail))

    def press_button(self, name: str, position: Position) -> None:
        """Let an agent press a button, which comes out again later."""
        with self._act() as pending:
            self.agent(name)
            place = self._inside(position)
            moved = pressed_button(self._registry, self.state_at, place)
            self._alter(pending, place, moved)
            self._wait(pending, place, Handling.load().pressed_ticks(self._registry.name(moved)))
            pending.events.append(Event(EventKind.PRESS_BUTTON, name, {"position": place}))

    def mine(self, name: str, position: Position) -> None:
        """Let an agent break a block and take its drops."""
        with self._act() as pending:
            agent = self.agent(name)
            place = self._inside(position)
            state = self.state_at(place)
            drops = Handling.load().drops(self._registry.name(state), agent.inventory)
            check_holds_nothing(self._registry, self.state_at, place)
            items = self._fitting(name, agent.inventory, drops, AGENT_SLOTS + WORN_SLOTS)
            self._alter(pending, place, AIR)
            self._set_agent(name, inventory=items)
            pending.agents.add(name)
            detail = {"position": place, "block": self._registry.text(state)}
            pending.events.append(Event(EventKind.MINE_BLOCK, name, detail))

    def put(self, name: str, item: str, position: Position) -> None:
        """Let an agent place a block from its inventory."""
        with self._act() as pending:
            agent = self.agent(name)
            place = self._inside(position)
            moved = self._items({item: 1})
            items = rest_of(agent.inventory, moved, f"{name} cannot put {item}: it")
            bodies = [each.position for each in self._facts.agents.values()]
            state = put_block(self._registry, self.state_at, place, item, bodies)
            self._alter(pending, place, state)
            self._set_agent(name, inventory=items)
            pending.agents.add(name)
            detail = {"position": place, "block": self._registry.text(state)}
            pending.events.append(Event(EventKind.PLACE_BLOCK, name, detail))

    def write_sign(
        self, name: str, position: Position, text: str, claims: Iterable[ClaimLike] = ()
    ) -> None:
        """Let an agent replace the text on a sign; every agent that sees the sign sees the text.

        Args:
            name: Name of the agent.
            position: Position of the sign.
            text: New text, up to 4 lines.
            claims: Claims of the text, for its readers.
        """
        with self._act() as pending:
            self.agent(name)
            place = self._inside(position)
            self._write(place, text)
            block = pending.blocks[place] = self._block(place)
            shown = {"position": place, "block": self._registry.text(plain_state(block))}
            detail = self._claiming({**shown, "text": text_of(block)}, claims)
            self._claim_on(place, detail.get("claims", ()))
            pending.events.append(Event(EventKind.BLOCK_UPDATE, name, detail))

    def arrive(self, name: str, destination: Point) -> None:
        """Let an agent reach its destination; agents that see it learn where it was going."""
        with self._act() as pending:
            self.agent(name)
            x, y, z = (float(value) for value in destination)
            pending.events.append(Event(EventKind.MOVE_TO, name, {"destination": (x, y, z)}))

    def deposit(self, name: str, position: Position, items: Items) -> None:
        """Let an agent put items from its inventory into a container."""
        self._transfer(name, position, items, EventKind.DEPOSIT_ITEM_INTO_CHEST)

    def withdraw(self, name: str, position: Position, items: Items) -> None:
        """Let an agent take items out of a container."""
        self._transfer(name, position, items, EventKind.GET_ITEM_FROM_CHEST)

    def open(self, name: str, position: Position) -> None:
        """Let an agent look into a container; other agents see the act, not the content."""
        with self._act() as pending:
            self.agent(name)
            place = self._container(position)
            pending.events.append(Event(EventKind.OPEN_CONTAINER, name, {"position": place}))

    def say(self, name: str, text: str, claims: Iterable[ClaimLike] = ()) -> None:
        """Let an agent speak aloud; `claims` are the structured statements of the text."""
        self._utter(EventKind.CHAT, name, text, claims)

    def whisper(self, name: str, other: str, text: str, claims: Iterable[ClaimLike] = ()) -> None:
        """Let an agent speak to one other agent, unnoticed by all others. Claims as in `say`."""
        with self._act() as pending:
            if name == other:
                raise WorldError(f"{name} cannot whisper to itself")
            self.agent(name)
            self.agent(other)
            detail = self._claiming({"text": checked_utterance(text), "to": other}, claims)
            pending.events.append(Event(EventKind.CHAT, name, detail))

    def think(self, name: str, text: str) -> None:
        """Let an agent think; only the agent itself perceives it."""
        self._utter(EventKind.THINK, name, text)

    def give(self, giver: str, receiver: str, items: Items) -> None:
        """Let an agent give items to another agent."""
        with self._act() as pending:
            if giver == receiver:
                raise WorldError(f"{giver} cannot give items to itself")
            other = self.agent(receiver)
            moved = self._items(items)
            left = rest_of(self.agent(giver).inventory, moved, f"{giver} cannot give {moved}: it")
            self._set_agent(giver, inventory=left)
            self._set_agent(
                receiver,
                inventory=self._fitting(receiver, other.inventory, moved, AGENT_SLOTS + WORN_SLOTS),
            )
            pending.agents |= {giver, receiver}
            for kind, name, partner in (
                (EventKind.GIVE_ITEM_TO_OTHER, giver, receiver),
                (EventKind.RECEIVE_ITEM_FROM_OTHER, receiver, giver),
            ):
                pending.events.append(Event(kind, name, {"other": partner, "items": moved}))

    def repeat(self, name: str | None, kind: EventKind, detail: Mapping[str, Any]) -> None:
        """Let an agent do again what it was seen to do; ignore kinds of events that are no calls.

        Args:
            name: Name of the agent; None: nobody was seen to change a block.
            kind: Kind of the event.
            detail: Fields of `EventDetail` that were perceived.
        """
        if kind is not EventKind.BLOCK_UPDATE:
            if name is not None and kind in _REPEATED:
                _REPEATED[kind](self, name, detail)
        elif name is not None and "text" in detail:
            claims = claims_from_plain(detail.get("claims", ()))
            self.write_sign(name, detail["position"], detail["text"], claims)
        else:
            self.set_block(detail["position"], detail["block"], name)

    def _transfer(self, name: str, position: Position, items: Items, kind: EventKind) -> None:
        with self._act() as pending:
            agent = self.agent(name)
            place = self._container(position)
            moved = self._items(items)
            inventory, inside = agent.inventory, self._facts.containers[place]
            if kind is EventKind.DEPOSIT_ITEM_INTO_CHEST:
                inventory = rest_of(inventory, moved, f"{name} cannot put {moved} into {place}: it")
                there = self._registry.name(self.state_at(place))
                slots = slots_at(self._registry, self.state_at, place)
                inside = self._fitting(f"the {there} at {place}", inside, moved, slots)
            else:
                inside = rest_of(inside, moved, f"{name} cannot take {moved}: the one at {place}")
                inventory = self._fitting(name, inventory, moved, AGENT_SLOTS + WORN_SLOTS)
            self._set_agent(name, inventory=inventory)
            self._facts.containers[place] = inside
            pending.agents.add(name)
            pending.containers.add(place)
            pending.events.append(Event(kind, name, {"position": place, "items": moved}))

    def _utter(
        self, kind: EventKind, name: str, text: str, claims: Iterable[ClaimLike] = ()
    ) -> None:
        with self._act() as pending:
            self.agent(name)
            detail = self._claiming({"text": checked_utterance(text)}, claims)
            pending.events.append(Event(kind, name, detail))

    def _claiming(self, detail: dict[str, Any], claims: Iterable[ClaimLike]) -> dict[str, Any]:
        """Return an utterance's detail with its claims; WorldError if they do not fit."""
        try:
            return with_claims(detail, as_claims(claims), self._box, self._facts.agents)
        except InputError as fault:
            raise WorldError(str(fault)) from None

    def _act(self) -> AbstractContextManager[Pending]:
        """Enter the changes of the current tick, or those of a new tick for a single act."""
        return self._new_tick() if self._pending is None else nullcontext(self._pending)

    @contextmanager
    def _new_tick(self) -> Iterator[Pending]:
        pending = self._pending = Pending(self._facts)
        before = self._tick
        try:
            yield pending
            if self._facts.due or self._facts.plates:
                self._let_time_pass(pending)
            self._pending = None
            self._finish(pending)
        except BaseException:
            # A listener's error undoes the tick as well.
            self._undo(pending)
            self._tick = before
            raise
        finally:
            self._pending = None

    def _finish(self, pending: Pending) -> None:
        self._tick += 1
        facts = self._facts
        frame = Frame(
            self._tick,
            {name: facts.agents[name] for name in sorted(pending.agents)},
            dict(sorted(pending.blocks.items())),
            {
                place: dict(facts.containers[place]) if place in facts.containers else None
                for place in sorted(pending.containers)
            },
            {},
            tuple(pending.events),
        )
        for listener in tuple(self._listeners):
            listener(frame)


def _repeat_speech(world: ScriptedWorld, name: str, detail: Mapping[str, Any]) -> None:
    claims = claims_from_plain(detail.get("claims", ()))
    if detail.get("to") is None:
        world.say(name, detail["text"], claims)
    else:
        world.whisper(name, detail["to"], detail["text"], claims)


def _repeat_mining(world: ScriptedWorld, name: str, detail: Mapping[str, Any]) -> None:
    try:
        world.mine(name, detail["position"])
    except WorldError:
        # Who saw it need not know the tool that it takes; the block is gone all the same.
        world.set_block(detail["position"], "air", name)


def _repeat_placing(world: ScriptedWorld, name: str, detail: Mapping[str, Any]) -> None:
    item, _ = parse_state(detail["block"])
    # Who saw it need not know that the agent had it; the block is there all the same.
    with suppress(WorldError):
        world.put(name, item, detail["position"])
    world.set_block(detail["position"], detail["block"], name)


_REPEATED: Mapping[EventKind, Callable[[ScriptedWorld, str, Mapping[str, Any]], None]] = {
    EventKind.OPEN_CONTAINER: lambda w, name, d: w.open(name, d["position"]),
    EventKind.GET_ITEM_FROM_CHEST: lambda w, name, d: w.withdraw(name, d["position"], d["items"]),
    EventKind.DEPOSIT_ITEM_INTO_CHEST: lambda w, name, d: w.deposit(
        name, d["position"], d["items"]
    ),
    EventKind.USE_DOOR: lambda w, name, d: w.use_door(name, d["position"], open=d["open"]),
    EventKind.USE_LEVER: lambda w, name, d: w.use_lever(name, d["position"], powered=d["powered"]),
    EventKind.PRESS_BUTTON: lambda w, name, d: w.press_button(name, d["position"]),
    EventKind.MINE_BLOCK: _repeat_mining,
    EventKind.PLACE_BLOCK: _repeat_placing,
    EventKind.CHAT: _repeat_speech,
    EventKind.GIVE_ITEM_TO_OTHER: lambda w, name, d: w.give(name, d["other"], d["items"]),
}
"""Calls that do what an event of each kind tells."""
