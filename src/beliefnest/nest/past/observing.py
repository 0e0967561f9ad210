"""Observations of a node's owner in the order of time, read from the node's timeline."""

from collections.abc import Collection, Iterator, Mapping, Sequence

import msgspec
import numpy as np

from beliefnest.belief.columns import cell_of
from beliefnest.belief.forest import Forest
from beliefnest.belief.grounds import PerceivedEvent, Source
from beliefnest.belief.node_view import NodeView
from beliefnest.nest.past.labelled import Labelled
from beliefnest.nest.past.place_names import sign_places
from beliefnest.nest.past.recording import Recording
from beliefnest.prompts.observations import (
    Assumed,
    AssumedAgent,
    Found,
    Happened,
    Lying,
    Observation,
    Outset,
    Read,
    SightChange,
)
from beliefnest.timeline.journal import ForkPoint
from beliefnest.world.doors import is_door
from beliefnest.world.event_kinds import EventKind
from beliefnest.world.event_words import is_lid
from beliefnest.world.paths import BeliefPath, normalised
from beliefnest.world.registry import block_name
from beliefnest.world.values import DroppedItem, Items, Point, Position

_DEEDS_AT_BLOCKS = frozenset(
    {
        *(EventKind.USE_DOOR, EventKind.USE_LEVER, EventKind.PRESS_BUTTON),
        *(EventKind.PLACE_BLOCK, EventKind.MINE_BLOCK),
    }
)
"""Acts that say what happens to blocks in the same tick."""


class _Look(msgspec.Struct, frozen=True):
    """View of one observer at a tick.

    Attributes:
        agents: Feet of the other agents that it sees.
        places: Containers and signs that it sees.
        kinds: Names of their blocks; empty if a narrator tells.
    """

    agents: Mapping[str, Point]
    places: frozenset[Position]
    kinds: Mapping[Position, str] = msgspec.field(default_factory=dict)

    @property
    def all(self) -> frozenset[str | Position]:
        """Return everything in view: names of agents, positions of containers and signs."""
        return frozenset((*self.agents, *self.places))


_Looks = Mapping[str, _Look]
_NOTHING_SEEN = _Look({}, frozenset())


class _Scene(msgspec.Struct, frozen=True):
    """Percepts in a node at a tick, as far as a story tells them.

    Attributes:
        looks: What each viewer sees: the owner, or each agent if the node is the real world.
        contents: Complete contents that the owner perceives.
        texts: Texts of the signs that the owner sees.
        items: Dropped items that the owner sees, by number.
    """

    looks: _Looks
    contents: Mapping[Position, Items]
    texts: Mapping[Position, str]
    items: Mapping[int, DroppedItem]


def observations_of(
    recording: Recording, path: BeliefPath, tick: int | None = None
) -> tuple[Observation, ...]:
    """Return the observations of a node's owner until a tick; None: until now.

    Changes of sight are told before the next perceived event; those that are undone before it have
    no consequences. In the real world every event and every agent's sight is told, also that an
    agent turned before another one stopped or began to see it.
    """
    moment = recording.moment(path, tick)
    return tuple(_Observer(recording, path, Labelled(recording, moment)).read(moment))


class _Turns:
    """Follow turns of agents that no story has told yet, and who saw them.

    A turn is a change of what an agent sees while it and the things in question stand still.
    """

    def __init__(self) -> None:
        self._tick = 0
        self._looks: _Looks = {}
        self._feet: Mapping[str, Point | None] = {}
        self._turned: dict[str, set[str | Position]] = {}

    def before(
        self, already: _Looks, tick: int, looks: _Looks, feet: Mapping[str, Point | None]
    ) -> tuple[int, _Looks] | None:
        """Return the looks to tell before those of a tick, and take these over.

        Args:
            already: Looks as they were told last.
            tick: The tick.
            looks: Looks at this tick.
            feet: Feet of all agents at this tick.

        Returns:
            The previous tick and its looks, if at this tick another agent loses or gains sight of
            one that has turned untold; None: nothing to tell.
        """
        previous, self._looks = self._looks, looks
        last, self._tick = self._tick, tick
        stands = {name for name, point in feet.items() if self._feet.get(name) == point}
        self._feet = feet
        if looks == previous:
            return None
        is_told = False
        for viewer, look in looks.items():
            past = previous.get(viewer, _NOTHING_SEEN).all
            untold = past ^ already.get(viewer, _NOTHING_SEEN).all
            turned = self._turned.get(viewer, set()) & untold
            if turned and _watchers(viewer, looks) != _watchers(viewer, previous):
                is_told = True
            changed = (past ^ look.all) if viewer in stands else frozenset()
            still = {each for each in changed if not isinstance(each, str) or each in stands}
            self._turned[viewer] = turned | still
        return (last, previous) if is_told else None


