"""What embodied simulators show to people who visit them, and where.

An exhibit stands in Minecraft as a simulator's state says, beyond view distance of reality and of
other exhibits. Nothing happens in it by itself, and nothing people do there reaches a simulator.
"""

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from beliefnest.bodies.channel import Channel
from beliefnest.bodies.messages import pose_message
from beliefnest.world.frames import BlockGrid
from beliefnest.world.values import AgentState, Box, Items, Position

__all__ = ["Exhibit", "Plot", "Shown", "display_names", "origin_of"]

_CHUNK = 16
_GAP_CHUNKS = 64
"""Between two exhibits: more than twice what a game shows at most, 32 chunks."""
_LONGEST_NAME = 16

Contents = tuple[Items, bool]
"""What is known to be in a container, and whether that is all."""


@dataclass(frozen=True, eq=False)
class Shown:
    """What there is to be seen in an exhibit.

    Attributes:
        blocks: Block states of the box; what is unknown is already what it is to be shown as.
        containers: What is known of contents.
        signs: Texts of those that are written on.
        agents: Who is known to be where, by the name that is shown.
    """

    blocks: BlockGrid
    containers: Mapping[Position, Contents]
    signs: Mapping[Position, str]
    agents: Mapping[str, AgentState]

    def whole(self) -> dict[str, Any]:
        """Return all of it as a message."""
        return {
            "blocks": self.blocks.astype("<i4").tobytes(),
            "containers": _rows(self.containers.items()),
            "signs": [[*place, text] for place, text in sorted(self.signs.items())],
            "agents": {name: pose_message(agent) for name, agent in self.agents.items()},
        }

    def changes(self, before: "Shown", low: Position) -> dict[str, Any] | None:
        """What differs from before as a message, None if nothing; `low` is the box's corner."""
        places = np.argwhere(before.blocks != self.blocks).tolist()
        gone = before.containers.keys() - self.containers.keys()
        contents = [
            (place, held)
            for place, held in self.containers.items()
            if before.containers.get(place) != held
        ]
        agents: dict[str, Any] = dict.fromkeys(sorted(before.agents.keys() - self.agents.keys()))
        for name, agent in self.agents.items():
            if before.agents.get(name) != agent:
                agents[name] = pose_message(agent)
        if not (places or gone or contents or agents or before.signs != self.signs):
            return None
        return {
            "blocks": [
                [low[0] + i, low[1] + j, low[2] + k, int(self.blocks[i, j, k])]
                for i, j, k in places
            ],
            "containers": [*_rows(contents), *([*place, None, False] for place in sorted(gone))],
            "signs": [[*place, text] for place, text in sorted(self.signs.items())],
            "agents": agents,
        }


@dataclass(frozen=True, slots=True)
class Plot:
    """Where an exhibit stands.

    Attributes:
        box: Its box, in scenario coordinates.
        origin: Where scenario (0, y, 0) lies in Minecraft: x and z.
        stand: Where one stands well among what it shows, in blocks of Minecraft.
    """

    box: Box
    origin: tuple[int, int]
    stand: Position

    @property
    def corners(self) -> tuple[Position, Position]:
        """Its box's corners in Minecraft."""
        (x, z), low, high = self.origin, self.box.low, self.box.high
        return (low[0] + x, low[1], low[2] + z), (high[0] + x, high[1], high[2] + z)


class Exhibit:
    """What a simulator holds, as it stands in Minecraft; open one with `Exhibit.opened`."""

    def __init__(self, channel: Channel, name: str, low: Position, shown: Shown) -> None:
        self._channel = channel
        self._name = name
        self._low = low
        self._shown = shown

    @classmethod
    def opened(cls, channel: Channel, name: str, plot: Plot, shown: Shown) -> Self:
        """Build it."""
        channel.request(
            "exhibit",
            exhibit=name,
            origin=plot.origin,
            stand=plot.stand,
            box=[plot.box.low, plot.box.high],
            **shown.whole(),
        )
        return cls(channel, name, plot.box.low, shown)

    @property
    def lost(self) -> bool:
        """True if the process that shows it has ended."""
        return self._channel.lost

    def show(self, shown: Shown, tick: int) -> None:
        """Let it be this, as of a tick of reality.

        Only what is another than before is sent, and no answer awaited.
        """
        changes = shown.changes(self._shown, self._low)
        self._shown = shown
        if changes is not None:
            self._channel.post("show", exhibit=self._name, tick=tick, **changes)

    def close(self) -> None:
        """Take it down; on a server there is again what was there before."""
        if not self.lost:
            self._channel.request("close_exhibit", exhibit=self._name)


def origin_of(number: int, box: Box, reality: tuple[int, int]) -> tuple[int, int]:
    """Where scenario (0, y, 0) of the exhibit of a number, from 1, lies in Minecraft: x and z.

    Exhibits stand side by side, away from the border of the world.
    """
    width = (box.high[0] >> 4) - (box.low[0] >> 4) + 1
    step = (width + _GAP_CHUNKS) * _CHUNK * (1 if reality[0] <= 0 else -1)
    return reality[0] + number * step, reality[1]


def display_names(agents: Iterable[str], number: int, taken: Collection[str]) -> dict[str, str]:
    """Return the name that each agent has in the exhibit of a number: its own, with that number.

    A long one loses letters in its middle. No two are the same, and none is a taken one, capitals
    or not.
    """
    names: dict[str, str] = {}
    used = {name.lower() for name in taken}
    for agent in sorted(agents):
        for end in _ends(number):
            name = _shortened(agent, _LONGEST_NAME - len(end)) + end
            if name.lower() not in used:
                break
        used.add(name.lower())
        names[agent] = name
    return names


def _ends(number: int) -> Iterable[str]:
    yield f"_{number}"
    for more in range(1, _LONGEST_NAME**3):
        yield f"_{number}_{more}"


def _shortened(name: str, length: int) -> str:
    if len(name) <= length:
        return name
    end = length // 2
    return name[: length - end] + name[-end:]


def _rows(containers: Iterable[tuple[Position, Contents]]) -> list[list[Any]]:
    return [[*place, dict(items), complete] for place, (items, complete) in sorted(containers)]
