"""A slow nest, written from the text of the semantics alone; the nest is checked against it.

Every node is computed at every tick, block by block, and nothing is shared or kept but the
states themselves. Only the line of sight, which has a reference of its own, is the
program's. Where the semantics leave something open, the choice made here is:

* A place that is seen (currently) to hold no container has no content, also when items
  were seen to go into it in the same tick.
* Content that is learned by looking in, and is stale in the parent simulator, stays stale.
* In transparent mode whatever content is known at a position that is seen is perceived.
* After an edit the nodes below the edited one perceive again, with no events.
* A tick in which nothing changed and nothing happened is no perception.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import Any

from msgspec.structs import replace
from tests.semantics.reference_rules import UNKNOWN, Node, Rules, known_block
from tests.semantics.reference_testimony import Ear, read
from tests.semantics.reference_unique import remove

import beliefnest as bn
from beliefnest.belief.grounds import AgentBelief, Basis, ContainerBelief, PerceivedEvent, Source
from beliefnest.world.claims import Claim, claims_from_plain, claims_of
from beliefnest.world.frames import Frame, Snapshot
from beliefnest.world.signs import text_of
from beliefnest.world.values import EventKind, Items, Position, Sign

Path = tuple[str, ...]


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


class Reference:
    """All nodes down to a depth, at the latest tick of every timeline (6).

    Args:
        start: The real world at its first tick.
        options: What agents can perceive.
        static_blocks: Names of blocks that everybody knows.
        initial_beliefs: Further priors.
        depth: Length of the longest paths.
        unique: Items of which there is one.
    """

    def __init__(
        self,
        start: Snapshot,
        options: bn.Perception,
        static_blocks: frozenset[str] = frozenset(),
        initial_beliefs: tuple[bn.InitialBelief, ...] = (),
        depth: int = 3,
        unique: frozenset[str] = frozenset(),
    ) -> None:
        self.rules = Rules(start, options, unique)
        self._static = static_blocks
        self._initial = initial_beliefs
        self._start = start
        reality = self._reality(start)
        read(reality, ((p, b) for p, b in reality.blocks.items() if b.text))
        root = Tree(reality, head=start.tick)
        self._grow(root, (), depth)
        self._trees: dict[Path, dict[str, Tree]] = {(): {"main": root}}
        self._selected: dict[Path, str] = {(): "main"}

    def frame(self, path: Path, frame: Frame) -> None:
        """Fold a frame of the simulator `path`, which is in control mode."""
        tree = self._trees[path][self._selected[path]]
        tree.head = frame.tick
        if not frame.is_empty:
            tree.node = self._acted(tree.node, frame)
            self._perceive_below(tree, happening=True)

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
        self,
        path: Path,
        blocks: Mapping[Position, int],
        contents: Mapping[Position, Items],
        signs: Mapping[Position, str],
    ) -> None:
        """Change a node by hand; the nodes below it perceive that (6)."""
        tree, control = self.tree(path), path in self._selected
        before, node = tree.node, tree.node.copy()
        node.news = node.events = ()
        basis = Basis(self.head(path), Source.EDITED)
        for place, state in blocks.items():
            node.blocks.pop(place, None)
            if state != UNKNOWN:
                node.blocks[place] = known_block(state, basis, control)
            name = self.rules.container_name(node.blocks.get(place))
            if name is None or name != self.rules.container_name(before.blocks.get(place)):
                node.drop(place)
            if name is not None and place not in node.containers:
                node.containers[place] = ContainerBelief({}, control, basis, control)
        for place, text in signs.items():
            node.blocks[place] = replace(
                node.blocks[place], text=text, claims=(), basis=basis, current=control
            )
        for place, items in contents.items():
            node.containers[place] = ContainerBelief(dict(items), True, basis, control)
            for item in () if control else self.rules.unique & items.keys():
                remove(node, item, basis, {("container", place)})
        node.tick = basis.observed_at
        tree.node = node
        self._perceive_below(tree, happening=False)

    def tree(self, path: Path) -> Tree:
        """Return the node of a normalised path, from the nearest simulator in control mode."""
        controlled = self._controlled(path)
        tree = self._trees[controlled][self._selected[controlled]]
        for name in path[len(controlled) :]:
            tree = tree.kids[name]
        return tree

    def head(self, path: Path) -> int:
        """Return the latest tick of the timeline that the node is on."""
        return self.tree(self._controlled(path)).head

    def _controlled(self, path: Path) -> Path:
        return max((path[:n] for n in range(len(path) + 1) if path[:n] in self._selected), key=len)

    def everything(self, path: Path) -> dict[str, Any]:
        """All that the node holds, in the form of `comparing.everything`."""
        node, now = self.tree(path).node, self.head(path)
        text = cache(self.rules.registry.text)  # a node has few states in many places
        blocks: dict[Position, Any] = dict.fromkeys(
            self._start.box.positions(), (None, False, None)
        )
        for place, block in node.blocks.items():
            blocks[place] = (text(block.state), block.current, seen_at(block, now).basis)
        said = {
            kind: tuple((e.tick, e.actor, e.detail["text"]) for e in node.log if e.kind is kind)
            for kind in (EventKind.CHAT, EventKind.THINK)
        }
        return {
            "blocks": blocks,
            "containers": {place: content_at(node, place, now) for place in node.containers},
            "agents": {name: seen_at(a, now) for name, a in node.agents.items()},
            "items": {},
            "events": tuple(e for e in node.log if e.kind not in said),
            "chat": said[EventKind.CHAT],
            "thoughts": said[EventKind.THINK],
            "addressees": tuple(e.detail.get("to") for e in node.log if e.kind is EventKind.CHAT),
            "signs": {
                place: block.text
                for place, block in node.blocks.items()
                if text(block.state).startswith("oak_sign")
            },
        }

    def _reality(self, start: Snapshot) -> Node:
        basis = Basis(start.tick, Source.SEEN)
        return Node(
            start.tick,
            {
                p: known_block(start.block(p), basis, True, self._claims(p))
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
            self._ear(),
            is_world=True,
        )

    def _claims(self, place: Position) -> tuple[Claim, ...]:
        return claims_from_plain(self._start.sign_claims.get(place, ()))

    def _ear(self) -> Ear:
        return Ear(self._start.tick, dict.fromkeys(self._start.agents, 0))

    @staticmethod
    def _real_blocks(start: Snapshot) -> dict[Position, int | Sign]:
        return {p: start.block(p) for p in start.box.positions()}

    def _grow(self, tree: Tree, path: Path, depth: int) -> None:
        """Give a node the nodes below it, each with priors and a first perception."""
        if len(path) == depth:
            return
        for name in tree.node.agents:
            if path[-1:] != (name,):
                below = (*path, name)
                before = self._prior(below)
                first = self.rules.perceive(tree.node, before, name, happening=False)
                tree.kids[name] = Tree(first)
                self._grow(tree.kids[name], below, depth)

    def _prior(self, path: Path) -> Node:
        start, registry = self._start, self.rules.registry
        basis = Basis(start.tick, Source.PRIOR)
        states = self._real_blocks(start)
        known = {
            p: told
            for p, told in states.items()
            if registry.name(known_block(told, basis, True).state) in self._static
        }
        nobody = {name: AgentBelief() for name in start.agents}
        node = Node(start.tick, {}, {}, nobody, self._ear(), path)
        special = self._special(path)
        known |= special.blocks
        node.blocks = {
            p: known_block(s, basis, False, () if p in special.blocks else self._claims(p))
            for p, s in known.items()
            if s != UNKNOWN
        }
        for place, block in node.blocks.items():
            if self.rules.container_name(block) is not None:
                node.containers[place] = ContainerBelief({}, False, basis, current=False)
        for place, (items, complete) in special.containers.items():
            node.containers[place] = ContainerBelief(dict(items), complete, basis, current=False)
        for name, feet in special.agents.items():
            node.agents[name] = AgentBelief(position=feet, basis=basis)
        for name, items in special.inventories.items():
            if name != path[-1]:
                node.agents[name] = replace(
                    node.agents.get(name, AgentBelief()), inventory=dict(items)
                )
        return node

    def _special(self, path: Path) -> bn.InitialBelief:
        """Return the initial beliefs about a node; the closest path counts (4)."""
        special = bn.InitialBelief(path)
        for pattern in (*((*path[:n], "**") for n in range(len(path) + 1)), path):
            for belief in self._initial:
                if belief.path == pattern:
                    special = bn.InitialBelief(
                        path,
                        {**special.containers, **belief.containers},
                        {**special.blocks, **belief.blocks},
                        {**special.agents, **belief.agents},
                        {**special.inventories, **belief.inventories},
                    )
        return special

    def _perceive_below(self, tree: Tree, *, happening: bool) -> None:
        for name, kid in tree.kids.items():
            kid.node = self.rules.perceive(tree.node, kid.node, name, happening=happening)
            self._perceive_below(kid, happening=happening)

    def _forked(self, node: Node) -> Node:
        """In control mode everything known is current (6)."""
        node.blocks = {p: replace(b, current=True) for p, b in node.blocks.items()}
        node.containers = {p: replace(c, current=True) for p, c in node.containers.items()}
        node.agents = {
            n: replace(a, current=a.position is not None) for n, a in node.agents.items()
        }
        node.news = node.events = ()
        node.is_world = True
        return node

    def _acted(self, before: Node, frame: Frame) -> Node:
        """Update a simulator in control mode by a frame of its own (6)."""
        basis = Basis(frame.tick, Source.SEEN)
        node = before.copy()
        node.tick = frame.tick
        node.news = node.events = frame.events
        node.log += [PerceivedEvent(frame.tick, e.kind, e.actor, e.detail) for e in frame.events]
        for place, state in frame.blocks.items():
            told = [e for e in frame.events if e.detail.get("position") == place]
            same = [e for e in told if e.detail.get("text", text_of(state)) == text_of(state)]
            claims = claims_of(same[-1]) if same and isinstance(state, Sign) else ()
            node.blocks[place] = known_block(state, basis, True, claims)
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
        read(node, ((p, b) for p, b in node.blocks.items() if b.text))
        node.blocks = {p: replace(b, basis=basis, current=True) for p, b in node.blocks.items()}
        node.containers = {
            p: replace(c, basis=basis, current=True) for p, c in node.containers.items()
        }
        node.agents = {
            n: a if a.position is None else replace(a, basis=basis, current=True)
            for n, a in node.agents.items()
        }
        return node


def seen_at(part: Any, now: int) -> Any:
    """Return a part of a state at a tick: current parts are observed then (2)."""
    return replace(part, basis=replace(part.basis, observed_at=now)) if part.current else part


def content_at(node: Node, place: Position, now: int) -> ContainerBelief:
    """Return a content at a tick: an act shows it in its tick alone, sight while it lasts."""
    content = node.containers[place]
    if node.is_world or place in node.into:
        return seen_at(content, now)
    return replace(content, current=content.current and content.basis.observed_at == now)


def paths_to(agents: tuple[str, ...], depth: int) -> Iterator[Path]:
    """All normalised paths up to a length, shorter ones first."""
    level: list[Path] = [()]
    while level and depth >= 0:
        yield from level
        level = [(*path, name) for path in level for name in agents if path[-1:] != (name,)]
        depth -= 1
