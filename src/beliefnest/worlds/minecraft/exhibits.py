"""Exhibits: views of embodied simulators for visitors, and their places in Minecraft.

An exhibit shows a simulator's state, beyond view distance of reality and of other exhibits. Nothing
happens in it by itself, and no act of visitors reaches a simulator.
"""

from collections.abc import Collection, Iterable, Mapping
from typing import Any, Self

import msgspec

from beliefnest.world.terrain import Terrain
from beliefnest.world.values import AgentState, Box, Items, Position
from beliefnest.worlds.minecraft.channel import Channel
from beliefnest.worlds.minecraft.node_messages import (
    agents_changes,
    blocks_message,
    pose_message,
    terrain_changes,
)

_CHUNK = 16
_GAP_CHUNKS = 64
"""Distance between exhibits: more than twice the largest view distance, 32 chunks."""
_LONGEST_NAME = 16

ExhibitContents = tuple[Items, bool]
"""Known items of a container, and whether they are all."""


class Shown(msgspec.Struct, frozen=True, eq=False):
    """Content of an exhibit.

    Attributes:
        blocks: Block states of the box; unknown blocks are replaced by those that represent them.
        containers: Known contents of containers.
        signs: Texts of the signs that have one.
        agents: Agents whose pose is known, by the displayed name.
    """

    blocks: Terrain
    containers: Mapping[Position, ExhibitContents]
    signs: Mapping[Position, str]
    agents: Mapping[str, AgentState]

    def whole(self, low: Position) -> dict[str, Any]:
        """Return the whole content as a message; `low` is the box's lowest corner."""
        return {
            "blocks": blocks_message(self.blocks, low),
            "containers": _rows(self.containers.items()),
            "signs": [[*place, text] for place, text in sorted(self.signs.items())],
            "agents": {name: pose_message(agent) for name, agent in self.agents.items()},
        }

    def changes(self, before: "Shown", low: Position) -> dict[str, Any] | None:
        """Return the changes as a message, None if there are none; `low` is the box's corner."""
        blocks = terrain_changes(before.blocks, self.blocks, low)
        gone = before.containers.keys() - self.containers.keys()
        contents = [
            (place, content)
            for place, content in self.containers.items()
            if before.containers.get(place) != content
        ]
        agents = agents_changes(before.agents, self.agents, pose_message)
        if not (blocks or gone or contents or agents or before.signs != self.signs):
            return None
        return {
            "blocks": blocks,
            "containers": [*_rows(contents), *([*place, None, False] for place in sorted(gone))],
            "signs": [[*place, text] for place, text in sorted(self.signs.items())],
            "agents": agents,
        }


class Plot(msgspec.Struct, frozen=True):
    """Place of an exhibit.

    Attributes:
        box: Its box, in scenario coordinates.
        origin: Position of scenario (0, y, 0) in Minecraft: x and z.
        stand: Good position for a visitor, in blocks of Minecraft.
    """

    box: Box
    origin: tuple[int, int]
    stand: Position

    @property
    def corners(self) -> tuple[Position, Position]:
        """Corners of the box in Minecraft."""
        (x, z), low, high = self.origin, self.box.low, self.box.high
        return (low[0] + x, low[1], low[2] + z), (high[0] + x, high[1], high[2] + z)


class Exhibit:
    """View of a simulator in Minecraft; opened by `Exhibit.opened`."""

    def __init__(self, channel: Channel, name: str, low: Position, shown: Shown) -> None:
        self._channel = channel
        self._name = name
        self._low = low
        self._shown = shown

    @classmethod
    def opened(cls, channel: Channel, name: str, plot: Plot, shown: Shown) -> Self:
        """Build the exhibit."""
        channel.request(
            "exhibit",
            exhibit=name,
            origin=plot.origin,
            stand=plot.stand,
            box=[plot.box.low, plot.box.high],
            **shown.whole(plot.box.low),
        )
        return cls(channel, name, plot.box.low, shown)

    @property
    def lost(self) -> bool:
        """True if the process that shows the exhibit has ended."""
        return self._channel.lost

    def show(self, shown: Shown, tick: int) -> None:
        """Change the content, as of a tick of reality.

        Only changes are sent, and no answer is awaited.
        """
        changes = shown.changes(self._shown, self._low)
        self._shown = shown
        if changes is not None:
            self._channel.post("show", exhibit=self._name, tick=tick, **changes)

    def close(self) -> None:
        """Remove the exhibit; a server gets its former blocks back."""
        if not self.lost:
            self._channel.request("close_exhibit", exhibit=self._name)


def origin_of(number: int, box: Box, reality: tuple[int, int]) -> tuple[int, int]:
    """Return where scenario (0, y, 0) of the exhibit with a number, from 1, lies: x and z.

    Exhibits stand side by side, away from the border of the world.
    """
    width = (box.high[0] >> 4) - (box.low[0] >> 4) + 1
    step = (width + _GAP_CHUNKS) * _CHUNK * (1 if reality[0] <= 0 else -1)
    return reality[0] + number * step, reality[1]


def display_names(agents: Iterable[str], number: int, taken: Collection[str]) -> dict[str, str]:
    """Return each agent's name in the exhibit with a number: its own name and that number.

    A long name loses letters in its middle. All names differ from each other and from the taken
    ones, also without regard to capitals.
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


def _rows(containers: Iterable[tuple[Position, ExhibitContents]]) -> list[list[Any]]:
    return [[*place, dict(items), complete] for place, (items, complete) in sorted(containers)]
