"""Course of an agent as an observer perceived it, read from one node and its timeline.

The alternatives of a doubt are edits over the state of the node. An edit holds until the node
perceives a change of its element: a block changes, items are seen going in or out, an agent moves
in sight. The element is then the same in all alternatives.
"""

import hashlib
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import msgspec
from msgspec.structs import replace

from beliefnest.belief.forest import Forest
from beliefnest.belief.grounds import AgentBelief, ContainerBelief, PerceivedEvent
from beliefnest.belief.holdings import changed_items
from beliefnest.belief.node_view import NodeView
from beliefnest.errors import InputError, PathError
from beliefnest.minds.alternatives import AgentPose, AlternativeWorld, AlternativeWorlds
from beliefnest.minds.evidence import EvidenceMoment
from beliefnest.minds.mind_model import Alternative, PossibleGoal
from beliefnest.minds.surroundings import Surroundings
from beliefnest.nest.past.recording import Recording
from beliefnest.timeline.journal import Edit, Entry, TimelineKey
from beliefnest.world.claims import Claim, ClaimKind, claims_of
from beliefnest.world.event_kinds import AT_CONTAINERS, EventKind
from beliefnest.world.paths import BeliefPath, normalised, path_text
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


class _Overlay:
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
            {name: (_pose_of(agents[name]), agents[name].current) for name in self._feet},
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


def _pose_of(agent: AgentBelief) -> AgentPose | None:
    """Return the believed pose of an agent; None: its place is unknown."""
    return None if agent.position is None else (agent.position, agent.yaw, agent.pitch)


class CourseQuestion(msgspec.Struct, frozen=True, eq=False):
    """Request to read one agent's course from one node.

    Attributes:
        path: The observer's node.
        agent: The modelled agent.
        goals: Its possible goals.
        alternatives: The alternatives of its doubt.
        ignores: True if the node's own values of the doubted elements are ignored.
        diagonal: True if steps also lead to diagonal neighbours.
        since: The tick from which on evidence counts.
    """

    path: BeliefPath
    agent: str
    goals: "dict[str, PossibleGoal]"
    alternatives: tuple[Alternative, ...]
    ignores: bool
    diagonal: bool
    since: int


