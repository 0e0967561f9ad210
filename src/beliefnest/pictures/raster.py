"""Raster writer: a drawing as an image of pixels, by resvg from the drawing's SVG."""

import io
from importlib.resources import as_file, files

from PIL import Image

from beliefnest.pictures.lettering import lettered
from beliefnest.pictures.marks import Drawing
from beliefnest.pictures.palette import PAPER
from beliefnest.pictures.svg import svg_text

__all__ = ["raster"]

_FAMILY = "Liberation Sans"


def raster(drawing: Drawing, dpi: float) -> Image.Image:
    """Return the image of a drawing with a resolution of `dpi` pixels per inch."""
    import resvg_py

    with as_file(files("beliefnest.pictures") / "fonts") as fonts:
        png = resvg_py.svg_to_bytes(
            svg_string=lettered(svg_text(drawing)),
            dpi=dpi,
            background=PAPER,
            # The drawing's own font alone, so that a picture is the same on every machine.
            skip_system_fonts=True,
            font_dirs=[str(fonts)],
            font_family=_FAMILY,
            sans_serif_family=_FAMILY,
        )
    return Image.open(io.BytesIO(png)).convert("RGB")
