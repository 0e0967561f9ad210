"""Protocol of the part that shows beliefs to people in a world that they can join."""

from typing import TYPE_CHECKING, Protocol

from beliefnest.world.paths import BeliefPath

if TYPE_CHECKING:
    from beliefnest.visits.layout import Layout


class Visitable(Protocol):
    """Beliefs of a nest that stand in Minecraft; made by the part `visits`."""

    @property
    def follows(self) -> bool:
        """True if any simulator stands in Minecraft."""

    def begin(self, path: BeliefPath, unknown: str) -> None:
        """Show a simulator in Minecraft; see `Simulator.embody`."""

    def end(self, path: BeliefPath) -> None:
        """Remove a simulator from Minecraft."""

    def keep_up(self) -> None:
        """Bring all embodied simulators up to what is recorded by now."""

    def look_again(self) -> None:
        """Compare all embodied simulators again, because entries were taken back."""

    def layout(self) -> "Layout":
        """Return the places of the real world and of all embodied simulators in Minecraft."""
