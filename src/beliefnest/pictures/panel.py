"""Panel of a figure: title, plan, and in the margin everything that the plan cannot show."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from msgspec.structs import replace

from beliefnest.belief.grounds import seen_text, told_text
from beliefnest.pictures import icons
from beliefnest.pictures.lettering import ASCENT, text_width, wrap
from beliefnest.pictures.marks import XY, Text
from beliefnest.pictures.marks import DrawnMark as Drawn
from beliefnest.pictures.palette import INK, MARKS, QUIET, AgentLook, Mark, mix
from beliefnest.pictures.plan import SignKind, draw_plan
from beliefnest.pictures.scene import Device, DrawnAgent, Scene, Store

_LINE = 1.32
_MOST = 12
"""Number of containers that are listed; further ones are only counted."""

_FALSE_INK = mix(MARKS[Mark.FALSE].colour, INK, 0.35)


@dataclass
class PanelBlock:
    """Part of a page under construction, from the top downwards.

    Attributes:
        marks: Marks so far.
        bottom: Lower end so far.
        kinds: Signs that the legend has to explain.
    """

    marks: list[Drawn] = field(default_factory=list)
    bottom: float = 0.0
    kinds: set[SignKind] = field(default_factory=set)


def belief_words(path: str) -> str:
    """Describe a simulator in words."""
    names = [name for name in path.split("/") if name]
    return " that ".join(f"{name} believes" for name in names) or "reality"


def paragraph(
    block: PanelBlock,
    text: str,
    left: float,
    width: float,
    size: float,
    colour: str = INK,
    *,
    bold: bool = False,
) -> None:
    """Append lines of text to a block."""
    for line in wrap(text, size, width, bold=bold):
        block.marks.append(Text(left, block.bottom + ASCENT * size, line, size, colour, bold))
        block.bottom += size * _LINE


def draw_panel(
    scene: Scene,
    looks: Mapping[str, AgentLook],
    at: XY,
    width: float,
    size: float,
    plan_at: float = 0.0,
) -> PanelBlock:
    """Draw the panel of a scene.

    Args:
        scene: The scene.
        looks: Looks of all agents.
        at: Upper left corner, in points.
        width: Width in points.
        size: Size of texts in points.
        plan_at: Least y of the plan; it aligns the plans of a row.
    """
    title = draw_title(scene, at, width, size)
    begin = max(title.bottom + 1.5, plan_at)
    body = draw_body(scene, looks, (at[0], begin), width, size)
    return PanelBlock([*title.marks, *body.marks], body.bottom, body.kinds)


def draw_body(
    scene: Scene,
    looks: Mapping[str, AgentLook],
    at: XY,
    width: float,
    size: float,
    listed: Sequence[Store] | None = None,
) -> PanelBlock:
    """Draw the panel of a scene without its title.

    Args:
        scene: The scene.
        looks: Looks of all agents.
        at: Upper left corner, in points.
        width: Width in points.
        size: Size of texts in points.
        listed: Containers to list below the plan; None: all.
    """
    left, top = at
    plan = draw_plan(scene, looks, (left, top), width, size)
    block = PanelBlock(list(plan.marks), plan.bottom + size * 0.7, set(plan.kinds))
    below = scene if listed is None else replace(scene, stores=tuple(listed))
    _margin(block, below, looks, left, width, size)
    if plan.unnamed:
        paragraph(block, f"too close for a name: {', '.join(plan.unnamed)}", left, width, size)
    return block


def draw_title(scene: Scene, at: XY, width: float, size: float) -> PanelBlock:
    """Draw the head of a panel: path, meaning of the path, tick."""
    left, top = at
    block = PanelBlock(bottom=top)
    paragraph(block, scene.path, left, width, size * 1.15, bold=True)
    note = f", {scene.note}" if scene.note else ""
    words = f"{belief_words(scene.path)}, tick {scene.tick}{note}"
    paragraph(block, words, left, width, size * 0.95, QUIET)
    return block


def _margin(
    block: PanelBlock,
    scene: Scene,
    looks: Mapping[str, AgentLook],
    left: float,
    width: float,
    size: float,
) -> None:
    for store in scene.stores[:_MOST]:
        _store_line(block, store, scene.against, left, width, size)
    if len(scene.stores) > _MOST:
        paragraph(block, f"and {len(scene.stores) - _MOST} more containers", left, width, size)
    for shown in scene.devices:
        if shown.false is not None:
            _device_line(block, shown, scene.against, (left, width, size))
    for person in scene.people:
        if person.mark is Mark.FALSE:
            wrong = (seen_text(person.source, person.teller, person.age), person.instead)
            _person_line(block, looks[person.name], wrong, scene.against, (left, width, size))
        if person.owned is not None:
            wrong = (f"has {person.owned.held}", person.owned.instead)
            _person_line(block, looks[person.name], wrong, scene.against, (left, width, size))
    lost = [person for person in scene.people if person.mark is Mark.UNKNOWN]
    if lost:
        _lost_line(block, lost, looks, left, width, size)


def _store_line(
    block: PanelBlock, store: Store, against: str, left: float, width: float, size: float
) -> None:
    """Draw a container: icon, name, known contents, and the contents elsewhere."""
    icon = size * 1.15
    block.marks += icons.container((left + icon / 2, block.bottom + icon / 2), icon, store)
    block.kinds |= {"container", "told"} if store.teller else {"container"}
    inner = left + icon * 1.55
    text = f"{store.label}: {store.words}"
    source_words = told_text(store.source, store.teller, store.age)
    # Contents of which nothing is known were never seen.
    if source_words and not store.unknown:
        text += f" ({source_words})"
    top = block.bottom
    paragraph(block, text, inner, width - icon * 1.55, size)
    if store.mark is Mark.FALSE:
        false_line(block, f"{_place_words(against)}: {store.instead}", inner, left + width, size)
    block.bottom = max(block.bottom, top + icon + 2.2) + 0.8


def _device_line(
    block: PanelBlock, shown: Device, against: str, line: tuple[float, float, float]
) -> None:
    """Draw a false device: its believed state, the speaker, and its state elsewhere."""
    assert shown.false is not None
    left, width, size = line
    icon = size * 1.15
    block.marks += icons.device((left, block.bottom), icon, shown)
    inner, top = left + icon * 1.55, block.bottom
    believed, instead = shown.false
    source_words = told_text(shown.source, shown.teller, shown.age)
    note = f" ({source_words})" if source_words else ""
    where = f"({', '.join(map(str, shown.position))})"
    paragraph(block, f"{where}: {believed}{note}", inner, width - icon * 1.55, size)
    false_line(block, f"{_place_words(against)}: {instead}", inner, left + width, size)
    block.bottom = max(block.bottom, top + icon + 2.2) + 0.8


def _person_line(
    block: PanelBlock,
    look: AgentLook,
    wrong: tuple[str, str],
    against: str,
    line: tuple[float, float, float],
) -> None:
    """Draw an agent with a false entry: a disc, the belief, and the fact elsewhere.

    Args:
        block: Block to draw into.
        look: Look of the agent.
        wrong: The believed and the other value.
        against: Path of the simulator with the other value.
        line: Left end, width, size of the text.
    """
    left, width, size = line
    radius = size * 0.6
    at = (left + radius, block.bottom + radius)
    block.marks += icons.agent(at, radius, look, None, Mark.STALE)
    inner, top = left + size * 1.78, block.bottom
    believed, instead = wrong
    paragraph(block, f"{look.name}: {believed}", inner, width - size * 1.78, size)
    false_line(block, f"{_place_words(against)}: {instead}", inner, left + width, size)
    block.bottom = max(block.bottom, top + 2 * radius) + 0.8


def false_line(
    block: PanelBlock, text: str, left: float, right: float, size: float, colour: str = _FALSE_INK
) -> None:
    """Append lines of text with the sign of what is false before them."""
    radius = size * 0.34
    at = (left + radius * 1.35, block.bottom + size * 0.45)
    block.marks += icons.false_sign(at, radius)
    block.kinds.add("false")
    inner = left + radius * 3.6
    paragraph(block, text, inner, right - inner, size, colour)


def _lost_line(
    block: PanelBlock,
    lost: list[DrawnAgent],
    looks: Mapping[str, AgentLook],
    left: float,
    width: float,
    size: float,
) -> None:
    """Draw discs and names of the agents whose position is unknown, as many in a line as fit."""
    paragraph(block, "place not known:", left, width, size, QUIET)
    radius, x = size * 0.6, left
    step = max(size * _LINE, 2 * radius + 1.6)
    for person in lost:
        taken = 2 * radius + 2 + text_width(person.name, size) + size * 0.9
        if x > left and x + taken - size * 0.9 > left + width:
            x, block.bottom = left, block.bottom + step
        at = (x + radius, block.bottom + radius)
        block.marks += icons.agent(at, radius, looks[person.name], None, Mark.STALE)
        base = block.bottom + radius + size * ASCENT * 0.48
        block.marks.append(Text(x + 2 * radius + 2, base, person.name, size, INK))
        x += taken
    block.bottom += step


def _place_words(path: str) -> str:
    return "in reality" if path == "/" else f"in {path}"
