"""A nest for those who view it: what the page reads, and the page in a notebook."""

from typing import TYPE_CHECKING

from beliefnest.nest.face.moment import AtMoment
from beliefnest.nest.face.reader import Reader

if TYPE_CHECKING:
    from beliefnest.viewer.page.notebook import PageView

__all__ = ["Viewing"]


class Viewing(AtMoment):
    """What live and recorded nests have in common for viewers."""

    @property
    def reader(self) -> Reader:
        """What viewers read of the nest, on any of its timelines."""
        return Reader(self._recording)

    def view(self, depth: int = 2, height: int = 720) -> "PageView":
        """The page of the nest as it is when it is first shown, for a notebook's cell.

        Args:
            depth: How deep all beliefs go, 0 to 4.
            height: Of the page, pixels.
        """
        from beliefnest.viewer.page.notebook import PageView

        return PageView(self.reader, depth, height)
