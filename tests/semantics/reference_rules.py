"""Perception and update written from the text of the semantics alone; slow, block by block."""

from dataclasses import dataclass, field
from math import dist
from typing import Any

import msgspec
import numpy as np
from msgspec.structs import replace
from tests.semantics.reference_testimony import Ear, Matter, hear, read
from tests.semantics.reference_unique import see_alone, see_moved

import beliefnest as bn
from beliefnest.belief.grounds import AgentBelief, Basis, ContainerBelief, PerceivedEvent, Source
from beliefnest.perception.sight import Sight
from beliefnest.world.claims import Claim
from beliefnest.world.double_chests import holds_items
from beliefnest.world.frames import Snapshot
from beliefnest.world.registry import Registry
from beliefnest.world.values import Event, EventKind, Items, Point, Position, Sign

MOVES = {EventKind.DEPOSIT_ITEM_INTO_CHEST: 1, EventKind.GET_ITEM_FROM_CHEST: -1}
HANDS = {
    EventKind.DEPOSIT_ITEM_INTO_CHEST: -1,
    EventKind.GET_ITEM_FROM_CHEST: 1,
    EventKind.GIVE_ITEM_TO_OTHER: -1,
    EventKind.RECEIVE_ITEM_FROM_OTHER: 1,
}
TOUCHES = (*MOVES, EventKind.OPEN_CONTAINER)
UNKNOWN = -1


class Block(msgspec.Struct, frozen=True):
    """A known block: state id, what it rests on, whether that is a perception of this tick.

    `text` is what is written on it, `claims` what that claims.
    """

    state: int
    basis: Basis
    current: bool
    text: str = ""
    claims: tuple[Claim, ...] = ()


def known_block(
    told: "int | Sign", basis: Basis, current: bool, claims: tuple[Claim, ...] = ()
) -> Block:
    """Return a block as facts tell it."""
    if isinstance(told, Sign):
        return Block(told.state, basis, current, told.text, claims)
    return Block(told, basis, current)


@dataclass
class Node:
    """The state of one simulator. A block that is not in `blocks` is unknown.

    `events` are all that happened on its timeline in this tick, `news` those that it perceived.
    `is_world` says that it is the simulator whose timeline it is. `into` are the transparent
    containers it sees into and whose content is current, `looked_into` those it looked into in this
    tick, `moved` items that it perceived to be put in or taken out in this tick, `found_now` where
    it perceived unique items in this tick.
    """

    tick: int
    blocks: dict[Position, Block]
    containers: dict[Position, ContainerBelief]
    agents: dict[str, AgentBelief]
    ear: Ear
    path: tuple[str, ...] = ()
    log: list[PerceivedEvent] = field(default_factory=list)
    news: tuple[Event, ...] = ()
    events: tuple[Event, ...] = ()
    is_world: bool = False
    into: frozenset[Position] = frozenset()
    looked_into: frozenset[Position] = frozenset()
    moved: frozenset[tuple[Position, str]] = frozenset()
    found_now: frozenset[tuple[str, Any]] = frozenset()
    read: frozenset[tuple[Position, str]] = frozenset()
    writers: dict[tuple[Position, str], str] = field(default_factory=dict)
    told: tuple[tuple[Position, Block, str | None], ...] = ()

    def drop(self, place: Position) -> None:
        """Hold nothing of a container any more, nor that something was perceived in it."""
        self.containers.pop(place, None)
        self.ear.forget(place)

    def copy(self) -> "Node":
        return Node(
            self.tick,
            dict(self.blocks),
            dict(self.containers),
            dict(self.agents),
            self.ear.copy(),
            self.path,
            list(self.log),
            self.news,
            self.events,
            self.is_world,
            self.into,
            self.looked_into,
            self.moved,
            self.found_now,
            self.read,
            dict(self.writers),
            self.told,
        )

    def perceives(self, place: Position | None, item: str) -> bool:
        """Return True if it was perceived in this tick that an item is in a container (8.0)."""
        content = self.containers.get(place)
        return (
            place in self.looked_into
            or (place, item) in self.moved
            or (
                content is not None
                and content.current
                and (content.complete or item in content.items)
            )
        )