@dataclass
class CourseReading:
    """Moments read from one timeline; `read` continues it.

    Attributes:
        moments: The moments, oldest first.
        latest: The last tick that was read.
    """

    recording: Recording
    question: CourseQuestion
    moments: list[EvidenceMoment] = field(default_factory=list)
    latest: int = -1
    _overlay: _Overlay | None = None
    _agrees: int = -1
    _forest: Forest | None = None
    _key: TimelineKey | None = None
    _position: int = 0
    _events: int = 0
    _scene: tuple[bytes, Surroundings] | None = None

    def read(self, until: int | None) -> None:
        """Continue to read up to a tick; None: the latest.

        Raises:
            TickError: The tick is in the future, or before the start.
            InputError: No alternative agrees with the node.
        """
        recording, question = self.recording, self.question
        agent = question.agent
        if agent not in recording.agents:
            raise PathError(f"no agent {agent!r}; there are {', '.join(recording.agents)}")
        if self._overlay is None:
            self._overlay = self._unchanged()
        moment = recording.moment(question.path, until)
        for stretch in recording.stretches(moment):
            key = stretch.timeline
            if self._key is not None and key != self._key and stretch.tick <= self.latest:
                continue
            info = recording.journal.info(key)
            if self._key != key:
                if stretch.tick < question.since:
                    continue
                start = recording.journal.entries_until(key, max(question.since, info.start))
                self._enter(key, start, max(question.since, info.start))
            self._go_on(key, stretch.entries)
        self.latest = moment.tick

    @property
    def is_whole(self) -> bool:
        """True if it contains all entries of the ticks that were read."""
        if self._key is None:
            return False
        return self.recording.journal.entries_until(self._key, self.latest) == self._position

    @property
    def agrees(self) -> int:
        """The alternatives that have agreed with the node at all ticks."""
        return self._agrees

    @property
    def has_seen(self) -> bool:
        """True if the agent was current at any tick."""
        return any(moment.cell is not None for moment in self.moments)

    def _enter(self, key: TimelineKey, start: int, tick: int) -> None:
        recording, question = self.recording, self.question
        paths = [question.path]
        if recording.context.options.testimony != "none":
            paths.append(self._agent_path)
        past: tuple[int, ...] = ()
        if start and self.moments and self.moments[0].tick == tick:
            past = self._begin_again()
        self._forest = recording.history.walk(key, paths)
        recording.history.advance(key, self._forest, start)
        self._key, self._position = key, start
        claims = self._claims(key, start) if start else []
        first = recording.journal.entries_until(key, tick - 1) if start else 0
        before = recording.journal.events_until(key, first) if start else 0
        self._take(tick, claims, before)
        if past:
            self.moments[0] = replace(self.moments[0], claims=past + self.moments[0].claims)

    def _begin_again(self) -> tuple[int, ...]:
        """Drop what was read of the first tick: a branch begins there, and was edited there.

        Returns:
            The claims that the agent took up in that tick before the edit, as in `EvidenceMoment`.
        """
        claims = tuple(mask for moment in self.moments for mask in moment.claims)
        self._overlay = self._unchanged()
        self.moments, self._agrees = [], -1
        return claims

    def _unchanged(self) -> _Overlay:
        """Return the doubted elements as the alternatives give them."""
        recording, question = self.recording, self.question
        return _Overlay(
            question.alternatives,
            recording.context.registry,
            recording.context.box,
            recording.agents,
            question.agent,
            recording.state(()).container_at,
        )

    @property
    def _agent_path(self) -> BeliefPath:
        return normalised((*self.question.path, self.question.agent))

    def _go_on(self, key: TimelineKey, stop: int) -> None:
        assert self._forest is not None
        recording = self.recording
        entries = list(recording.journal.entries(key, self._position, stop))
        claims: list[Claim] = []
        for number, entry in enumerate(entries):
            self._position += 1
            recording.history.advance(key, self._forest, self._position)
            claims += self._taken_up(entry)
            following = entries[number + 1] if number + 1 < len(entries) else None
            if following is None or following.tick > entry.tick:
                self._take(entry.tick, claims, self._events)
                claims = []

    def _claims(self, key: TimelineKey, position: int) -> list[Claim]:
        """Return the claims that the agent took up in the entry before a position.

        The list is empty if this entry is not of the tick `question.since`.
        """
        entry = next(self.recording.journal.entries(key, position - 1, position))
        return list(self._taken_up(entry)) if entry.tick == self.question.since else []

    def _taken_up(self, entry: Entry) -> Iterator[Claim]:
        forest, path = self._forest, self._agent_path
        assert forest is not None
        if isinstance(entry, Edit) or path not in forest:
            return
        node, whole = forest.node(path), NodeView(forest, path).container_at
        for row, event in enumerate(entry.events):
            for index, claim in enumerate(claims_of(event)):
                verdicts = forest.verdicts.get((row, index))
                if verdicts is not None and verdicts[node].believed:
                    yield claim.of_whole(whole)

    def _take(self, tick: int, claims: Sequence[Claim], before: int) -> None:
        """Read the state of the node after a tick."""
        forest, overlay, question = self._forest, self._overlay, self.question
        assert forest is not None and overlay is not None
        view = NodeView(forest, question.path)
        events = [event for event in view.events_since(before) if event.tick == tick]
        self._events = view.count_of_events
        learnt = self._learnt(events)
        truths = tuple(mask for mask in map(overlay.truth, claims) if mask >= 0)
        overlay.follow(view, events)
        if not question.ignores:
            self._agrees &= overlay.agreeing()
            if self._agrees == 0:
                raise InputError(
                    f"no alternative agrees with what {path_text(question.path)} holds at tick "
                    f"{tick}; change the doubt, or give actual='unknown'"
                )
        scene = self._scene_of(view)
        agent = view.agents[question.agent]
        pose = _pose_of(agent)
        seen = agent.current and pose is not None
        alike: tuple[int, ...] = ()
        cell = None
        if seen and pose is not None:
            cell = self._cell(scene, pose, on_ground=agent.on_ground)
            alike = tuple(scene.worlds.alike(*pose, all_round=False))
        owner = question.path[-1] if question.path else None
        watching = None if owner in (None, question.agent) else view.agents[owner or ""]
        watch = None if watching is None or not watching.current else _pose_of(watching)
        opened, act, deed = self._done(events)
        self.moments.append(
            EvidenceMoment(
                tick, scene, cell, alike, truths, learnt, opened, act, deed, self._agrees, watch
            )
        )

    def _learnt(self, events: Sequence[PerceivedEvent]) -> tuple[tuple[int, ...], ...]:
        """Return the information from the doubted containers that the agent uses."""
        assert self._overlay is not None
        used = {
            event.detail.get("position")
            for event in events
            if event.actor == self.question.agent and event.kind in AT_CONTAINERS
        }
        return tuple(
            self._overlay.content_masks(place)
            for place in self._overlay.containers
            if place in used
        )

    def _done(self, events: Sequence[PerceivedEvent]) -> tuple[Position | None, int | None, bool]:
        """Return the opened container, the index of the achieved goal, and True for other acts."""
        assert self._overlay is not None
        opened, act, deed = None, None, False
        for event in events:
            if event.actor != self.question.agent or not event.kind.traits.is_deed:
                continue
            if event.kind is EventKind.GET_ITEM_FROM_CHEST:
                goals = [
                    number
                    for number, goal in enumerate(self.question.goals.values())
                    if goal.item in event.detail.get("items", {})
                ]
                if goals:
                    act = goals[0]
                    continue
            if (
                event.kind is EventKind.OPEN_CONTAINER
                and event.detail.get("position") in self._overlay.containers
            ):
                opened = event.detail.get("position")
                continue
            deed = True
        return opened, act, deed

    def _scene_of(self, view: NodeView) -> Surroundings:
        overlay, question, context = self._overlay, self.question, self.recording.context
        assert overlay is not None
        digest = overlay.digest(view)
        if self._scene is not None and self._scene[0] == digest:
            return self._scene[1]
        worlds = AlternativeWorlds(
            context.sight,
            context.box,
            overlay.worlds(view),
            dict(view.items),
            question.agent,
            transparent=context.options.containers == "transparent",
        )
        options = context.options
        key = repr(
            (
                options.max_visible_distance,
                options.transparent_blocks,
                options.containers,
                question.agent,
                list(question.goals.items()),
                overlay.containers,
                question.diagonal,
            )
        )
        scene = Surroundings(
            context.registry,
            worlds,
            question.goals,
            overlay.containers,
            diagonal=question.diagonal,
            key=digest + key.encode(),
        )
        self._scene = (digest, scene)
        return scene

    def _cell(self, scene: Surroundings, pose: AgentPose, *, on_ground: bool) -> Position:
        """Return the cell of an agent; during a jump or over an edge, its previous cell."""
        x, y, z = block_at(pose[0])
        # Feet on a low block are in its place, below the cell in which the agent stands.
        near: list[Position] = [(x, y, z), (x, y - 1, z)]
        if on_ground:
            near.append((x, y + 1, z))
        for cell in near:
            if scene.can_stand(cell):
                return cell
        at = (x, y, z)
        if on_ground and scene.has_unknown_floor(at):
            return at
        return next((m.cell for m in reversed(self.moments) if m.cell is not None), at)
