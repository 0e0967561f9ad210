"""A scene as a picture: the ground plan, and beside it what everybody believes."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from PIL import Image

from beliefnest.errors import InputError
from beliefnest.viewer import icons
from beliefnest.viewer.canvas import XY, Canvas, Colour, blend
from beliefnest.viewer.icons import AGENT_COLOURS, INK, PAPER
from beliefnest.viewer.plan import Plan
from beliefnest.viewer.scene import Row, Scene
from beliefnest.world.values import Position

__all__ = ["draw_overview", "draw_scene", "save"]

_WIDTH, _HEIGHT = 1280, 880
_MARGIN = 36
_PLAN = 740
_TOP = 100
_ROW = 94
_COLUMN = 380
_GAP = 28
_CHEST_STEP = 80.0
_QUIET: Colour = (112, 110, 118)
_LINE: Colour = (222, 218, 208)
_CARD: Colour = (255, 255, 255)


def draw_scene(scene: Scene) -> Image.Image:
    """The picture of one scene."""
    canvas = Canvas(_WIDTH, _HEIGHT, PAPER)
    colours = _colours(scene)
    canvas.text((_MARGIN, 40), scene.caption.title, 28, INK, bold=True)
    canvas.text((_MARGIN, 74), scene.caption.subtitle, 18, _QUIET)
    Plan(canvas, scene, (_MARGIN, _TOP), _PLAN, colours).draw()
    left = _MARGIN + _PLAN + 36
    bottom = _panel(canvas, scene, (left, _TOP), _WIDTH - _MARGIN - left)
    _legend(canvas, scene, colours, (left, bottom + 18))
    canvas.text((_MARGIN, _TOP + _PLAN + 22), scene.caption.moment, 16, _QUIET)
    return canvas.image


def draw_overview(scenes: Sequence[Scene], title: str) -> Image.Image:
    """Several scenes side by side, with what everybody believes below each."""
    rows = max(len(scene.rows) for scene in scenes)
    measure = Canvas(1, 1, PAPER)
    verdicts = max(
        sum(height + 10 for _, _, height in _verdicts(measure, scene, _COLUMN)) for scene in scenes
    )
    step = _COLUMN + _GAP
    top = 176
    below = top + _COLUMN + 14
    canvas = Canvas(
        2 * _MARGIN + len(scenes) * step - _GAP,
        round(below + rows * _ROW + verdicts + 64),
        PAPER,
    )
    canvas.text((_MARGIN, 40), title, 28, INK, bold=True)
    for number, scene in enumerate(scenes):
        left = _MARGIN + number * step
        canvas.text((left, 92), scene.caption.title, 19, INK, bold=True)
        for line, text in enumerate(canvas.wrapped(scene.caption.subtitle, 16, _COLUMN)):
            canvas.text((left, 120 + 21 * line), text, 16, _QUIET)
        colours = _colours(scene)
        Plan(canvas, scene, (left, top), _COLUMN, colours, brief=True).draw()
        _panel(canvas, scene, (left, below), _COLUMN)
    _sight_legend(
        canvas, scenes[0], _colours(scenes[0]), (_MARGIN, canvas.height - 44), across=True
    )
    return canvas.image


def save(image: Image.Image, path: Path) -> None:
    """Write a picture as PNG; the same picture gives the same bytes.

    Raises:
        InputError: The file cannot be written.
    """
    try:
        image.save(path, format="PNG")
    except OSError as error:
        raise InputError(
            f"the picture {path} cannot be written ({error.strerror or error}); check the path"
        ) from None


def _colours(scene: Scene) -> Mapping[str, Colour]:
    """The innermost viewer in the first colour, the outermost in the second, then the others."""
    viewers = [view.name for view in scene.views][::-1]
    names = viewers + [p.name for p in scene.people if p.name not in viewers]
    return {name: AGENT_COLOURS[n % len(AGENT_COLOURS)] for n, name in enumerate(names)}


def _panel(canvas: Canvas, scene: Scene, corner: XY, width: float) -> float:
    """What everybody believes, and what came of it; returns where it ends."""
    left, top = corner
    places = sorted(scene.containers)
    for row in scene.rows:
        _row(canvas, row, places, scene.labels, (left, top), width)
        top += _ROW
    for lines, ok, height in _verdicts(canvas, scene, width):
        canvas.box((left, top), (left + width, top + height), blend(PAPER, INK, 0.06), None, 1, 8)
        for number, line in enumerate(lines):
            canvas.text((left + 16, top + 22 + 22 * number), line, 17, INK, bold=True)
        if ok is not None:
            icons.mark(canvas, (left + width - 28, top + height / 2), 24, ok)
        top += height + 10
    return top


def _verdicts(
    canvas: Canvas, scene: Scene, width: float
) -> list[tuple[list[str], bool | None, float]]:
    """Lines, mark and height of what came of each prediction."""
    found = []
    for text, ok in scene.caption.verdicts:
        lines = canvas.wrapped(text, 17, width - 64)
        found.append((lines, ok, 22.0 * len(lines) + 22))
    return found


def _row(
    canvas: Canvas,
    row: Row,
    places: Sequence[Position],
    labels: Mapping[Position, str],
    corner: XY,
    width: float,
) -> None:
    left, top = corner
    shown = places[: max(1, int((width - 150) // _CHEST_STEP))]
    canvas.box((left, top), (left + width, top + _ROW - 10), _CARD, _LINE, 1.2, 8)
    label_width = width - 40 - _CHEST_STEP * len(shown)
    for number, line in enumerate(canvas.wrapped(row.label, 16, label_width)):
        canvas.text((left + 14, top + 22 + 19 * number), line, 16, INK, bold=True)
    canvas.text((left + 14, top + _ROW - 26), row.path, 13, _QUIET)
    beside = left + 14 + canvas.text_width(row.path, 13) + 34
    for number, note in enumerate(reversed(row.notes)):
        canvas.text((beside, top + _ROW - 26 - 18 * number), note, 14, INK)
    if row.ok is not None:
        at = (left + 14 + canvas.text_width(row.path, 13) + 16, top + _ROW - 26)
        icons.mark(canvas, at, 14, row.ok)
    first = left + width - 48 - _CHEST_STEP * (len(shown) - 1)
    for number, place in enumerate(shown):
        centre = (first + number * _CHEST_STEP, top + 46)
        _contents(canvas, row, place, centre)
        canvas.text((centre[0], top + 73), labels.get(place, str(place)), 12, _QUIET, "mm")


def _contents(canvas: Canvas, row: Row, place: Position, centre: XY) -> None:
    """A chest with what is known to be in it."""
    icons.chest(canvas, centre, 33)
    held = row.contents.get(place)
    if held:
        for index, name in enumerate(sorted(held)):
            icons.item(canvas, (centre[0] + index * 16, centre[1] - 17), 24, name)
    elif place not in row.complete:
        canvas.text((centre[0], centre[1] - 24), "?", 18, _QUIET, "mm", bold=True)
    else:
        canvas.text((centre[0], centre[1] - 24), "empty", 12, _QUIET, "mm")


def _sight_legend(
    canvas: Canvas, scene: Scene, colours: Mapping[str, Colour], corner: XY, *, across: bool = False
) -> XY:
    """What the tints mean; returns where the next line of the legend goes."""
    left, top = corner
    for number, view in enumerate(scene.views):
        colour = colours[view.name]
        low, high = (left, top), (left + 26, top + 18)
        canvas.box(low, high, blend(PAPER, colour, 0.28 if number == 0 else 0.0), colour, 1, 2)
        if number:
            for x in range(4, 26, 7):
                canvas.line([(left + x, top + 17), (left + min(26, x + 8), top + 6)], colour, 1.4)
        text = f"what {view.name} can see at this moment"
        canvas.text((left + 38, top + 9), text, 15, INK)
        if across:
            left += 66 + canvas.text_width(text, 15)
        else:
            top += 27
    return left, top


def _legend(canvas: Canvas, scene: Scene, colours: Mapping[str, Colour], corner: XY) -> None:
    left, top = _sight_legend(canvas, scene, colours, corner)
    canvas.dashes([(left, top + 9), (left + 26, top + 9)], _QUIET, 2.2, 5)
    canvas.text((left + 38, top + 9), "the way an agent has gone", 15, INK)
    top += 27
    canvas.text((left + 13, top + 9), "?", 18, _QUIET, "mm", bold=True)
    canvas.text((left + 38, top + 9), "nothing is known to be inside", 15, INK)
    top += 40
    for number, step in enumerate(scene.caption.story):
        for line, text in enumerate(canvas.wrapped(step, 15, _WIDTH - _MARGIN - left - 24)):
            if line == 0:
                canvas.text((left, top + 9), f"{number + 1}", 15, _QUIET)
            canvas.text((left + 22, top + 9), text, 15, _QUIET)
            top += 21
