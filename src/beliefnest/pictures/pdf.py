"""PDF writer, with an embedded font."""

import io
from typing import Any

from beliefnest.errors import MissingExtraError
from beliefnest.pictures.lettering import font_bytes, lettered
from beliefnest.pictures.marks import (
    Circle,
    Drawing,
    DrawnMark,
    Lines,
    Pixels,
    Polygon,
    Rectangle,
    Text,
)
from beliefnest.pictures.raster import fields
from beliefnest.world.texts import on_one_line

_NAMES = {False: "LiberationSans", True: "LiberationSans-Bold"}


def pdf_bytes(drawing: Drawing) -> bytes:
    """Return the PDF of a drawing, one page of its size; equal drawings give equal bytes.

    Raises:
        MissingExtraError: reportlab is not installed.
    """
    try:
        from reportlab.pdfbase import pdfmetrics
        from reportlab.pdfbase.ttfonts import TTFont
        from reportlab.pdfgen.canvas import Canvas
    except ImportError:
        raise MissingExtraError(
            "PDF needs reportlab", "pdf", ", or save the figure as .svg or .png"
        ) from None
    for bold, name in _NAMES.items():
        if name in pdfmetrics.getRegisteredFontNames():
            continue
        pdfmetrics.registerFont(TTFont(name, io.BytesIO(font_bytes(bold=bold))))
    out = io.BytesIO()
    size = (drawing.width, drawing.height)
    canvas = Canvas(out, pagesize=size, invariant=1, pageCompression=1)
    canvas.setTitle(on_one_line(drawing.title))
    for mark in drawing.marks:
        _draw(canvas, drawing.height, mark)
    canvas.save()
    return out.getvalue()


def _draw(canvas: Any, height: float, mark: DrawnMark) -> None:
    """Draw a mark on a reportlab canvas, whose y axis points up."""
    match mark:
        case Text():
            _text(canvas, height, mark)
        case Lines():
            _look(canvas, None, mark.stroke, mark.thick, 0)
            canvas.lines([(a, height - b, c, height - d) for (a, b), (c, d) in mark.segments])
        case Rectangle():
            fill, stroke = _look(canvas, mark.fill, mark.stroke, mark.thick, mark.dash)
            place = (mark.x, height - mark.y - mark.height, mark.width, mark.height)
            if mark.radius:
                canvas.roundRect(*place, mark.radius, stroke=stroke, fill=fill)
            else:
                canvas.rect(*place, stroke=stroke, fill=fill)
        case Circle():
            fill, stroke = _look(canvas, mark.fill, mark.stroke, mark.thick, mark.dash)
            canvas.circle(mark.x, height - mark.y, mark.radius, stroke=stroke, fill=fill)
        case Polygon():
            fill, stroke = _look(canvas, mark.fill, mark.stroke, mark.thick, mark.dash)
            path = canvas.beginPath()
            (x, y), *others = mark.points
            path.moveTo(x, height - y)
            for x, y in others:
                path.lineTo(x, height - y)
            if mark.closed:
                path.close()
            canvas.drawPath(path, stroke=stroke, fill=fill)
        case Pixels():
            place = (mark.x, height - mark.y - mark.height, mark.width, mark.height)
            canvas.drawInlineImage(fields(mark), *place)


def _look(
    canvas: Any, fill: str | None, stroke: str | None, thick: float, dash: float
) -> tuple[int, int]:
    """Set colours and line style; return 1 or 0 for fill and for stroke."""
    from reportlab.lib.colors import HexColor

    if fill is not None:
        canvas.setFillColor(HexColor(fill))
    if stroke is not None:
        canvas.setStrokeColor(HexColor(stroke))
        canvas.setLineWidth(thick)
        canvas.setDash([dash, dash] if dash else [])
    return int(fill is not None), int(stroke is not None)


def _text(canvas: Any, height: float, mark: Text) -> None:
    from reportlab.lib.colors import HexColor

    for colour, mode in ((mark.halo, 2), (mark.colour, 0)):
        if colour is None:
            continue
        # The rendering mode of texts is part of the canvas state, so set it for each text.
        canvas.saveState()
        text = canvas.beginText(mark.left, height - mark.y)
        text.setFont(_NAMES[mark.bold], mark.size)
        text.setFillColor(HexColor(colour))
        text.setStrokeColor(HexColor(colour))
        text.setTextRenderMode(mode)
        canvas.setLineWidth(mark.size * 0.28)
        canvas.setLineJoin(1)
        canvas.setDash([])
        text.textOut(lettered(mark.text))
        canvas.drawText(text)
        canvas.restoreState()
