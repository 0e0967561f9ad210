"""Overlay of the alternatives of a doubt on the state of a node, entry by entry.

An edit holds until the node perceives a change of its element: a block changes, items are seen
going in or out, an agent moves in sight. The element is then the same in all alternatives.
"""

import hashlib
import math
from collections.abc import Callable, Mapping, Sequence

import msgspec

from beliefnest.belief.grounds import AgentBelief, ContainerBelief, PerceivedEvent
from beliefnest.belief.holdings import changed_items
from beliefnest.belief.node_view import NodeView
from beliefnest.errors import InputError
from beliefnest.minds.alternatives import AgentPose, AlternativeWorld
from beliefnest.minds.mind_model import Alternative
from beliefnest.world.claims import Claim, ClaimKind
from beliefnest.world.registry import Registry, parse_state
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import Box, Items, Point, Position, block_at

_NEAR = 0.5
"""Distance from which two places count as different, in blocks."""


class _Held(msgspec.Struct, frozen=True):
    """Doubted elements in the state of the node."""

    blocks: Mapping[Position, int]
    contents: Mapping[Position, ContainerBelief | None]
    poses: Mapping[str, tuple[AgentPose | None, bool]]


class Overlay:
    """Doubted elements in each alternative, at one entry of a timeline.

    Args:
        alternatives: The alternatives.
        registry: Names and shapes of blocks.
        box: The part of space.
        agents: Names of all agents.
        agent: The modelled agent.
        whole: Function that returns the position of the container to which a block belongs.

    Raises:
        InputError: An alternative moves the modelled agent, or an unknown one.
        PositionError: A place lies outside the box.
    """

    def __init__(
        self,
        alternatives: Sequence[Alternative],
        registry: Registry,
        box: Box,
        agents: Sequence[str],
        agent: str,
        whole: Callable[[Position], Position],
    ) -> None:
        self._registry, self._box, self._agent = registry, box, agent
        self._names = [each.name for each in alternatives]
        first = alternatives[0]
        for place in (*first.blocks, *first.containers):
            box.check(place)
        for name in first.agents:
            if name not in agents or name == agent:
                raise InputError(
                    f"the doubt is about the place of {name!r}; name another agent than the "
                    f"modelled one, of {', '.join(agents)}"
                )
        self._texts = {at: [each.blocks[at] for each in alternatives] for at in first.blocks}
        self._blocks: dict[Position, list[int]] = {
            at: [registry.state_id(text) for text in texts] for at, texts in self._texts.items()
        }
        self._contents: dict[Position, list[Items]] = {
            whole(at): [each.containers[at] for each in alternatives] for at in first.containers
        }
        self._feet: dict[str, list[Point]] = {
            name: [each.agents[name] for each in alternatives] for name in first.agents
        }
        self._held: _Held | None = None
        self._claimed = tuple(self._contents)

    @property
    def containers(self) -> tuple[Position, ...]:
        """Containers whose contents are in doubt."""
        return self._claimed

    def content_masks(self, place: Position) -> tuple[int, ...]:
        """Return, for each alternative, the set of those with equal contents of a container."""
        contents = self._contents[place]
        return tuple(
            sum(1 << b for b, other in enumerate(contents) if other == mine) for mine in contents
        )

    def truth(self, claim: Claim) -> int:
        """Return the alternatives in which a claim is true; -1: it is about no doubted element."""
        place = claim.cell
        if claim.kind in (ClaimKind.LOCATED, ClaimKind.ABSENT):
            if place not in self._contents:
                return -1
            wanted = claim.kind is ClaimKind.LOCATED
            true = [(claim.item in items) is wanted for items in self._contents[place]]
        elif claim.kind is ClaimKind.POSITION:
            if claim.agent not in self._feet:
                return -1
            true = [block_at(feet) == place for feet in self._feet[claim.agent]]
        else:
            if place not in self._blocks:
                return -1
            true = [self._is(str(claim.state), state) for state in self._blocks[place]]
        return sum(1 << a for a, is_true in enumerate(true) if is_true)

    def follow(self, view: NodeView, events: Sequence[PerceivedEvent]) -> None:
        """Apply the changes that the node has perceived since the last call."""
        now = self._read(view)
        before = self._held
        self._held = now
        if before is None:
            return
        for place, state in now.blocks.items():
            if before.blocks[place] not in (-1, state):
                self._blocks[place] = [state] * len(self._names)
        moved: set[Position] = set()
        for event in events:
            sign = event.kind.traits.stores
            if not sign:
                continue
            spot = event.detail.get("position")
            if spot in self._contents:
                moved.add(spot)
                items = event.detail.get("items", {})
                self._contents[spot] = [
                    changed_items(each, items, sign) for each in self._contents[spot]
                ]
        for place, content in now.contents.items():
            old = before.contents[place]
            if place in moved or content is None or old is None:
                continue
            if old.complete and content.complete and dict(old.items) != dict(content.items):
                self._contents[place] = [dict(content.items)] * len(self._names)
        for name, (pose, is_current) in now.poses.items():
            pose_before, was_current = before.poses[name]
            if pose is not None and is_current and was_current and pose != pose_before:
                self._feet.pop(name, None)

    def agreeing(self) -> int:
        """Return the alternatives that agree with the node."""
        assert self._held is not None
        agrees = [True] * len(self._names)
        for place, state in self._held.blocks.items():
            if state >= 0:
                for a, mine in enumerate(self._blocks[place]):
                    agrees[a] &= mine == state or self._is(self._texts[place][a], state)
        for place, content in self._held.contents.items():
            if content is not None:
                for a, items in enumerate(self._contents[place]):
                    agrees[a] &= _fits(items, content)
        for name, (pose, _) in self._held.poses.items():
            if pose is not None and name in self._feet:
                for a, feet in enumerate(self._feet[name]):
                    agrees[a] &= math.dist(feet, pose[0]) < _NEAR
        return sum(1 << a for a, does in enumerate(agrees) if does)

    def worlds(self, view: NodeView) -> list[AlternativeWorld]:
        """Return the state of the node with the edits of each alternative."""
        count = len(self._names)
        contents: dict[Position, Items] = {
            place: dict(content.items)
            for place, content in view.containers.items()
            if content.items or content.complete
        }
        poses: dict[str, AgentPose] = {
            name: (agent.position, agent.yaw, agent.pitch)
            for name, agent in view.agents.items()
            if agent.position is not None and name != self._agent
        }
        made: dict[tuple[int, ...], Terrain] = {}
        worlds = []
        for a in range(count):
            key = tuple(states[a] for states in self._blocks.values())
            if key not in made:
                draft = view.terrain.draft()
                for place, state in zip(self._blocks, key, strict=True):
                    draft[self._box.index(place)] = state
                made[key] = draft.terrain()
            mine = {place: items[a] for place, items in self._contents.items()}
            feet = {name: (places[a], 0.0, 0.0) for name, places in self._feet.items()}
            worlds.append(AlternativeWorld(made[key], {**contents, **mine}, {**poses, **feet}))
        return worlds

    def digest(self, view: NodeView) -> bytes:
        """Return a digest of everything on which `worlds` and the node's items depend."""
        digest = hashlib.blake2b(view.terrain.key)
        parts = (
            self._box,
            list(self._blocks.items()),
            [(at, [sorted(i.items()) for i in items]) for at, items in self._contents.items()],
            list(self._feet.items()),
            [
                (at, sorted(content.items.items()), content.complete)
                for at, content in view.containers.items()
            ],
            [
                (name, agent.position, agent.yaw, agent.pitch)
                for name, agent in view.agents.items()
                if name != self._agent
            ],
            [(item.name, item.position) for item in view.items.values()],
        )
        digest.update(repr(parts).encode())
        return digest.digest()

    def _read(self, view: NodeView) -> _Held:
        agents = view.agents
        return _Held(
            {place: view.terrain[self._box.index(place)] for place in self._blocks},
            {place: view.containers.get(place) for place in self._contents},
            {name: (pose_of(agents[name]), agents[name].current) for name in self._feet},
        )

    def _is(self, text: str, state: int) -> bool:
        """Return True if a state has the name and the properties of a text."""
        if state < 0:
            return False
        name, chosen = parse_state(text)
        if self._registry.name(state) != name:
            return False
        properties = self._registry.properties(state)
        return all(properties.get(key) == value for key, value in chosen.items())


def _fits(items: Items, content: ContainerBelief) -> bool:
    if content.complete:
        return dict(items) == dict(content.items)
    return all(items.get(name, 0) >= count for name, count in content.items.items())


def pose_of(agent: AgentBelief) -> AgentPose | None:
    """Return the believed pose of an agent; None: its place is unknown."""
    return None if agent.position is None else (agent.position, agent.yaw, agent.pitch)
