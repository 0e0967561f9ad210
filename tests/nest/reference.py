"""A slow nest, written from the text of the semantics alone; the nest is checked against it.

Every node is computed at every tick, block by block, and nothing is shared or kept but the
states themselves. Only the line of sight, which has a reference of its own, is the
program's. Where the semantics leave something open, the choice made here is:

* A place that is seen (currently) to hold no container has no content, also when items
  were seen to go into it in the same tick.
* Content that is learned by looking in, and is stale in the simulator around, stays stale.
* In transparent mode whatever content is known at a position that is seen is perceived.
* After an edit the nodes below the edited one perceive again, with no events.
* A tick in which nothing changed and nothing happened is no perception.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from math import dist
from typing import Any

import numpy as np

import beliefnest as bn
from beliefnest.belief.entries import AgentBelief, Basis, ContainerBelief, PerceivedEvent, Source
from beliefnest.perception.sight import Sight
from beliefnest.world.frames import Frame, Snapshot
from beliefnest.world.registry import Registry
from beliefnest.world.values import Event, EventKind, Items, Point, Position

MOVES = {EventKind.DEPOSIT_ITEM_INTO_CHEST: 1, EventKind.GET_ITEM_FROM_CHEST: -1}
HANDS = {
    EventKind.DEPOSIT_ITEM_INTO_CHEST: -1,
    EventKind.GET_ITEM_FROM_CHEST: 1,
    EventKind.GIVE_ITEM_TO_OTHER: -1,
    EventKind.RECEIVE_ITEM_FROM_OTHER: 1,
}
TOUCHES = (*MOVES, EventKind.OPEN_CONTAINER)
UNKNOWN = -1

Path = tuple[str, ...]


@dataclass(frozen=True)
class Block:
    """A known block: state id, what it rests on, whether that is a perception of this tick."""

    state: int
    basis: Basis
    current: bool


@dataclass
class Node:
    """The state of one simulator. A block that is not in `blocks` is unknown."""

    tick: int
    blocks: dict[Position, Block]
    containers: dict[Position, ContainerBelief]
    agents: dict[str, AgentBelief]
    log: list[PerceivedEvent] = field(default_factory=list)
    news: tuple[Event, ...] = ()

    def copy(self) -> "Node":
        return Node(
            self.tick,
            dict(self.blocks),
            dict(self.containers),
            dict(self.agents),
            list(self.log),
            self.news,
        )


@dataclass
class Tree:
    """A simulator and the nodes below it that follow it.

    `head` is the latest tick, quiet ones included, where the simulator is in control mode.
    """

    node: Node
    kids: dict[str, "Tree"] = field(default_factory=dict)
    head: int = 0

    def copy(self) -> "Tree":
        kids = {name: kid.copy() for name, kid in self.kids.items()}
        return Tree(self.node.copy(), kids, self.head)


class Rules:
    """Perception and update: sections 3 to 5 of the semantics."""

    def __init__(self, start: Snapshot, options: bn.Perception) -> None:
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
        return name if self.registry.is_container(name) else None

    def perceive(self, around: Node, before: Node, me: str) -> Node:
        """The belief of `me`, who lives in `around`, after the tick (4, 5)."""
        after = before.copy()
        after.tick = around.tick
        self._age(after)
        present = around.agents[me].position is not None and around.agents[me].current
        view = View(self, around, me) if present else None
        after.news = tuple(e for e in around.news if self._perceived(e, around, me, view))
        after.log += [PerceivedEvent(around.tick, e.kind, e.actor, e.detail) for e in after.news]
        if view is not None:
            self._see_blocks(after, around, view)
            self._see_agents(after, before, around, me, view)
            self._see_contents(after, before, around, me, view)
        return after

    def _age(self, node: Node) -> None:
        """Nothing is current that is not perceived anew (4)."""
        node.blocks = {p: replace(b, current=False) for p, b in node.blocks.items()}
        node.containers = {p: replace(c, current=False) for p, c in node.containers.items()}
        node.agents = {n: replace(a, current=False) for n, a in node.agents.items()}

    def _perceived(self, event: Event, around: Node, me: str, view: "View | None") -> bool:
        """Whether an event of `around` is perceived (3, 5.2, 5.5)."""
        if event.kind is EventKind.CHAT and self.options.hearing == "global":
            return True
        if view is None:
            return False
        if event.actor == me:
            return True
        if event.kind is EventKind.THINK:
            return False
        if event.kind is EventKind.BLOCK_UPDATE:
            return view.sees(event.detail["position"])
        if event.kind is EventKind.CHAT and isinstance(self.options.hearing, bn.Radius):
            speaker, listener = around.agents[event.actor or ""], around.agents[me]
            return (
                speaker.position is not None
                and dist(speaker.position, listener.position) <= self.options.hearing.blocks
            )
        return event.actor in view.agents

    def _see_blocks(self, after: Node, around: Node, view: "View") -> None:
        """What is seen replaces what was believed; unknown blocks are not handed on (4, 5.4)."""
        for position, block in around.blocks.items():
            if view.sees(position):
                after.blocks[position] = block

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
        looked_into = {e.detail["position"] for e in own} & around.containers.keys()
        if self.options.containers == "transparent":
            looked_into |= {place for place in around.containers if view.sees(place)}
        for event in after.news:
            if event.kind not in MOVES or event.detail["position"] in looked_into:
                continue
            place = event.detail["position"]
            if not self._is_gone(place, around, view):
                old = after.containers.get(place)
                known = {} if old is None else old.items
                after.containers[place] = ContainerBelief(
                    changed(known, event.detail["items"], MOVES[event.kind]),
                    complete=old is not None and old.complete,
                    basis=Basis(around.tick, Source.WITNESSED, event.kind),
                    current=True,
                )
        for place in looked_into:
            after.containers[place] = around.containers[place]
            acts = [e.kind for e in own if e.detail["position"] == place]
            if acts and after.containers[place].current:
                basis = Basis(around.tick, Source.WITNESSED, acts[-1])
                after.containers[place] = replace(after.containers[place], basis=basis)

    def _find_and_forget(self, after: Node, before: Node, around: Node, view: "View") -> None:
        for place in around.blocks:
            if not view.sees(place):
                continue
            old, new = before.blocks.get(place), after.blocks[place]
            name = self.container_name(new)
            is_replaced = old is not None and old.state != new.state
            if is_replaced and (name is None or name != self.container_name(old)):
                after.containers.pop(place, None)
            if name is None and (old is None or self._is_gone(place, around, view)):
                after.containers.pop(place, None)
            is_news = old is None or old.state != new.state
            if name is not None and is_news and place not in after.containers:
                after.containers[place] = ContainerBelief({}, False, new.basis, current=False)

    def _is_gone(self, place: Position, around: Node, view: "View") -> bool:
        """Whether the place is seen to hold no container, by a perception of this tick."""
        block = around.blocks.get(place)
        return (
            block is not None
            and block.current
            and view.sees(place)
            and self.container_name(block) is None
        )


class View:
    """What an agent who is present in a simulator sees of it (3, 5.3)."""

    def __init__(self, rules: Rules, around: Node, me: str) -> None:
        self._box = rules.box
        self._sight = rules.sight
        agent = around.agents[me]
        assert agent.position is not None
        x, y, z = agent.position
        self._looking = ((x, y + 1.62, z), agent.yaw, agent.pitch)
        self._grid = np.full(self._box.shape, UNKNOWN, dtype=np.int32)
        for position, block in around.blocks.items():
            self._grid[self._box.index(position)] = block.state
        self._visible = self._sight.visible_blocks(self._grid, self._box.low, *self._looking)
        self.agents = {me} | {
            name
            for name, other in around.agents.items()
            if name != me and other.position is not None and self.would_see(other.position)
        }

    def sees(self, position: Position) -> bool:
        """Whether sight reaches the position."""
        return bool(self._visible[self._box.index(position)])

    def would_see(self, feet: Point) -> bool:
        """Whether an agent that stood there would be seen."""
        return bool(self._sight.sees_agents(self._grid, self._box.low, *self._looking, [feet])[0])


class Reference:
    """All nodes down to a depth, at the latest tick of every timeline (6).

    Args:
        start: The real world at its first tick.
        options: What agents can perceive.
        static_blocks: Names of blocks that everybody knows.
        initial_beliefs: Further priors.
        depth: Length of the longest paths.
    """

    def __init__(
        self,
        start: Snapshot,
        options: bn.Perception,
        static_blocks: frozenset[str] = frozenset(),
        initial_beliefs: tuple[bn.InitialBelief, ...] = (),
        depth: int = 3,
    ) -> None:
        self.rules = Rules(start, options)
        self._static = static_blocks
        self._initial = {belief.path: belief for belief in initial_beliefs}
        self._start = start
        root = Tree(self._reality(start), head=start.tick)
        self._grow(root, (), depth)
        self._trees: dict[Path, dict[str, Tree]] = {(): {"main": root}}
        self._selected: dict[Path, str] = {(): "main"}

    def frame(self, path: Path, frame: Frame) -> None:
        """Fold a frame of the simulator `path`, which is in control mode."""
        tree = self._trees[path][self._selected[path]]
        tree.head = frame.tick
        if not frame.is_empty:
            tree.node = self._acted(tree.node, frame)
            self._perceive_below(tree)

    def switch(self, path: Path, branch: str) -> None:
        """Fork, restore or follow."""
        if branch == "follow":
            self._selected.pop(path, None)
            return
        if branch not in self._trees.setdefault(path, {}):
            tree = self.tree(path).copy()
            tree.node, tree.head = self._forked(tree.node), self.head(path)
            self._trees[path][branch] = tree
        self._selected[path] = branch

    def edit(
        self, path: Path, blocks: Mapping[Position, int], contents: Mapping[Position, Items]
    ) -> None:
        """Change a node by hand; the nodes below it perceive that (6)."""
        tree, control = self.tree(path), path in self._selected
        before, node = tree.node, tree.node.copy()
        node.news = ()
        basis = Basis(self.head(path), Source.EDITED)
        for place, state in blocks.items():
            node.blocks.pop(place, None)
            if state != UNKNOWN:
                node.blocks[place] = Block(state, basis, control)
            name = self.rules.container_name(node.blocks.get(place))
            if name is None or name != self.rules.container_name(before.blocks.get(place)):
                node.containers.pop(place, None)
            if name is not None and place not in node.containers:
                node.containers[place] = ContainerBelief({}, control, basis, control)
        for place, items in contents.items():
            node.containers[place] = ContainerBelief(dict(items), True, basis, control)
        node.tick = basis.observed_at
        tree.node = node
        self._perceive_below(tree)

    def tree(self, path: Path) -> Tree:
        """The node of a normalised path, from the nearest simulator in control mode."""
        controlled = self._controlled(path)
        tree = self._trees[controlled][self._selected[controlled]]
        for name in path[len(controlled) :]:
            tree = tree.kids[name]
        return tree

    def head(self, path: Path) -> int:
        """The latest tick of the timeline that the node is on."""
        return self.tree(self._controlled(path)).head

    def _controlled(self, path: Path) -> Path:
        return max((path[:n] for n in range(len(path) + 1) if path[:n] in self._selected), key=len)

    def everything(self, path: Path) -> dict[str, Any]:
        """All that the node holds, in the form of `comparing.everything`."""
        node = self.tree(path).node
        text = self.rules.registry.text
        blocks: dict[Position, Any] = dict.fromkeys(
            self._start.box.positions(), (None, False, None)
        )
        for place, block in node.blocks.items():
            blocks[place] = (text(block.state), block.current, block.basis)
        said = {
            kind: tuple((e.tick, e.actor, e.detail["text"]) for e in node.log if e.kind is kind)
            for kind in (EventKind.CHAT, EventKind.THINK)
        }
        return {
            "blocks": blocks,
            "containers": node.containers,
            "agents": node.agents,
            "items": {},
            "events": tuple(e for e in node.log if e.kind not in said),
            "chat": said[EventKind.CHAT],
            "thoughts": said[EventKind.THINK],
        }

    def _reality(self, start: Snapshot) -> Node:
        basis = Basis(start.tick, Source.SEEN)
        return Node(
            start.tick,
            {
                p: Block(int(start.blocks[start.box.index(p)]), basis, True)
                for p in start.box.positions()
            },
            {p: ContainerBelief(dict(i), True, basis, True) for p, i in start.containers.items()},
            {
                name: AgentBelief(
                    fact.position,
                    fact.yaw,
                    fact.pitch,
                    fact.on_ground,
                    dict(fact.equipment),
                    dict(fact.inventory),
                    True,
                    fact.health,
                    fact.food,
                    basis,
                    True,
                )
                for name, fact in start.agents.items()
            },
        )

    def _grow(self, tree: Tree, path: Path, depth: int) -> None:
        """Give a node the nodes below it, each with priors and a first perception."""
        if len(path) == depth:
            return
        for name in tree.node.agents:
            if path[-1:] != (name,):
                below = (*path, name)
                first = self.rules.perceive(tree.node, self._prior(below), name)
                tree.kids[name] = Tree(first)
                self._grow(tree.kids[name], below, depth)

    def _prior(self, path: Path) -> Node:
        start, registry = self._start, self.rules.registry
        basis = Basis(start.tick, Source.PRIOR)
        states = {p: int(start.blocks[start.box.index(p)]) for p in start.box.positions()}
        known = {p: s for p, s in states.items() if registry.name(s) in self._static}
        node = Node(start.tick, {}, {}, {name: AgentBelief() for name in start.agents})
        special = self._initial.get(path, bn.InitialBelief(path))
        known |= special.blocks
        node.blocks = {p: Block(s, basis, False) for p, s in known.items() if s != UNKNOWN}
        for place, block in node.blocks.items():
            if self.rules.container_name(block) is not None:
                node.containers[place] = ContainerBelief({}, False, basis, current=False)
        for place, (items, complete) in special.containers.items():
            node.containers[place] = ContainerBelief(dict(items), complete, basis, current=False)
        for name, feet in special.agents.items():
            node.agents[name] = AgentBelief(position=feet, basis=basis)
        return node

    def _perceive_below(self, tree: Tree) -> None:
        for name, kid in tree.kids.items():
            kid.node = self.rules.perceive(tree.node, kid.node, name)
            self._perceive_below(kid)

    def _forked(self, node: Node) -> Node:
        """In control mode everything known is current (6)."""
        node.blocks = {p: replace(b, current=True) for p, b in node.blocks.items()}
        node.containers = {p: replace(c, current=True) for p, c in node.containers.items()}
        node.agents = {
            n: replace(a, current=a.position is not None) for n, a in node.agents.items()
        }
        node.news = ()
        return node

    def _acted(self, before: Node, frame: Frame) -> Node:
        """A simulator in control mode after a frame of its own (6)."""
        basis = Basis(frame.tick, Source.SEEN)
        node = before.copy()
        node.tick, node.news = frame.tick, frame.events
        node.log += [PerceivedEvent(frame.tick, e.kind, e.actor, e.detail) for e in frame.events]
        for place, state in frame.blocks.items():
            node.blocks[place] = Block(state, basis, True)
        for place, items in frame.containers.items():
            old = node.containers.pop(place, None)
            if items is not None:
                complete = old is None or old.complete
                node.containers[place] = ContainerBelief(dict(items), complete, basis, True)
        for name, fact in frame.agents.items():
            assert fact is not None
            node.agents[name] = replace(
                node.agents[name],
                position=fact.position,
                yaw=fact.yaw,
                pitch=fact.pitch,
                on_ground=fact.on_ground,
                equipment=dict(fact.equipment),
                inventory=dict(fact.inventory),
                health=fact.health,
                food=fact.food,
            )
        node.blocks = {p: replace(b, basis=basis, current=True) for p, b in node.blocks.items()}
        node.containers = {
            p: replace(c, basis=basis, current=True) for p, c in node.containers.items()
        }
        node.agents = {
            n: a if a.position is None else replace(a, basis=basis, current=True)
            for n, a in node.agents.items()
        }
        return node


def changed(items: Items, change: Items, sign: int) -> dict[str, int]:
    """Items with others added or taken away, none below 0."""
    counts = {name: items.get(name, 0) + sign * change.get(name, 0) for name in {*items, *change}}
    return {name: count for name, count in counts.items() if count > 0}


def paths_to(agents: tuple[str, ...], depth: int) -> Iterator[Path]:
    """All normalised paths up to a length, shorter ones first."""
    level: list[Path] = [()]
    while level and depth >= 0:
        yield from level
        level = [(*path, name) for path in level for name in agents if path[-1:] != (name,)]
        depth -= 1
