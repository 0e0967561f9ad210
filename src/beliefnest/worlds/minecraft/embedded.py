"""Embedded Minecraft world: one Node process with the server and all bots."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Self

import msgspec
import numpy as np

from beliefnest.errors import BodyError, WorldError
from beliefnest.owned import Owned
from beliefnest.world.frames import Frame, Snapshot
from beliefnest.world.values import Box, Event
from beliefnest.worlds.minecraft import node_messages
from beliefnest.worlds.minecraft.channel import Channel
from beliefnest.worlds.minecraft.launching import Launch
from beliefnest.worlds.process_limits import ProcessLimits
from beliefnest.worlds.protocol import (
    AS_USUAL,
    ProgramResult,
    RealtimePlay,
    RunRules,
    SenseSource,
    Sink,
)


class _Telling:
    """Messages to Node about an agent's knowledge: first all of it, then the changes."""

    def __init__(self, sense: SenseSource, box: Box) -> None:
        self._sense, self._box = sense, box
        self._told = sense()

    def whole(self) -> dict[str, Any]:
        """Return the agent's whole knowledge as a message."""
        return node_messages.percepts_message(self._told, self._box.low)

    def changes(self) -> dict[str, Any]:
        """Return the changes since the last message."""
        before, self._told = self._told, self._sense()
        if before is self._told:
            return {}
        return node_messages.percepts_changes(before, self._told, self._box.low)


class EmbeddedBody:
    """Region of the embedded world; the attributes are those of `Body`."""

    goes_on = False

    def __init__(
        self,
        channel: Channel,
        region: str,
        snapshot: Snapshot,
        sink: Sink,
        on_close: Callable[[], None] = lambda: None,
    ) -> None:
        self._channel = channel
        self._region = region
        self._box: Box = snapshot.box
        # Node builds unknown blocks as air.
        self._blocks = snapshot.blocks.mapped(lambda part: np.maximum(part, 0))
        self.tick, self.internal_state = snapshot.tick, snapshot.internal_state
        self._agents = frozenset(snapshot.agents)
        self._sink = sink
        self._happened: list[tuple[int, Event]] = []
        self._closed = False
        self._on_close = on_close

    @classmethod
    def opened(
        cls,
        channel: Channel,
        region: str,
        seed: str,
        snapshot: Snapshot,
        sink: Sink,
        agents: Sequence[str],
        on_close: Callable[[], None] = lambda: None,
    ) -> Self:
        """Let Node create and fill a region; `known` are all agents that programs may mention."""
        made = channel.request(
            "create_region",
            region=region,
            seed=seed,
            known=agents,
            **node_messages.snapshot_message(snapshot),
        )
        body = cls(channel, region, snapshot, sink, on_close)
        body._read(made)
        return body

    @property
    def lost(self) -> bool:
        """True if its Node process has ended."""
        return self._channel.lost

    def snapshot(self) -> Snapshot:
        """Return the present state."""
        return self._read(self._channel.request("snapshot", region=self._region))

    def run(
        self,
        programs: Mapping[str, str],
        timeout_ticks: int,
        senses: Mapping[str, SenseSource] | None = None,
        rules: RunRules = AS_USUAL,
    ) -> Mapping[str, ProgramResult]:
        """Run programs by agent, together, until the last has ended."""
        for agent in programs:
            if agent not in self._agents:
                raise WorldError(
                    f"{agent} has no bot in {self._region}: its pose is not known there; "
                    f"there are {', '.join(sorted(self._agents)) or 'no bots'}"
                )
        self._happened = []
        telling = {agent: _Telling(sense, self._box) for agent, sense in (senses or {}).items()}
        answer = self._channel.request(
            "run",
            self._take,
            lambda: {agent: each.changes() for agent, each in telling.items()},
            region=self._region,
            programs=dict(programs),
            timeout_ticks=timeout_ticks,
            speech_ticks=rules.speech_ticks,
            mute=sorted(rules.mute),
            remembers=rules.remembers,
            past={agent: msgspec.to_builtins(each) for agent, each in rules.past.items()},
            senses={agent: each.whole() for agent, each in telling.items()},
        )
        self.tick, self.internal_state = answer["tick"], answer["internal_state"]
        return node_messages.results_of(answer["results"], tuple(self._happened))

    def step(self, ticks: int) -> None:
        """Let ticks pass without programs."""
        answer = self._channel.request("step", self._take, region=self._region, ticks=ticks)
        self.tick, self.internal_state = answer["tick"], answer["internal_state"]

    def set_state(self, snapshot: Snapshot) -> None:
        """Set the state to a snapshot by changing only what differs; no frames are sent."""
        before = self.snapshot()
        set_to = self._channel.request(
            "apply", region=self._region, tick=snapshot.tick, **_difference(before, snapshot)
        )
        self._read(set_to)
        self.tick, self.internal_state = snapshot.tick, snapshot.internal_state
        self._agents = frozenset(snapshot.agents)

    def close(self) -> None:
        """Remove the region; a second call does nothing."""
        if self._closed or self.lost:
            return
        self._closed = True
        try:
            self._channel.request("destroy_region", region=self._region)
        except BodyError:
            # Kill Node, because no new region can use the place of a region that was not removed.
            self._channel.kill()
        else:
            self._on_close()

    def _read(self, message: Mapping[str, Any]) -> Snapshot:
        """Return the snapshot of a message, which has what changed since the one before."""
        snapshot = node_messages.snapshot_of(message, self._box, self._blocks)
        self._blocks = snapshot.blocks
        return snapshot

    def _take(self, message: dict[str, Any]) -> None:
        frame: Frame
        _, frame = node_messages.frame_of(message)
        self.tick = frame.tick
        self._happened.extend((frame.tick, event) for event in frame.events)
        self._sink(frame)