class Rules:
    """Perception and update: semantics, sections 3 to 5."""

    def __init__(
        self, start: Snapshot, options: bn.Perception, unique: frozenset[str] = frozenset()
    ) -> None:
        self.unique = unique
        self.registry = Registry.load()
        self.box = start.box
        self.options = options
        self.sight = Sight(
            self.registry,
            options.max_visible_distance,
            options.field_of_view,
            options.transparent_blocks,
        )

    def container_name(self, block: Block | None) -> str | None:
        """Name of the container block; None if it is none, or unknown."""
        if block is None:
            return None
        name = self.registry.name(block.state)
        return name if holds_items(self.registry, block.state) else None

    def perceive(self, around: Node, before: Node, me: str, *, happening: bool) -> Node:
        """Return the belief of `me`, an agent in `around`, after the tick (4, 5, 8).

        If nothing is `happening`, it perceives anew between two ticks.
        """
        after = before.copy()
        after.tick, after.events = around.tick, around.events
        after.is_world, after.found_now = False, frozenset()
        last = around.tick - 1 if happening else around.tick
        after.ear.pass_to(last)
        self._age(after, last)
        after.into = after.looked_into = after.moved = frozenset()
        present = around.agents[me].position is not None and around.agents[me].current
        view = View(self, around, me) if present else None
        after.news = tuple(e for e in around.news if self._perceived(e, around, me, view))
        after.log += [PerceivedEvent(around.tick, e.kind, e.actor, e.detail) for e in after.news]
        if view is not None:
            for item in self.unique:
                see_moved(after, item)
            self._see_blocks(after, around, view)
            self._see_agents(after, before, around, me, view)
            self._see_contents(after, before, around, me, view)
        # An agent knows what it has.
        own = around.agents[me].inventory
        after.agents[me] = replace(after.agents[me], inventory=own)
        if view is not None:
            for item in self.unique:
                see_alone(after, around, me, view.agents, item)
        if self.options.testimony == "informed":
            self._attend(after, me, view)
        signs = around.blocks.items() if view is not None else ()
        read(after, ((p, b) for p, b in signs if b.text and view is not None and view.sees(p)))
        hear(self, after, around, me, view)
        return after

    def _attend(self, after: Node, me: str, view: "View | None") -> None:
        """Update the facts by which claims of this tick and later ones are weighed (8)."""
        seen: set[Matter] = set()
        acts: set[Matter] = set()
        if view is not None:
            for name in view.agents:
                position = after.agents[name].position
                assert position is not None
                after.ear.met[name] = position
            for name, place in list(after.ear.met.items()):
                if name not in view.agents and view.would_see(place):
                    del after.ear.met[name]
            seen |= {("agent", name) for name in view.agents}
            seen |= {("cell", place) for place in self.box.positions() if view.sees(place)}
            acts |= {
                ("cell", event.detail["position"])
                for event in after.news
                if event.actor is not None and "position" in event.detail
            }
        missing = {name for name, agent in after.agents.items() if not agent.current}
        after.ear.perceive(missing, seen, acts, after.tick)

    def _age(self, node: Node, last: int) -> None:
        """Nothing is current that is not perceived anew (4); what was, was until `last` (2)."""
        for place, content in node.containers.items():
            if content.current:
                # An act shows a content in its tick alone.
                until = last if place in node.into else content.basis.observed_at
                node.containers[place] = aged(content, until)
        for parts in (node.blocks, node.agents):
            parts.update({key: aged(part, last) for key, part in parts.items() if part.current})

    def _perceived(self, event: Event, around: Node, me: str, view: "View | None") -> bool:
        """Return True if an event of `around` is perceived (3, 5.2, 5.5)."""
        if "to" in event.detail:
            return me in (event.actor, event.detail["to"])
        if event.kind is EventKind.CHAT and (self.options.hearing == "global" or event.actor == me):
            return True
        if view is None or event.kind is EventKind.THINK:
            return view is not None and event.actor == me
        if event.kind is EventKind.CHAT and isinstance(self.options.hearing, bn.Radius):
            speaker, listener = around.agents[event.actor or ""], around.agents[me]
            return (
                speaker.position is not None
                and dist(speaker.position, listener.position) <= self.options.hearing.blocks
            )
        if event.kind is EventKind.BLOCK_UPDATE and event.actor != me:
            return view.sees(event.detail["position"])
        return event.actor in view.agents

    def _see_blocks(self, after: Node, around: Node, view: "View") -> None:
        """Replace beliefs by percepts; unknown blocks are not handed on (4, 5.4)."""
        for position, block in around.blocks.items():
            if view.sees(position):
                seen = Basis(around.tick, Source.SEEN) if around.is_world else block.basis
                after.blocks[position] = replace(block, basis=seen)

    def _see_agents(self, after: Node, before: Node, around: Node, me: str, view: "View") -> None:
        """Poses, possessions, and places seen empty (4)."""
        for name, old in after.agents.items():
            there = around.agents[name]
            if name == me:
                after.agents[name] = there
                continue
            new = old
            if name in view.agents:
                worn = old.equipment if there.equipment is None else there.equipment
                new = replace(
                    old,
                    position=there.position,
                    yaw=there.yaw,
                    pitch=there.pitch,
                    on_ground=there.on_ground,
                    equipment=worn,
                    basis=there.basis,
                    current=there.current,
                )
            elif (
                self.options.negative_evidence
                and before.agents[name].position is not None
                and view.would_see(before.agents[name].position)
            ):
                new = replace(old, position=None, yaw=0.0, pitch=0.0, on_ground=True, basis=None)
            for event in after.news:
                if event.actor == name and event.kind in HANDS:
                    held = changed(new.inventory, event.detail["items"], HANDS[event.kind])
                    new = replace(new, inventory=held)
            after.agents[name] = new

    def _see_contents(self, after: Node, before: Node, around: Node, me: str, view: "View") -> None:
        """Containers found and forgotten, items seen to move, contents looked into (4)."""
        self._find_and_forget(after, before, around, view)
        own = [e for e in after.news if e.kind in TOUCHES and e.actor == me]
        touched = [e.detail["position"] for e in own if e.detail["position"] in around.containers]
        looked_into = set(touched)
        seen_into: set[Position] = set()
        if self.options.containers == "transparent":
            seen_into = {place for place in around.containers if view.sees(place)}
            looked_into |= seen_into
            for place in sorted(seen_into):
                after.ear.look_into(place, around.containers[place].items)
        for event in after.news:
            if event.kind not in MOVES or event.detail["position"] in looked_into:
                continue
            place = event.detail["position"]
            if not self.is_gone(place, around, view):
                old = after.containers.get(place)
                known = {} if old is None else old.items
                after.containers[place] = ContainerBelief(
                    changed(known, event.detail["items"], MOVES[event.kind]),
                    complete=old is not None and old.complete,
                    basis=Basis(around.tick, Source.WITNESSED, event.kind),
                    current=True,
                )
                after.ear.put(place, event.detail["items"], MOVES[event.kind])
                after.moved |= {(place, item) for item in event.detail["items"]}
        for place in looked_into:
            after.containers[place] = around.containers[place]
            if around.is_world:
                seen = Basis(around.tick, Source.SEEN)
                after.containers[place] = replace(after.containers[place], basis=seen)
            old = before.containers.get(place)
            if place in before.into and place in seen_into and old is not None:
                new = after.containers[place]
                if (old.items, old.complete, True) == (new.items, new.complete, new.current):
                    # One perception goes on.
                    after.containers[place] = replace(new, basis=old.basis)
            acts = [e.kind for e in own if e.detail["position"] == place]
            if acts and after.containers[place].current:
                basis = Basis(around.tick, Source.WITNESSED, acts[-1])
                after.containers[place] = replace(after.containers[place], basis=basis)
        for place in touched:
            after.ear.look_into(place, around.containers[place].items)
        after.looked_into = frozenset(looked_into)
        after.into = frozenset(p for p in seen_into if around.containers[p].current)

    def _find_and_forget(self, after: Node, before: Node, around: Node, view: "View") -> None:
        for place in around.blocks:
            if not view.sees(place):
                continue
            old, new = before.blocks.get(place), after.blocks[place]
            name = self.container_name(new)
            is_replaced = old is not None and old.state != new.state
            if is_replaced and (name is None or name != self.container_name(old)):
                after.drop(place)
            if name is None and (old is None or self.is_gone(place, around, view)):
                after.drop(place)
            is_news = old is None or old.state != new.state
            if name is not None and is_news and place not in after.containers:
                after.containers[place] = ContainerBelief({}, False, new.basis, current=False)

    def is_gone(self, place: Position, around: Node, view: "View") -> bool:
        """Return True if a perception of this tick shows that the place holds no container."""
        block = around.blocks.get(place)
        return (
            block is not None
            and block.current
            and view.sees(place)
            and self.container_name(block) is None
        )


