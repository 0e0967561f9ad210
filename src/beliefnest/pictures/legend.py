"""Legend of a figure, with only the signs that the figure contains."""

from collections.abc import Callable, Iterable, Mapping

from beliefnest.pictures import icons
from beliefnest.pictures.lettering import ASCENT, text_width
from beliefnest.pictures.marks import XY, Circle, Lines, Polygon, Rectangle, Text
from beliefnest.pictures.marks import DrawnMark as Drawn
from beliefnest.pictures.palette import INK, MARKS, PAPER, QUIET, AgentLook, Mark, mix
from beliefnest.pictures.panel import PanelBlock
from beliefnest.pictures.plan import HeatSign, SightSign, SignKind, hatching, heat_colour
from beliefnest.pictures.scene import Device, Store

_GROUND = "#f0ece3"


def draw_legend(
    kinds: Iterable[SignKind],
    looks: Mapping[str, AgentLook],
    at: XY,
    width: float,
    size: float,
    words: Mapping[SignKind, str] | None = None,
) -> PanelBlock:
    """Draw signs with their meanings, as many in a line as fit.

    Args:
        kinds: Signs to explain.
        looks: Looks of all agents.
        at: Upper left corner, in points.
        width: Width in points.
        size: Size of the text in points.
        words: Meanings of signs that replace the usual ones.
    """
    left, top = at
    block = PanelBlock(bottom=top)
    x = left
    height = size * 1.2
    for kind in sorted(kinds, key=_order):
        sign, usual = _entry(kind, looks)
        meaning = (words or {}).get(kind, usual)
        wide = height * 1.5
        taken = wide + 2 + text_width(meaning, size)
        if x > left and x + taken > left + width:
            x, block.bottom = left, block.bottom + height * 1.45
        block.marks += sign((x, block.bottom), wide, height)
        base = block.bottom + height / 2 + size * ASCENT * 0.48
        block.marks.append(Text(x + wide + 2, base, meaning, size, QUIET))
        x += taken + size * 1.5
    block.bottom += height if x > left else 0
    return block


_Sign = Callable[[XY, float, float], list[Drawn]]
_KINDS = (
    HeatSign,
    SightSign,
    "remembered",
    "told",
    "false",
    "unknown blocks",
    "container",
    "trail",
)


def _order(kind: SignKind) -> tuple[int, SignKind]:
    what = kind if isinstance(kind, str) else type(kind)
    return _KINDS.index(what) if what in _KINDS else len(_KINDS), kind


def _entry(kind: SignKind, looks: Mapping[str, AgentLook]) -> tuple[_Sign, str]:
    if isinstance(kind, SightSign):
        return _sight_sign(kind.number, looks[kind.name].colour), f"seen by {kind.name}"
    if isinstance(kind, HeatSign):
        return _heat, f"{kind.words}: 1, 10, 50, 100 %"
    if kind in _SIGNS:
        return _SIGNS[kind]
    return _device_sign(kind), kind.replace("_", " ")


def _sight_sign(number: int, colour: str) -> _Sign:
    def drawn(at: XY, wide: float, high: float) -> list[Drawn]:
        x, y = at
        if number == 0:
            return [Rectangle(x, y, wide, high, mix(_GROUND, colour, 0.3), colour, 0.4)]
        lines = hatching((x, y, x + wide, y + high), number)
        return [
            Rectangle(x, y, wide, high, _GROUND, colour, 0.4),
            Lines(lines, mix(_GROUND, colour, 0.8), 0.5),
        ]

    return drawn


def _heat(at: XY, wide: float, high: float) -> list[Drawn]:
    x, y = at
    part = wide / 4
    return [
        Rectangle(x + part * number, y, part, high, heat_colour(share))
        for number, share in enumerate((0.01, 0.1, 0.5, 1.0))
    ]


def _device_sign(kind: str) -> _Sign:
    def drawn(at: XY, wide: float, high: float) -> list[Drawn]:
        x, y = at
        shown = Device((0, 0, 0), kind, on=False, parts=((0.0, 0.8, 1.0, 1.0),))
        return icons.device((x + (wide - high) / 2, y), high, shown)

    return drawn


def _remembered(at: XY, wide: float, high: float) -> list[Drawn]:
    middle = (at[0] + wide / 2, at[1] + high / 2)
    return [Circle(*middle, high / 2, mix(PAPER, QUIET, 0.2), INK, 0.7, high * 0.2)]


def _false(at: XY, wide: float, high: float) -> list[Drawn]:
    return icons.false_sign((at[0] + wide / 2, at[1] + high / 2), high * 0.36)


def _told(at: XY, wide: float, high: float) -> list[Drawn]:
    return icons.hearsay((at[0] + wide / 2, at[1] + high * 0.42), high * 0.42)


def _unknown(at: XY, wide: float, high: float) -> list[Drawn]:
    x, y = at
    dots = [
        ((x + wide * a - 0.4, y + high * b), (x + wide * a + 0.4, y + high * b))
        for a in (0.2, 0.5, 0.8)
        for b in (0.3, 0.7)
    ]
    return [Rectangle(x, y, wide, high, _GROUND), Lines(tuple(dots), QUIET, 0.8)]


def _container(at: XY, wide: float, high: float) -> list[Drawn]:
    x, y = at
    store = Store((0, 0, 0), "chest", "", {}, False, Mark.UNKNOWN, 0, "", 0)
    return icons.container((x + wide / 2, y + high / 2), high, store)


def _trail(at: XY, wide: float, high: float) -> list[Drawn]:
    x, y = at
    ends = ((x, y + high / 2), (x + wide, y + high / 2))
    return [Polygon(ends, None, QUIET, 0.9, 2.2, closed=False, role="line")]


def _moved(at: XY, wide: float, high: float) -> list[Drawn]:
    x, y = at
    r = high * 0.3
    ends = ((x, y + high), (x + wide - r, y + r))
    return [Lines((ends,), INK, 0.5), Circle(*ends[1], r, mix(PAPER, QUIET, 0.2), INK, 0.5)]


def _dropped(at: XY, wide: float, high: float) -> list[Drawn]:
    return icons.item((at[0] + wide / 2, at[1] + high / 2), high, "")


def _expected(at: XY, wide: float, high: float) -> list[Drawn]:
    return icons.verdict((at[0] + wide / 2, at[1] + high / 2), high * 0.45, good=True)


def _unexpected(at: XY, wide: float, high: float) -> list[Drawn]:
    return icons.verdict((at[0] + wide / 2, at[1] + high / 2), high * 0.45, good=False)


_SIGNS: Mapping[str, tuple[_Sign, str]] = {
    "remembered": (_remembered, MARKS[Mark.STALE].words),
    "told": (_told, MARKS[Mark.HEARD].words),
    "false": (_false, MARKS[Mark.FALSE].words),
    "unknown blocks": (_unknown, "not known what stands there"),
    "container": (_container, "not known what is in it; open: known to be empty"),
    "expected": (_expected, "as expected"),
    "unexpected": (_unexpected, "not as expected"),
    "trail": (_trail, "the way an agent has gone"),
    "moved": (_moved, "moved aside; the line ends at its place"),
    "dropped item": (_dropped, "dropped item"),
}