class NodeWorld(Owned, ABC):
    """World with a process of Node, which starts when it is first needed.

    A process that ended is replaced as soon as one is needed again.

    Args:
        seed: Seed of the world's own random numbers.
        limits: Limits of Node.
    """

    has_physics = True

    def __init__(self, seed: int, limits: ProcessLimits | None = None) -> None:
        super().__init__()
        self._seed = seed
        self._limits = limits or ProcessLimits()
        self._channel: Channel | None = None
        self._versions: Mapping[str, str] = {}
        self._closed = False

    def start(self) -> Self:
        """Start the process at once, and return the world.

        Raises:
            BodyError: Node or the bundle is missing, or the start failed. On a server elsewhere the
                message says what is missing there.
        """
        self._live()
        return self

    @property
    def pid(self) -> int:
        """Process id of Node, which is started if necessary."""
        return (self._channel or self._live()).pid

    @property
    def versions(self) -> Mapping[str, str]:
        """Versions of the running programs by name, including the channel's protocol."""
        return self._versions

    def interrupt(self) -> None:
        """Kill the process, whatever it is doing."""
        if self._channel is not None:
            self._channel.kill()

    @property
    def realtime(self) -> RealtimePlay | None:
        """None: time passes only in calls; see `World`."""
        return None

    @abstractmethod
    def open_body(self, name: str, seed: str, snapshot: Snapshot, sink: Sink) -> EmbeddedBody:
        """Create a body and fill it; see `World`."""

    @abstractmethod
    def another(self) -> "EmbeddedWorld":
        """Return another empty world; see `World`."""

    @abstractmethod
    def close(self) -> None:
        """End the process; see `World`."""

    def _live(self) -> Channel:
        """Return the channel to Node, which is started if none is running."""
        self.check_own("the world")
        if self._closed:
            raise BodyError("this world was closed; open another one")
        if self._channel is None or self._channel.lost:
            if self._channel is not None:
                self._channel.close()
            self._channel = self._started()
        return self._channel

    @abstractmethod
    def _started(self) -> Channel:
        """Start a process and return the channel to it; sets `_versions`."""


class EmbeddedWorld(NodeWorld):
    """World of one Node process.

    Args:
        seed: Seed of the world's own random numbers.
        limits: Limits of Node.
        launch: Node that was started earlier with the same seed and limits; None: start one.
    """

    def __init__(
        self, seed: int, limits: ProcessLimits | None = None, launch: Launch | None = None
    ) -> None:
        super().__init__(seed, limits)
        self._launch = launch
        self._names: set[str] = set()
        self._agents: set[str] = set()

    def open_body(self, name: str, seed: str, snapshot: Snapshot, sink: Sink) -> EmbeddedBody:
        """Create a region, fill it, and let the bots of its agents join.

        If Node has ended, another process is started.
        """
        channel = self._live()
        if name in self._names:
            raise WorldError(f"there is a body {name!r} already")
        # Programs may mention agents that are absent from this belief.
        self.knows(snapshot.agents)
        names, agents = self._names, sorted(self._agents)
        body = EmbeddedBody.opened(
            channel, name, seed, snapshot, sink, agents, lambda: names.discard(name)
        )
        names.add(name)
        return body

    def knows(self, agents: Iterable[str]) -> None:
        """Add agents that programs may mention in any body, also where they are absent."""
        self._agents |= set(agents)

    def another(self) -> "EmbeddedWorld":
        """Return another world with a process of its own."""
        other = EmbeddedWorld(self._seed, self._limits)
        other._agents |= self._agents
        return other

    def close(self) -> None:
        """End the process."""
        self._closed = True
        if self._channel is not None:
            self._channel.close()

    def _started(self) -> Channel:
        launch, self._launch = self._launch, None
        launch = launch or Launch.begin(self._seed, self._limits)
        channel, self._versions = launch.take()
        self._names = set()
        return channel


def _difference(before: Snapshot, after: Snapshot) -> dict[str, Any]:
    """Return the changes from one snapshot to another, as arguments of `apply`."""
    changes = node_messages.terrain_changes(before.blocks, after.blocks, after.box.low)
    replaced = {(x, y, z) for x, y, z, _ in changes}
    gone = before.containers.keys() - after.containers.keys()
    # A container that replaces another one begins empty.
    contents = {
        place: items
        for place, items in after.containers.items()
        if before.containers.get(place) != items or place in replaced
    }
    agents = node_messages.agents_changes(before.agents, after.agents, node_messages.agent_message)
    return {
        **node_messages.signs_message(after.signs),
        "blocks": changes,
        "containers": [
            *node_messages.contents_message(contents),
            *([*place, None] for place in sorted(gone)),
        ],
        "agents": agents,
        "items": node_messages.items_message(after.items),
        "internal_state": after.internal_state,
    }