class View:
    """Sight of an agent that is present in a simulator (3, 5.3)."""

    def __init__(self, rules: Rules, around: Node, me: str) -> None:
        self._box = rules.box
        agent = around.agents[me]
        assert agent.position is not None
        x, y, z = agent.position
        self._looking = ((x, y + 1.62, z), agent.yaw, agent.pitch)
        grid = np.full(self._box.shape, UNKNOWN, dtype=np.int32)
        for position, block in around.blocks.items():
            grid[self._box.index(position)] = block.state
        self._geometry = rules.sight.geometry(grid, self._box.low)
        self._visible = self._geometry.visible_blocks(*self._looking)
        self.agents = {me} | {
            name
            for name, other in around.agents.items()
            if name != me and other.position is not None and self.would_see(other.position)
        }

    def sees(self, position: Position) -> bool:
        """Return True if sight reaches the position."""
        return bool(self._visible[self._box.index(position)])

    def would_see(self, feet: Point) -> bool:
        """Return True if an agent that stood there would be seen."""
        return bool(self._geometry.sees_agents(*self._looking, [feet])[0])


def aged(part: Any, last: int) -> Any:
    """Return a part of a state that was current until a tick."""
    return replace(part, basis=replace(part.basis, observed_at=last), current=False)


def changed(items: Items, change: Items, sign: int) -> dict[str, int]:
    """Items with others added or taken away, none below 0."""
    counts = {name: items.get(name, 0) + sign * change.get(name, 0) for name in {*items, *change}}
    return {name: count for name, count in counts.items() if count > 0}
