"""Claims that a model reads out of utterances without claims, before frames are recorded.

The claims are recorded in the event of the utterance, with the name of the reader (`claims_from`).
Later readers and replays use the record and never ask the model again.
"""

from collections.abc import Iterable, Mapping
from typing import Any, Protocol

from msgspec.structs import replace

from beliefnest.nest.acting.sensing import believer_of
from beliefnest.nest.past.labelled import Labelled
from beliefnest.nest.past.observing import observations_of
from beliefnest.nest.past.recording import Recording
from beliefnest.nest.past.timeline_state import TimelineState
from beliefnest.prompts.naming import known_places
from beliefnest.prompts.simulator_view import blocks_where
from beliefnest.timeline.journal import TimelineKey
from beliefnest.world.claims import Claim, claims_from_plain, with_claims
from beliefnest.world.doors import is_door, is_switch
from beliefnest.world.double_chests import holds_items
from beliefnest.world.event_kinds import EventKind
from beliefnest.world.frames import Frame
from beliefnest.world.nameable import Nameable
from beliefnest.world.paths import BeliefPath
from beliefnest.world.registry import Registry, block_name
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

    def __init__(self, reader: ClaimReader, recording: Recording) -> None:
        self._reader = reader
        self._recording = recording

    def completed(self, frame: Frame, key: TimelineKey) -> Frame:
        """Return the frame with claims added to its utterances that carry none.

        Everything before the frame must be recorded already: it decides what a speaker can name.

        Raises:
            InputError: The reader returned something that is not a claim or does not fit the world.
        """
        recording = self._recording.on(key)
        events = tuple(
            self._read(event, frame.tick, recording, key) if _is_unread(event) else event
            for event in frame.events
        )
        return replace(frame, events=events)

    def _read(self, event: Event, tick: int, recording: Recording, key: TimelineKey) -> Event:
        speaker, text = str(event.actor), str(event.detail["text"])
        path = believer_of(key.path, speaker)
        nameable = _nameable(recording, path, recording.state(path))
        claims = tuple(self._reader.read(key.path, tick, text, speaker, nameable))
        if not claims:
            return event
        detail = with_claims(event.detail, claims, nameable.box, nameable.agents)
        return replace(event, detail={**detail, "claims_from": self._reader.name})


def has_unread(frame: Frame) -> bool:
    """Return True if a frame has an utterance whose claims were not read yet."""
    return any(map(_is_unread, frame.events))


def recalled(frame: Frame, recorded: Frame | None) -> Frame:
    """Return a frame of a replay with the claims that were once read out of its utterances."""
    if recorded is None or not has_unread(frame):
        return frame
    read = [event for event in recorded.events if "claims_from" in event.detail]
    events = []
    for event in frame.events:
        same = next((k for k in read if _is_unread(event) and _bare(k) == _bare(event)), None)
        if same is not None:
            read.remove(same)
        events.append(event if same is None else same)
    return replace(frame, events=tuple(events))


def _is_unread(event: Event) -> bool:
    return event.kind is EventKind.CHAT and "claims" not in event.detail


def _bare(event: Event) -> tuple[object, ...]:
    """Return an utterance without its claims, for comparison."""
    detail: Mapping[str, Any] = event.detail
    return event.kind, event.actor, detail["text"], detail.get("to")


def _nameable(recording: Recording, path: BeliefPath, believed: TimelineState) -> Nameable:
    """Return the things that the owner of a belief can name: an utterance means no others."""
    setting = recording.setting
    labels = _labels(recording, path, believed) if setting.labels else {}
    fittings = dict(blocks_where(believed, _is_fitting))
    containers = {
        at: labels.get(at, block_name(text))
        for at, text in fittings.items()
        if Registry.load().is_container(block_name(text))
    }
    return Nameable(
        box=recording.box,
        agents=recording.agents,
        items=tuple(sorted(_items(recording, path, believed) | setting.unique)),
        containers=containers,
        doors={at: text for at, text in fittings.items() if at not in containers},
        places=dict(known_places(believed, setting.places)),
    )


def _is_fitting(text: str) -> bool:
    """Return True for a container, door or switch; the left half of a double chest is none."""
    registry, name = Registry.load(), block_name(text)
    return holds_items(registry, registry.state_id(text)) or is_door(name) or is_switch(name)


def _labels(recording: Recording, path: BeliefPath, believed: TimelineState) -> dict[Position, str]:
    labelled = Labelled(recording, recording.moment(path))
    return labelled.known(believed, observations_of(recording, path), recording.setting.labels)


def _items(recording: Recording, path: BeliefPath, believed: TimelineState) -> set[str]:
    """Return the items that an agent believes in, at first or now, has seen moved or heard of."""
    names: set[str] = set()
    for state in (recording.state(path, recording.info(path).start), believed):
        for content in state.containers.values():
            names.update(content.items)
        for agent in state.agents.values():
            names.update(agent.inventory, (agent.equipment or {}).values())
        names.update(item.name for item in state.items.values())
    for event in believed.perceived:
        names.update(event.detail.get("items", ()))
        claims = claims_from_plain(event.detail.get("claims", ()))
        names.update(claim.item for claim in claims if claim.item is not None)
    return names
