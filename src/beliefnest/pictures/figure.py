"""Figures: drawings that can be laid out for any width and saved in several formats."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from beliefnest.errors import InputError
from beliefnest.files import replace_file
from beliefnest.pictures.bars import BarChart, draw_bars
from beliefnest.pictures.legend import draw_legend
from beliefnest.pictures.marks import XY, Drawing, scaled
from beliefnest.pictures.marks import DrawnMark as Drawn
from beliefnest.pictures.palette import agent_looks
from beliefnest.pictures.panel import draw_panel, draw_title
from beliefnest.pictures.plan import SignKind
from beliefnest.pictures.scene import Scene
from beliefnest.pictures.svg import svg_text

if TYPE_CHECKING:  # Most figures are drawn without it.
    from PIL import Image

Size = float | tuple[float, float] | Literal["one column", "two columns"]
"""Width, or greatest width and height, in millimetres; or the column width of a paper."""

TEXT_SIZE = 7.0
"""Size of texts in figures, in points."""
MARGIN = 5.0
"""Margin around figures, in points."""

_POINTS = 72 / 25.4
_COLUMNS: Mapping[str, float] = {"one column": 84.0, "two columns": 174.0}
_NARROWEST = 20.0
_WIDEST = 2000.0
_PANEL = 104.0
"""Least width of a panel, in points."""
_GAP = 9.0


class Figure:
    """A figure that can be laid out for any width.

    Args:
        layout: Function that returns the drawing for a width in points.
        width: Default width in millimetres.
        about: Short description of the content.
    """

    def __init__(self, layout: Callable[[float], Drawing], width: float, about: str) -> None:
        self._layout = layout
        self._width = width
        self._about = about

    def __repr__(self) -> str:
        return f"<figure of {self._about}; save() writes .svg, .pdf or .png>"

    def _repr_html_(self) -> str:
        return svg_text(self.drawing(), inline=True)

    def drawing(self, size: Size | None = None) -> Drawing:
        """Return the marks of the figure.

        Args:
            size: Width in millimetres; or width and greatest height, to which the figure is
                scaled down; or `one column` (84 mm) or `two columns` (174 mm) of a paper; None
                for the default width.

        Raises:
            InputError: The size is invalid.
        """
        if isinstance(size, tuple):
            width, height = (_length(part) for part in size)
            return self._fitting(width * _POINTS, height * _POINTS)
        if isinstance(size, str):
            if size not in _COLUMNS:
                names = " or ".join(repr(name) for name in _COLUMNS)
                raise InputError(f"unknown size {size!r}; give millimetres, {names}")
            return self._layout(_COLUMNS[size] * _POINTS)
        return self._layout(_length(self._width if size is None else size) * _POINTS)

    def image(self, size: Size | None = None, dpi: float = 200) -> "Image.Image":
        """Return the figure as an image of pixels."""
        from beliefnest.pictures.raster import raster

        return raster(self.drawing(size), dpi)

    def save(self, path: str | Path, size: Size | None = None, dpi: float = 200) -> None:
        """Write the figure as SVG, PDF or PNG, by the suffix of the file's name.

        The same figure gives the same bytes. Texts in SVG and PDF can be selected.

        Args:
            path: Output file; an existing file is replaced.
            size: As for `drawing`.
            dpi: Pixels per inch of a PNG file.

        Raises:
            InputError: The suffix or the size is invalid, or the file cannot be written.
            MissingExtraError: It is a PDF, and reportlab is not installed.
        """
        file = Path(path)
        ending = file.suffix.lower()
        if ending not in _FORMS:
            raise InputError(
                f"{file} has the ending {file.suffix or '(none)'!s}; "
                f"figures are written as {', '.join(_FORMS)}"
            )
        content = _FORMS[ending](self.drawing(size), dpi)
        try:
            replace_file(file, content)
        except OSError as error:
            raise InputError(
                f"the figure {file} cannot be written ({error.strerror or error}); check the path"
            ) from None

    def _fitting(self, width: float, height: float) -> Drawing:
        """Lay the figure out at growing widths until its proportions fit, then scale it down."""
        factor = 1.0
        drawing = self._layout(width)
        while drawing.height > height * factor and factor < 8:
            factor *= 1.1
            drawing = self._layout(width * factor)
        return scaled(drawing, 1 / max(factor, drawing.height / height))


def figure_of(scenes: Sequence[Scene], chart: BarChart | None = None) -> Figure:
    """Return a figure of simulators side by side, as many in a row as fit.

    Args:
        scenes: Scenes of the simulators.
        chart: A posterior to draw after them, or None.
    """
    paths = ", ".join(scene.path for scene in scenes)
    about = f"{paths} at tick {scenes[0].tick}"
    panels: list[Scene | BarChart] = [*scenes, *([] if chart is None else [chart])]
    width = _COLUMNS["one column" if len(panels) == 1 else "two columns"]
    return Figure(lambda points: _side_by_side(panels, points, about), width, about)


def columns_for(count: int, width: float, least: float) -> int:
    """Return how many of `count` equal columns to put in a row, so that rows are balanced."""
    most = max(1, int((width + _GAP) // (least + _GAP)))
    rows = -(-count // min(most, count))
    return -(-count // rows)


def _side_by_side(panels: Sequence[Scene | BarChart], width: float, about: str) -> Drawing:
    scenes = [each for each in panels if isinstance(each, Scene)]
    looks = agent_looks(scenes[0].agents)
    columns = columns_for(len(panels), width - 2 * MARGIN, _PANEL)
    wide = (width - 2 * MARGIN - _GAP * (columns - 1)) / columns
    marks: list[Drawn] = []
    kinds: set[SignKind] = set()
    bottom = MARGIN
    for start in range(0, len(panels), columns):
        row = panels[start : start + columns]
        top = bottom + (_GAP if start else 0)
        heads = [
            draw_title(each, (MARGIN, top), wide, TEXT_SIZE).bottom
            for each in row
            if isinstance(each, Scene)
        ]
        for number, each in enumerate(row):
            at: XY = (MARGIN + number * (wide + _GAP), top)
            if isinstance(each, Scene):
                panel = draw_panel(each, looks, at, wide, TEXT_SIZE, max(heads) + 1.5)
            else:
                panel = draw_bars(each, at, wide, TEXT_SIZE)
            marks += panel.marks
            kinds |= panel.kinds
            bottom = max(bottom, panel.bottom)
    legend = draw_legend(kinds, looks, (MARGIN, bottom + 4), width - 2 * MARGIN, TEXT_SIZE * 0.95)
    return Drawing(width, legend.bottom + MARGIN, (*marks, *legend.marks), about)


def _length(value: object) -> float:
    if isinstance(value, int | float) and _NARROWEST <= value <= _WIDEST:
        return float(value)
    raise InputError(
        f"{value!r} is not a valid length of a figure; give {_NARROWEST:g} to {_WIDEST:g} "
        "millimetres"
    )


def _svg(drawing: Drawing, _: float) -> bytes:
    return svg_text(drawing).encode()


def _pdf(drawing: Drawing, _: float) -> bytes:
    from beliefnest.pictures.pdf import pdf_bytes

    return pdf_bytes(drawing)


def _png(drawing: Drawing, dpi: float) -> bytes:
    from beliefnest.pictures.raster import png_bytes, raster

    return png_bytes(raster(drawing, dpi), dpi=(dpi, dpi))


_FORMS: Mapping[str, Callable[[Drawing, float], bytes]] = {".svg": _svg, ".pdf": _pdf, ".png": _png}
