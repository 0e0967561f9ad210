"""Layout of a study's figure: texts that do not overlap at any size. Needs matplotlib."""

import itertools
import math
import textwrap
from collections.abc import Sequence
from typing import Any, cast

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import LayoutEngine, TightLayoutEngine
from matplotlib.transforms import Bbox

_NARROW = 4.5
"""Width in inches below which texts are small and the legend is above the bars."""
_LARGE, _SMALL = 10.0, 7.0
"""Font sizes in points."""
_FORMS = ((False, 0), (True, 0), (False, 45), (False, 90))
"""Forms of the texts below bars, as pairs: True if texts may have several lines, and their rotation
in degrees. The layout uses the first form in which texts do not overlap."""
_HEADINGS = ("accuracy, 95 % interval", "accuracy")


class Fitting(LayoutEngine):
    """Layout engine that fits all texts into a figure of one plot each time it is drawn.

    Args:
        texts: Texts below the bars.
    """

    _adjust_compatible = True
    _colorbar_gridspec = True

    def __init__(self, texts: Sequence[str]) -> None:
        super().__init__()
        self._texts = tuple(texts)

    def execute(self, fig: Figure) -> None:
        """Set the sizes, forms and positions of all texts."""
        (axes,) = fig.axes
        narrow = fig.get_figwidth() < _NARROW
        size = _SMALL if narrow else _LARGE
        for label in (axes.xaxis.label, axes.yaxis.label):
            label.set_fontsize(size)
        axes.tick_params(labelsize=size)
        _place_legend(axes, fig, size, narrow=narrow)
        axes.set_ylabel(_HEADINGS[0])
        for several_lines, degrees in _FORMS:
            self._form(axes, several_lines=several_lines, degrees=degrees)
            TightLayoutEngine().execute(fig)
            if axes.yaxis.label.get_window_extent().height > axes.get_window_extent().height:
                axes.set_ylabel(_HEADINGS[1])
                TightLayoutEngine().execute(fig)
            if not _overlap(axes, degrees):
                break

    def _form(self, axes: Axes, *, several_lines: bool, degrees: int) -> None:
        texts = self._texts
        labels = axes.get_xticklabels()
        if several_lines and labels:
            slot = axes.get_window_extent().width / len(texts)
            size = cast(float, labels[0].get_fontsize()) / 72 * _dpi(axes)
            texts = tuple(_wrapped(text, int(slot / (0.6 * size))) for text in texts)
        axes.set_xticks(range(len(texts)), texts)
        for label in axes.get_xticklabels():
            label.set_rotation(degrees)
            label.set_horizontalalignment("right" if degrees == 45 else "center")
            label.set_rotation_mode("anchor" if degrees == 45 else "default")


def _dpi(axes: Axes) -> float:
    return cast(Any, axes.figure).dpi  # type: ignore[no-any-return]


def _wrapped(text: str, letters: int) -> str:
    """Break a text into lines, at spaces, hyphens and colons."""
    lines = textwrap.wrap(text.replace(":", ": "), max(1, letters), break_long_words=False)
    return "\n".join(line.replace(": ", ":") for line in lines)


def _place_legend(axes: Axes, figure: Figure, size: float, *, narrow: bool) -> None:
    """Put the legend beside the bars, or in a narrow figure above them."""
    legend = axes.get_legend()
    if legend is None:
        return
    title, count = legend.get_title().get_text(), len(legend.get_texts())
    for columns in range(count, 0, -1) if narrow else (1,):
        legend = axes.legend(
            title=title,
            frameon=False,
            fontsize=size,
            title_fontsize=size,
            ncols=columns,
            loc="lower left" if narrow else "upper left",
            # Position of the legend's corner, as fractions of the axes.
            bbox_to_anchor=(0.0, 1.0) if narrow else (1.0, 1.0),
        )
        if legend.get_window_extent().width < 0.75 * figure.bbox.width:
            break


def _overlap(axes: Axes, degrees: int) -> bool:
    """Return True if texts below bars overlap each other or the heading, or are cut off."""
    labels = axes.get_xticklabels()
    boxes = [label.get_window_extent() for label in labels]
    heading = axes.yaxis.label.get_window_extent()
    if any(box.x0 < 0 or Bbox.intersection(box, heading) is not None for box in boxes):
        return True
    pairs = itertools.pairwise(boxes)
    dpi = _dpi(axes)
    if not degrees:
        return any(one.x1 + 0.04 * dpi > other.x0 for one, other in pairs)
    # Rotated texts are parallel lines: their distance must be at least their height.
    height = 1.2 * cast(float, labels[0].get_fontsize()) / 72 * dpi
    return any(
        (other.x1 - one.x1) * math.sin(math.radians(degrees)) < height for one, other in pairs
    )
