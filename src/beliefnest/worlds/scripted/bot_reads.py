"""Reads of programs of the scripted world: of their bot, of other agents, of blocks."""

from collections.abc import Callable, Mapping
from typing import Any

import msgspec

from beliefnest.world.registry import Registry
from beliefnest.world.values import AgentState, Position, block_at
from beliefnest.worlds.protocol import Sensed, SenseSource
from beliefnest.worlds.scripted.world import ScriptedWorld

_EPOCH_MS = 1_704_067_200_000
"""Start of the worlds' time, as in Minecraft's: 2024-01-01, in UTC."""
_TICK_MS = 50
_HEIGHT = 1.8
_TRUTH = {"true": True, "false": False}
"""Values of properties that Minecraft's data have as booleans; all others are texts."""


class BotBody(msgspec.Struct, frozen=True):
    """Agent's body, as a program holds it.

    Attributes:
        name: Name of the agent.
    """

    name: str


class OpenWindow(msgspec.Struct, frozen=True):
    """Contents of a container, or of the bot's inventory.

    Attributes:
        what: What it is, for messages.
        items: Returns its items.
        gives: The method that returns them.
    """

    what: str
    items: Callable[[], Mapping[str, int]]
    gives: str


class BotReads:
    """Everything that one program may read, as of the latest tick that has ended.

    Args:
        world: The world in which its agent acts.
        name: Its agent.
        sense: What it may know of the world.
    """

    def __init__(self, world: ScriptedWorld, name: str, sense: SenseSource) -> None:
        self._world, self.name, self._sense = world, name, sense
        self._sensed: tuple[int, Sensed] | None = None
        self._last: dict[str, AgentState] = {}

    @property
    def now_ms(self) -> int:
        """Time of the world in milliseconds."""
        return _EPOCH_MS + self._world.now * _TICK_MS

    @property
    def agents(self) -> tuple[str, ...]:
        """Names of all agents."""
        return tuple(sorted(self._world.agents))

    @property
    def me(self) -> AgentState:
        """State of the program's own agent."""
        return self._world.agents[self.name]

    def is_there(self, name: str) -> bool:
        """Return True for its own agent, and for others that it perceives."""
        return name == self.name or name in self._now.agents

    def pose(self, name: str) -> AgentState:
        """Return an agent's state, as last perceived."""
        return self.me if name == self.name else self._now.agents.get(name) or self._last[name]

    def state_at(self, cell: Position) -> int | None:
        """Return the state of a block; None outside of the box, and if it is unknown."""
        box = self._world.box
        if cell not in box:
            return None
        x, y, z = (value - low for value, low in zip(cell, box.low, strict=True))
        state = int(self._now.blocks[x, y, z])
        return None if state < 0 else state

    @property
    def _now(self) -> Sensed:
        if self._sensed is None or self._sensed[0] != self._world.now:
            self._sensed = self._world.now, self._sense()
            self._last.update(self._sensed[1].agents)
        return self._sensed[1]

    def member(self, body: BotBody, name: str) -> Any:
        """Return a property of an agent's body for the program; None if there is no such one."""
        at = self.pose(body.name)
        values: dict[str, Any] = {
            "type": "player",
            "name": "player",
            "username": body.name,
            "position": {"$": "v", "c": list(at.position)},
            "yaw": at.yaw,
            "pitch": at.pitch,
            "height": _HEIGHT,
        }
        return values.get(name)

    def block(self, point: tuple[float, float, float]) -> Any:
        """Return the block at a point for the program; None if it knows none there."""
        cell = block_at(point)
        state = self.state_at(cell)
        if state is None:
            return None
        block = {"$": "b", "s": state, "c": list(cell), "l": [0, 0]}
        text = self._now.signs.get(cell, "")
        return {**block, "t": text} if text else block


def state_of(state: int) -> Any:
    """Return what all blocks of a state share, for a program."""
    registry = Registry.load()
    properties = [
        [name, _TRUTH.get(value, value)] for name, value in registry.properties(state).items()
    ]
    named = [["name", registry.name(state)], ["_properties", {"$": "o", "o": properties}]]
    return {"$": "o", "o": named}
