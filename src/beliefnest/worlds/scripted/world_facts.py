"""Facts of a scripted world, as conditions read them."""

from beliefnest.world.registry import Registry, block_name
from beliefnest.world.signs import is_sign
from beliefnest.world.values import Items, Point, Position
from beliefnest.worlds.scripted.world import ScriptedWorld


class WorldFacts:
    """Facts of a scripted world at its latest tick.

    Args:
        world: The world.
    """

    def __init__(self, world: ScriptedWorld) -> None:
        # The property copies all agents: read it once.
        self._world, self._agents = world, world.agents

    def items_in(self, place: Position) -> Items:
        """Return the items in a container."""
        return self._world.containers.get(self._world.container_at(place), {})

    def is_complete(self, place: Position) -> bool:
        """Return True if there is a container: all is known of a world."""
        return self._world.container_at(place) in self._world.containers

    def items_of(self, agent: str) -> Items:
        """Return the items that an agent has."""
        there = self._agents.get(agent)
        return {} if there is None else there.inventory

    def feet_of(self, agent: str) -> Point | None:
        """Return the position of an agent's feet; None: it is not there."""
        there = self._agents.get(agent)
        return None if there is None else there.position

    def block(self, place: Position) -> str | None:
        """Return the text of a block state."""
        return Registry.load().text(self._world.state_at(place))

    def sign(self, place: Position) -> str | None:
        """Return the text of a sign, empty if it is blank; None: there is none."""
        text = self._world.signs.get(place)
        return "" if text is None and is_sign(block_name(self.block(place) or "")) else text

    def has_heard(self, text: str) -> bool:
        """Return False: a world does not keep what was said in it, only its record does."""
        return False