def _watchers(viewer: str, looks: _Looks) -> frozenset[str]:
    return frozenset(who for who, look in looks.items() if viewer in look.agents)


class _Observer:
    def __init__(self, recording: Recording, path: BeliefPath, labelled: Labelled) -> None:
        self._recording = recording
        self._path = path
        self._labelled = labelled
        self._owner = path[-1] if path else None
        viewers = recording.agents if self._owner is None else (self._owner,)
        self._nodes = {name: (name,) if self._owner is None else path for name in viewers}
        # What the observer believes that others perceive.
        others = (name for name in recording.agents if name != self._owner)
        self._minds = {name: normalised((*path, name)) for name in others}
        is_common = recording.setting.perception.hearing == "global"
        self._hearers = {} if is_common else self._minds
        nodes = (path, *self._nodes.values(), *self._hearers.values())
        self._paths = list(dict.fromkeys(nodes))
        # A narrator tells of the things that the scenario has, an owner of those that it sees.
        self._signs: frozenset[Position] = frozenset()
        self._places: frozenset[Position] = frozenset()
        if self._owner is None:
            self._signs = frozenset(sign_places(recording.setting))
            self._places = self._signs | recording.setting.snapshot.containers.keys()
        self._seen: dict[str, _Look] = {}
        self._turns = _Turns()
        self._contents: dict[Position, Items | None] = {}
        self._texts: dict[Position, str] = {}
        self._lying: set[int] = set()

    def read(self, moment: ForkPoint) -> Iterator[Observation]:
        """Yield the observations until a moment."""
        recording, history = self._recording, self._recording.history
        journal = recording.journal
        scene: _Scene | None = None
        tick = 0
        for stretch in recording.stretches(moment):
            key, count = stretch.timeline, 0
            forest = history.walk(key, self._paths)
            if scene is None:
                scene, tick = self._scene(forest), forest.tick
                with_minds = history.walk(key, [self._path, *self._minds.values()])
                yield from self._outset(forest, scene, with_minds)
            entries = list(journal.entries(key, 0, stretch.entries))
            for number, entry in enumerate(entries):
                last = number + 1 == len(entries) or entries[number + 1].tick > entry.tick
                if not last:
                    continue
                after = journal.events_until(key, number + 1)
                before = self._scene(forest) if after > count else None
                history.advance(key, forest, number + 1)
                if self._owner is None:
                    yield from self._turned(forest)
                if before is not None:
                    tick = forest.tick
                    events = NodeView(forest, self._path).events_since(count)
                    heard = self._heard(forest, events, count)
                    yield from self._told(tick, before, events, forest, heard)
                    count = after
            scene, tick = self._scene(forest), moment.tick
        if scene is not None:
            yield from self._changes(tick, scene)

    def _outset(self, forest: Forest, scene: _Scene, with_minds: Forest) -> Iterator[Observation]:
        view, tick = NodeView(forest, self._path), forest.tick
        perceived = {n: a for n, a in view.agents.items() if a.current and a.position is not None}
        feet = {name: agent.position for name, agent in perceived.items() if agent.position}
        has = {name: dict(agent.inventory) for name, agent in perceived.items() if agent.inventory}
        minds = {name: self._knowing(with_minds, name, items) for name, items in has.items()}
        yield Outset(tick, self._owner, feet, has, minds)
        for at, content in view.containers.items():
            if content.basis.source is Source.PRIOR and (content.items or content.complete):
                yield Assumed(tick, at, dict(content.items))
        for name, agent in view.agents.items():
            if not agent.current and agent.basis and agent.basis.source is Source.PRIOR:
                yield AssumedAgent(tick, name, agent.position, dict(agent.inventory))
        is_closed = self._recording.setting.perception.containers == "opaque"
        for each in self._changes(tick, scene):
            if isinstance(each, Found) and each.items and self._owner is None and is_closed:
                yield msgspec.structs.replace(each, known=self._knowing_of(with_minds, each))
            else:
                yield each

    def _knowing_of(self, forest: Forest, finding: Found) -> tuple[str, ...]:
        """Return the others who know of the content of a container."""
        contents = {
            n: NodeView(forest, p).containers.get(finding.place) for n, p in self._minds.items()
        }
        return tuple(
            name
            for name, content in contents.items()
            if content is not None and all(content.items.get(item) for item in finding.items)
        )

    def _knowing(self, forest: Forest, holder: str, items: Items) -> tuple[str, ...]:
        """Return the others who know of an agent's items, as the observer believes."""

        def knows(mind: BeliefPath) -> bool:
            agent = NodeView(forest, mind).agents[holder]
            worn = (agent.equipment or {}).values()
            return all(agent.inventory.get(item) or item in worn for item in items)

        return tuple(name for name, mind in self._minds.items() if name != holder and knows(mind))

    def _heard(
        self, forest: Forest, events: Sequence[PerceivedEvent], count: int
    ) -> Mapping[int, tuple[str, ...]]:
        """Return the others who heard an utterance, by `id` of the event.

        Args:
            forest: Forest after the events.
            events: Events that the observer perceived.
            count: Number of the timeline's events before them.
        """
        if not self._hearers or not any(event.kind is EventKind.CHAT for event in events):
            return {}
        numbers = np.flatnonzero(NodeView(forest, self._path).perceived_since(count))
        by = {
            name: NodeView(forest, at).perceived_since(count) for name, at in self._hearers.items()
        }
        return {
            id(event): tuple(
                name for name, mask in by.items() if mask[number] and name != event.actor
            )
            for event, number in zip(events, numbers, strict=True)
            if event.kind is EventKind.CHAT and event.detail.get("to") is None
        }

    def _told(
        self,
        tick: int,
        before: _Scene,
        events: Sequence[PerceivedEvent],
        forest: Forest,
        heard: Mapping[int, tuple[str, ...]],
    ) -> Iterator[Observation]:
        """Yield the events of one tick with the changes of sight before and after them."""
        notable = [event for event in events if not _is_noise(event, events)]
        if self._owner is not None:
            notable = [event for event in notable if not _is_upper_half(event, notable)]
        if not notable:
            return
        if notable[0].kind is not EventKind.MOVE_TO:
            yield from self._changes(tick - 1, before)
        after = self._scene(forest)
        for number, event in enumerate(notable):
            self._moved(event)
            yield Happened(tick, event, self._block_at(forest, event), heard.get(id(event)))
            if event.kind is EventKind.OPEN_CONTAINER and event.actor == self._owner:
                yield from self._opened(tick, event, notable[number + 1 :], after)
        if notable[-1].kind is EventKind.MOVE_TO:
            yield from self._changes(tick, after)
        else:
            yield from self._findings(tick, after)

    def _opened(
        self, tick: int, opening: PerceivedEvent, later: Sequence[PerceivedEvent], after: _Scene
    ) -> Iterator[Observation]:
        """Yield the contents at an opening: those of the tick's end, without its later moves."""
        place = opening.detail["position"]
        if place not in after.contents:
            return
        content = dict(after.contents[place])
        for event in later:
            if event.kind.traits.stores and event.detail.get("position") == place:
                for name, count in event.detail.get("items", {}).items():
                    content[name] = content.get(name, 0) - event.kind.traits.stores * count
        content = {name: count for name, count in content.items() if count > 0}
        if self._contents.get(place) != content:
            self._contents[place] = content
            yield Found(tick, place, dict(content))

    def _block_at(self, forest: Forest, event: PerceivedEvent) -> str | None:
        """Return the name of the block at an event's position, as the owner believes."""
        place, context = event.detail.get("position"), forest.context
        if self._owner is None or place is None or place not in context.box:
            return None
        node = forest.node(self._path)
        return context.block_name(forest.table.block(node, cell_of(context.box, place)))

    def _moved(self, event: PerceivedEvent) -> None:
        """Follow the known contents through an event."""
        place, stores = event.detail.get("position"), event.kind.traits.stores
        if place is None:
            return
        text = event.detail.get("text")
        if text is not None:
            self._texts[place] = text
        content = self._contents.get(place)
        if content is None or not stores:
            return
        now = dict(content)
        for name, count in event.detail.get("items", {}).items():
            now[name] = now.get(name, 0) + stores * count
        self._contents[place] = {name: count for name, count in now.items() if count > 0}

    def _turned(self, forest: Forest) -> Iterator[Observation]:
        """Yield the turns that must be told before what others see at this tick."""
        feet = {name: forest.feet(self._path, name) for name in forest.context.agents}
        looks = self._looks(forest, NodeView(forest, self._path))
        turn = self._turns.before(self._seen, forest.tick, looks, feet)
        if turn is not None:
            yield from self._sights(*turn)

    def _changes(self, tick: int, scene: _Scene) -> Iterator[Observation]:
        yield from self._sights(tick, scene.looks)
        yield from self._findings(tick, scene)

    def _sights(self, tick: int, looks: _Looks) -> Iterator[Observation]:
        for viewer, look in looks.items():
            past = self._seen.get(viewer, _NOTHING_SEEN)
            new = tuple(sorted(look.places - past.places))
            sight = SightChange(
                tick,
                viewer,
                {name: at for name, at in look.agents.items() if name not in past.agents},
                new,
                {name: at for name, at in past.agents.items() if name not in look.agents},
                tuple(sorted(past.places - look.places)),
                {at: look.kinds[at] for at in new if at in look.kinds},
                tuple(at for at in new if at in look.kinds and self._labelled.has(at, tick)),
            )
            self._seen[viewer] = look
            if sight.agents or sight.places or sight.lost_agents or sight.lost_places:
                yield sight

    def _findings(self, tick: int, scene: _Scene) -> Iterator[Observation]:
        for at, text in scene.texts.items():
            if self._texts.get(at) != text:
                self._texts[at] = text
                yield Read(tick, at, text)
        for at, items in scene.contents.items():
            if self._contents.get(at) != items:
                self._contents[at] = dict(items)
                yield Found(tick, at, dict(items))
        for number, item in scene.items.items():
            if number not in self._lying:
                self._lying.add(number)
                yield Lying(tick, item.name, item.count, item.position)

    def _scene(self, forest: Forest) -> _Scene:
        view = NodeView(forest, self._path)
        looks = self._looks(forest, view)
        box = forest.context.box
        if self._owner is None:
            contents = {at: content.items for at, content in view.containers.items()}
            return _Scene(looks, contents, self._sign_texts(view, self._signs), view.items)
        present = forest.is_current(self._path, self._owner)
        contents = {
            at: content.items
            for at, content in view.containers.items()
            if present and content.current and content.complete
        }
        signs = looks[self._owner].places & view.signs.keys()
        cells = {
            number: cell_of(box, cell)
            for number, item in view.items.items()
            if (cell := _cell(item.position)) in box
        }
        seen = forest.current_blocks(self._path, cells.values()) if present else set()
        items = {number: view.items[number] for number, cell in cells.items() if cell in seen}
        return _Scene(looks, contents, self._sign_texts(view, signs), items)

    def _sign_texts(self, view: NodeView, signs: Collection[Position]) -> dict[Position, str]:
        # A sign without text is not among `view.signs`.
        return {at: view.signs.get(at, "") for at in sorted(signs)}

    def _looks(self, forest: Forest, view: NodeView) -> _Looks:
        return {name: self._look(forest, name, node, view) for name, node in self._nodes.items()}

    def _look(self, forest: Forest, viewer: str, node: BeliefPath, view: NodeView) -> _Look:
        if not forest.is_current(node, viewer):
            return _NOTHING_SEEN
        box = forest.context.box
        places: Collection[Position] = self._places
        if self._owner is not None:
            places = view.containers.keys() | view.signs.keys()
        cells = {cell_of(box, at): at for at in sorted(places)}
        seen = forest.current_blocks(node, cells)
        feet = {
            name: forest.feet(node, name)
            for name in forest.context.agents
            if name != viewer and forest.is_current(node, name)
        }
        kinds: dict[Position, str] = {}
        if self._owner is not None:
            number = forest.node(node)
            named = {
                cells[c]: forest.context.block_name(forest.table.block(number, c)) for c in seen
            }
            kinds = {at: name for at, name in named.items() if name is not None}
        return _Look(
            {name: at for name, at in feet.items() if at is not None},
            frozenset(cells[cell] for cell in seen),
            kinds,
        )


