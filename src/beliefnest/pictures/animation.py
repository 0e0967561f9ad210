"""Animations: sequences of figures in one file."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from PIL import Image

from beliefnest.errors import InputError
from beliefnest.pictures.figure import Figure
from beliefnest.pictures.palette import PAPER

_FORMS: Mapping[str, str] = {".gif": "GIF", ".webp": "WEBP"}
_DPI = 110


def check_animated(path: Path) -> str:
    """Return the image format for a file's suffix.

    Raises:
        InputError: The suffix is unknown.
    """
    form = _FORMS.get(path.suffix.lower())
    if form is None:
        raise InputError(
            f"{path} has the ending {path.suffix or '(none)'}; "
            f"animations are written as {', '.join(_FORMS)}"
        )
    return form


def save_animation(figures: Sequence[Figure], milliseconds: Sequence[int], path: Path) -> None:
    """Write figures as an animation that repeats forever.

    Args:
        figures: The figures, in order.
        milliseconds: Duration of each figure.
        path: A `.gif` or `.webp` file; an existing file is replaced.

    Raises:
        InputError: The suffix is unknown, or the file cannot be written.
    """
    form = check_animated(path)
    images = [figure.image(dpi=_DPI) for figure in figures]
    width, height = max(i.width for i in images), max(i.height for i in images)
    pages = [Image.new("RGB", (width, height), PAPER) for _ in images]
    for page, image in zip(pages, images, strict=True):
        page.paste(image, (0, 0))
    if form == "GIF":
        # Use one palette for all frames, so that colours do not flicker.
        colours = pages[-1].quantize(128, dither=Image.Dither.NONE)
        pages = [page.quantize(palette=colours, dither=Image.Dither.NONE) for page in pages]
    first, *others = pages
    try:
        first.save(
            path,
            format=form,
            save_all=True,
            append_images=others,
            duration=list(milliseconds),
            loop=0,
        )
    except OSError as error:
        raise InputError(
            f"the animation {path} cannot be written ({error.strerror or error}); check the path"
        ) from None
