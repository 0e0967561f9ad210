"""Claims that a model reads out of utterances without claims, before frames are recorded.

The claims are recorded in the event of the utterance, with the name of the reader (`claims_from`).
Later readers and replays use the record and never ask the model again.
"""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any, Protocol

from beliefnest.belief.node_view import NodeView
from beliefnest.nest.past.history import StateHistory
from beliefnest.nest.past.setting import Setting
from beliefnest.timeline.journal import TimelineKey
from beliefnest.world.claims import Claim, with_claims
from beliefnest.world.doors import is_door, is_switch
from beliefnest.world.double_chests import holds_items
from beliefnest.world.event_kinds import EventKind
from beliefnest.world.frames import Frame
from beliefnest.world.nameable import Nameable
from beliefnest.world.paths import BeliefPath
from beliefnest.world.registry import block_name
from beliefnest.world.values import Event, Position


class ClaimReader(Protocol):
    """Reader of claims in text, for example a model."""

    @property
    def name(self) -> str:
        """The name that is recorded beside the claims it finds."""

    def read(
        self, path: BeliefPath, tick: int, text: str, speaker: str, nameable: Nameable
    ) -> Iterable[Claim]:
        """Return the claims of a text that was uttered in the simulator `path` at a tick."""


class Hearsay:
    """Completion of frames: adds the claims that a reader finds in utterances."""

    def __init__(self, reader: ClaimReader, setting: Setting, history: StateHistory) -> None:
        self._reader = reader
        self._setting = setting
        self._history = history

    def completed(self, frame: Frame, key: TimelineKey) -> Frame:
        """Return the frame with claims added to its utterances that carry none.

        Everything before the frame must be recorded already: it decides what claims can name.

        Raises:
            InputError: The reader returned something that is not a claim or does not fit the world.
        """
        seen = self._history.state(key, key.path)
        nameable = _nameable(self._setting, self._history, seen)
        events = tuple(
            self._read(event, frame.tick, key, nameable) if _is_unread(event) else event
            for event in frame.events
        )
        return replace(frame, events=events)

    def _read(self, event: Event, tick: int, key: TimelineKey, nameable: Nameable) -> Event:
        speaker, text = str(event.actor), str(event.detail["text"])
        claims = tuple(self._reader.read(key.path, tick, text, speaker, nameable))
        if not claims:
            return event
        whole = self._history.state(key, key.path).container_at
        found = with_claims(event.detail, claims, nameable.box, nameable.agents, whole)
        return replace(event, detail={**found, "claims_from": self._reader.name})


def has_unread(frame: Frame) -> bool:
    """Return True if a frame has an utterance whose claims were not read yet."""
    return any(map(_is_unread, frame.events))


def recalled(frame: Frame, recorded: Frame | None) -> Frame:
    """Return a frame of a replay with the claims that were once read out of its utterances."""
    if recorded is None or not has_unread(frame):
        return frame
    known = [event for event in recorded.events if "claims_from" in event.detail]
    events = []
    for event in frame.events:
        same = next((k for k in known if _is_unread(event) and _bare(k) == _bare(event)), None)
        if same is not None:
            known.remove(same)
        events.append(event if same is None else same)
    return replace(frame, events=tuple(events))


def _is_unread(event: Event) -> bool:
    return event.kind is EventKind.CHAT and "claims" not in event.detail


def _bare(event: Event) -> tuple[object, ...]:
    """Return an utterance without its claims, for comparison."""
    detail: Mapping[str, Any] = event.detail
    return event.kind, event.actor, detail["text"], detail.get("to")


def _nameable(setting: Setting, history: StateHistory, seen: NodeView) -> Nameable:
    start, registry = setting.snapshot, history.context.registry
    known = {cell: registry.text(state) for cell, state in _fittings(history, seen).items()}
    containers = {
        at: setting.labels.get(at, block_name(text))
        for at, text in known.items()
        if registry.is_container(block_name(text))
    }
    holders: list[Iterable[str]] = [*start.containers.values()]
    holders += [agent.inventory for agent in start.agents.values()]
    holders += [content.items for content in seen.containers.values()]
    holders += [agent.inventory for agent in seen.agents.values()]
    holders.append(item.name for item in (*start.items.values(), *seen.items.values()))
    return Nameable(
        box=start.box,
        agents=history.context.agents,
        items=tuple(sorted({name for names in holders for name in names})),
        containers=containers,
        doors={at: text for at, text in known.items() if at not in containers},
        places=dict(setting.places),
    )


def _fittings(history: StateHistory, seen: NodeView) -> dict[Position, int]:
    """Return the containers, doors and switches of a simulator, as block states."""
    registry, box = history.context.registry, history.context.box
    states = []
    for state in seen.terrain.states:
        name = registry.name(state) if state >= 0 else ""
        if name and (holds_items(registry, state) or is_door(name) or is_switch(name)):
            states.append(state)
    x, y, z = box.low
    return {
        (x + i, y + j, z + k): seen.terrain[i, j, k]
        for i, j, k in seen.terrain.find(states).tolist()
    }