def _cell(point: Point) -> Position:
    x, y, z = (int(value // 1) for value in point)
    return (x, y, z)


def _is_upper_half(event: PerceivedEvent, events: Sequence[PerceivedEvent]) -> bool:
    """Return True for a change of the upper half of a door whose lower half changes as well."""
    if event.kind is not EventKind.BLOCK_UPDATE or not is_door(_block_of(event)):
        return False
    x, y, z = event.detail["position"]
    return any(
        each.kind is EventKind.BLOCK_UPDATE
        and each.detail["position"] == (x, y - 1, z)
        and is_door(_block_of(each))
        for each in events
    )


def _block_of(event: PerceivedEvent) -> str:
    return block_name(str(event.detail.get("block", "")))


def _is_noise(event: PerceivedEvent, events: Sequence[PerceivedEvent]) -> bool:
    """Return True for changes of blocks that another event tells, and for receiving."""
    if event.kind is EventKind.RECEIVE_ITEM_FROM_OTHER:
        # The giver's event tells the same, if it was perceived.
        return any(each.kind is EventKind.GIVE_ITEM_TO_OTHER for each in events)
    if event.kind is not EventKind.BLOCK_UPDATE or event.detail.get("text") is not None:
        return False
    return is_lid(event) or any(each.kind in _DEEDS_AT_BLOCKS for each in events)
