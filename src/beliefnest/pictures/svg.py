"""SVG writer: text stays text, fitted to the width that was measured for it."""

import base64
from xml.etree import ElementTree

from beliefnest.pictures.lettering import FAMILIES
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
from beliefnest.world.texts import on_one_line

_MILLIMETRES = 25.4 / 72


def svg_text(drawing: Drawing, *, inline: bool = False) -> str:
    """Return the SVG of a drawing.

    Args:
        drawing: The drawing.
        inline: True if it becomes part of a page. It then takes the available width, at most its
            own width in pixels of 1/96 inch.
    """
    width, height = drawing.width, drawing.height
    root = ElementTree.Element(
        "svg",
        {
            "xmlns": "http://www.w3.org/2000/svg",
            "viewBox": f"0 0 {_n(width)} {_n(height)}",
            "role": "img",
            "font-family": FAMILIES,
        },
    )
    if inline:
        root.set("style", f"width:100%;max-width:{_n(width * 96 / 72)}px;height:auto")
    else:
        root.set("width", f"{_n(width * _MILLIMETRES)}mm")
        root.set("height", f"{_n(height * _MILLIMETRES)}mm")
    if drawing.title:
        title = _clean(on_one_line(drawing.title))
        root.set("aria-label", title)
        ElementTree.SubElement(root, "title").text = title
    for mark in drawing.marks:
        _add(root, mark)
    return ElementTree.tostring(root, encoding="unicode")


def _add(root: ElementTree.Element, mark: DrawnMark) -> None:
    match mark:
        case Rectangle():
            sides = {"x": mark.x, "y": mark.y, "width": mark.width, "height": mark.height}
            shape = _shape(root, "rect", sides, mark)
            if mark.radius:
                shape.set("rx", _n(mark.radius))
        case Circle():
            _shape(root, "circle", {"cx": mark.x, "cy": mark.y, "r": mark.radius}, mark)
        case Polygon():
            shape = _shape(root, "polygon" if mark.closed else "polyline", {}, mark)
            shape.set("points", " ".join(f"{_n(x)},{_n(y)}" for x, y in mark.points))
        case Lines():
            path = "".join(f"M{_n(a)} {_n(b)}L{_n(c)} {_n(d)}" for (a, b), (c, d) in mark.segments)
            look = {"d": path, "stroke": mark.stroke, "stroke-width": _n(mark.thick)}
            ElementTree.SubElement(root, "path", look)
        case Text():
            _text(root, mark)
        case Pixels():
            _pixels(root, mark)


def _pixels(root: ElementTree.Element, mark: Pixels) -> None:
    # Most drawings have none, and Pillow takes long to import.
    from beliefnest.pictures.raster import fields, png_bytes

    place = {"x": mark.x, "y": mark.y, "width": mark.width, "height": mark.height}
    image = ElementTree.SubElement(root, "image", {key: _n(at) for key, at in place.items()})
    image.set("preserveAspectRatio", "none")
    image.set("style", "image-rendering:pixelated")
    picture = base64.b64encode(png_bytes(fields(mark), 9)).decode()
    image.set("href", f"data:image/png;base64,{picture}")


def _shape(
    root: ElementTree.Element, tag: str, sizes: dict[str, float], mark: Rectangle | Circle | Polygon
) -> ElementTree.Element:
    shape = ElementTree.SubElement(root, tag, {key: _n(value) for key, value in sizes.items()})
    shape.set("fill", mark.fill or "none")
    if mark.stroke is not None:
        shape.set("stroke", mark.stroke)
        shape.set("stroke-width", _n(mark.thick))
        if mark.dash:
            shape.set("stroke-dasharray", _n(mark.dash))
    return shape


def _text(root: ElementTree.Element, mark: Text) -> None:
    if not mark.text:
        return
    look = {
        "x": _n(mark.left),
        "y": _n(mark.y),
        "font-size": _n(mark.size),
        "fill": mark.colour,
        "textLength": _n(mark.width),
        "lengthAdjust": "spacingAndGlyphs",
    }
    if mark.bold:
        look["font-weight"] = "bold"
    if mark.halo is not None:
        look |= {
            "stroke": mark.halo,
            "stroke-width": _n(mark.size * 0.28),
            "stroke-linejoin": "round",
            "paint-order": "stroke",
        }
    ElementTree.SubElement(root, "text", look).text = _clean(mark.text)


def _clean(text: str) -> str:
    """Remove characters that XML cannot contain."""
    return "".join(c if c.isprintable() else "\ufffd" for c in text)


def _n(value: float) -> str:
    """Format a number as short as the accuracy of positions allows."""
    return f"{value:.2f}".rstrip("0").rstrip(".") or "0"
