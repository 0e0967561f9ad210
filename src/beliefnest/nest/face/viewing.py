"""A nest for those who view it: what the page reads, and the page in a notebook."""

from typing import TYPE_CHECKING

from beliefnest.nest.face.moment import AtMoment
from beliefnest.nest.face.reader import Reader
from beliefnest.nest.face.turns import in_turn

if TYPE_CHECKING:
    from beliefnest.viewer.page.notebook import PageView

__all__ = ["Viewing"]


class Viewing(AtMoment):
    """What live and recorded nests have in common for viewers."""

    @property
    def reader(self) -> Reader:
        """What viewers read of the nest, on any of its timelines."""
        return Reader(self._recording)

    @in_turn
    def kept(self, name: str) -> bytes | None:
        """The bytes that `Nest.keep` kept last under a name; None if there are none."""
        return self._recording.records.state(f"kept {name}")

    def view(self, depth: int = 2, height: int = 720) -> "PageView":
        """The page of the nest as it is when it is first shown, for a notebook's cell.

        An episode's rounds are in it.

        Args:
            depth: How deep all beliefs go, 0 to 4.
            height: Of the page, pixels.
        """
        from beliefnest.episodes.telling import told_episode
        from beliefnest.viewer.page.notebook import PageView

        return PageView(self.reader, depth, height, lambda: told_episode(self))
