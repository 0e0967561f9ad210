"""Picture of a run: for each condition the plan of the world, beliefs, and predictions."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import msgspec
from msgspec.structs import replace

from beliefnest.pictures import icons
from beliefnest.pictures.figure import MARGIN, TEXT_SIZE, Figure, columns_for
from beliefnest.pictures.legend import draw_legend
from beliefnest.pictures.marks import XY, Drawing, Rectangle
from beliefnest.pictures.marks import DrawnMark as Drawn
from beliefnest.pictures.palette import INK, PAPER, QUIET, AgentLook, Mark, agent_looks, mix
from beliefnest.pictures.panel import PanelBlock, false_line, paragraph
from beliefnest.pictures.plan import DrawnPlan, SignKind, draw_plan
from beliefnest.pictures.scene import Scene, Store

_GAP = 12.0
_LEAST = 148.0
"""Least width of a condition, in points."""
_BESIDE = 380.0
"""Width, in points, from which a single condition has its cards beside the plan."""
_INSET = 5.0
_BETWEEN = 4.0


class Note(msgspec.Struct, frozen=True):
    """A line of a card.

    Attributes:
        text: Text of the line.
        false: True if it is a false belief.
    """

    text: str
    false: bool = False


class Card(msgspec.Struct, frozen=True):
    """Belief of one simulator, or a prediction from it.

    Attributes:
        title: Title of the card.
        path: Belief path.
        ok: True if the content is as expected; None if nothing was expected.
        stores: Containers as the simulator knows them.
        notes: Further lines.
        prediction: True if the card is a prediction.
    """

    title: str
    path: str
    ok: bool | None
    stores: tuple[Store, ...] = ()
    notes: tuple[Note, ...] = ()
    prediction: bool = False


class ConditionPicture(msgspec.Struct, frozen=True):
    """Content of the picture of one condition.

    Attributes:
        title: Name of the condition.
        about: Description of the condition.
        scene: Real world at the end of the script.
        trails: Ways that agents have gone: x and z, oldest first.
        cards: Beliefs at that time, and predictions from them.
        story: Events, in order.
    """

    title: str
    about: str
    scene: Scene
    trails: Mapping[str, tuple[XY, ...]]
    cards: tuple[Card, ...]
    story: tuple[str, ...] = ()


def overview(conditions: Sequence[ConditionPicture], title: str) -> Figure:
    """Return the figure of a run: conditions side by side, with equal beliefs at equal height."""
    count = len(conditions)
    width = 180.0 if count == 1 else min(85.0 * count, 255.0)
    return Figure(lambda points: _draw(conditions, title, points), width, title)


@dataclass
class _Page:
    """A page under construction."""

    looks: Mapping[str, AgentLook]
    marks: list[Drawn]
    kinds: set[SignKind]

    def add(self, block: PanelBlock | DrawnPlan) -> None:
        self.marks += block.marks
        self.kinds |= block.kinds


def _draw(conditions: Sequence[ConditionPicture], title: str, width: float) -> Drawing:
    page = _Page(agent_looks(conditions[0].scene.agents), [], set())
    inner = width - 2 * MARGIN
    head = PanelBlock(bottom=MARGIN)
    if len(conditions) > 1:
        paragraph(head, title, MARGIN, inner, TEXT_SIZE * 1.6, bold=True)
    page.add(head)
    bottom = head.bottom
    if len(conditions) == 1 and inner >= _BESIDE:
        bottom = _beside(page, conditions[0], (MARGIN, bottom), inner)
    else:
        columns = columns_for(len(conditions), inner, _LEAST)
        for start in range(0, len(conditions), columns):
            row = conditions[start : start + columns]
            bottom = _row(page, row, bottom + (_GAP if start else 2), inner, columns)
    legend = draw_legend(page.kinds, page.looks, (MARGIN, bottom + 5), inner, TEXT_SIZE)
    page.add(legend)
    return Drawing(width, legend.bottom + MARGIN, tuple(page.marks), title)


def _row(
    page: _Page, row: Sequence[ConditionPicture], top: float, inner: float, columns: int
) -> float:
    """Draw conditions side by side; return their lower end."""
    wide = (inner - _GAP * (columns - 1)) / columns
    lefts = [MARGIN + number * (wide + _GAP) for number in range(len(row))]
    heads = [_head(each, (left, top), wide) for each, left in zip(row, lefts, strict=True)]
    level = max(head.bottom for head in heads) + 3
    bottom = level
    for each, head, left in zip(row, heads, lefts, strict=True):
        page.add(head)
        plan = draw_plan(each.scene, page.looks, (left, level), wide, TEXT_SIZE, each.trails)
        page.add(plan)
        below = PanelBlock(bottom=plan.bottom + 4)
        if plan.unnamed:
            words = f"too close for a name: {', '.join(plan.unnamed)}"
            paragraph(below, words, left, wide, TEXT_SIZE)
            page.add(below)
        bottom = max(bottom, below.bottom)
    for level_cards in _levels([each.cards for each in row]):
        at = [(card, left) for card, left in zip(level_cards, lefts, strict=True) if card]
        bottom = _cards(page, at, bottom, wide) + _BETWEEN
    return bottom


def _levels(columns: Sequence[Sequence[Card]]) -> list[tuple[Card | None, ...]]:
    """Return rows of cards; cards about the same belief or probe are in one row."""
    named = [_named(cards) for cards in columns]
    order: list[tuple[object, ...]] = []
    for cards in named:
        at = 0
        for name in cards:
            if name in order:
                at = order.index(name) + 1
            else:
                # Insert a new row after the previous card of the same condition.
                order.insert(at, name)
                at += 1
    # Put predictions below all beliefs; the sort is stable.
    order.sort(key=lambda name: bool(name[0]))
    return [tuple(cards.get(name) for cards in named) for name in order]


def _named(cards: Sequence[Card]) -> dict[tuple[object, ...], Card]:
    """Return cards by subject; a number tells cards about the same subject apart."""
    cards_by_name: dict[tuple[object, ...], Card] = {}
    for card in cards:
        key = (card.prediction, card.title, card.path)
        again = sum(name[:3] == key for name in cards_by_name)
        cards_by_name[(*key, again)] = card
    return cards_by_name


def _beside(page: _Page, condition: ConditionPicture, at: XY, inner: float) -> float:
    """Draw one condition with its cards to the right of the plan; return its lower end."""
    left, top = at
    head = _head(condition, at, inner)
    page.add(head)
    wide = (inner - _GAP) * 0.56
    level = head.bottom + 4
    plan = draw_plan(condition.scene, page.looks, (left, level), wide, TEXT_SIZE, condition.trails)
    page.add(plan)
    story = PanelBlock(bottom=plan.bottom + 5)
    if plan.unnamed:
        paragraph(story, f"too close for a name: {', '.join(plan.unnamed)}", left, wide, TEXT_SIZE)
    for number, step in enumerate(condition.story, start=1):
        paragraph(story, f"{number}  {step}", left, wide, TEXT_SIZE, QUIET)
    page.add(story)
    bottom = level
    for card in condition.cards:
        place = left + wide + _GAP
        bottom = _cards(page, [(card, place)], bottom, inner - wide - _GAP) + _BETWEEN
    return max(bottom, story.bottom, top)


def _head(condition: ConditionPicture, at: XY, width: float) -> PanelBlock:
    block = PanelBlock(bottom=at[1])
    paragraph(block, condition.title, at[0], width, TEXT_SIZE * 1.2, bold=True)
    paragraph(block, condition.about, at[0], width, TEXT_SIZE, QUIET)
    words = f"the real world at tick {condition.scene.tick}, after the script"
    paragraph(block, words, at[0], width, TEXT_SIZE, QUIET)
    return block


def _cards(page: _Page, cards: Sequence[tuple[Card, float]], top: float, width: float) -> float:
    """Draw cards side by side, all as high as the highest; return their lower end."""
    blocks = [_card(card, (left, top), width) for card, left in cards]
    bottom = max(block.bottom for block in blocks) + _INSET - 1
    for (card, left), block in zip(cards, blocks, strict=True):
        fill = mix(PAPER, INK, 0.07) if card.prediction else "#ffffff"
        edge = mix(PAPER, INK, 0.16)
        page.marks.append(
            Rectangle(left, top, width, bottom - top, fill, edge, 0.5, 3.0, role="card")
        )
        page.add(block)
    return bottom


def _card(card: Card, at: XY, width: float) -> PanelBlock:
    left, top = at
    block = PanelBlock(bottom=top + _INSET)
    inner = width - 2 * _INSET
    radius = TEXT_SIZE * 0.6
    room = inner if card.ok is None else inner - 2.6 * radius
    if card.ok is not None:
        middle = (left + width - _INSET - radius, top + _INSET + radius)
        block.marks += icons.verdict(middle, radius, good=card.ok)
        block.kinds.add("expected" if card.ok else "unexpected")
    x = left + _INSET
    paragraph(block, card.title, x, room, TEXT_SIZE, bold=True)
    paragraph(block, card.path, x, room, TEXT_SIZE * 0.9, QUIET)
    block.bottom += 1
    for store in card.stores:
        _store(block, store, x, inner)
    for note in card.notes:
        _note(block, note, x, inner)
    return block


def _note(block: PanelBlock, note: Note, left: float, width: float) -> None:
    if note.false:
        false_line(block, note.text, left, left + width, TEXT_SIZE, INK)
    else:
        paragraph(block, note.text, left, width, TEXT_SIZE)


def _store(block: PanelBlock, store: Store, left: float, width: float) -> None:
    icon = TEXT_SIZE * 1.2
    false = store.mark is Mark.FALSE
    # Put the sign before the words, as with all false entries of a card.
    shown = replace(store, mark=Mark.STALE) if false else store
    block.marks += icons.container((left + icon / 2, block.bottom + icon / 2), icon, shown)
    block.kinds |= {"container", "told"} if store.teller else {"container"}
    top, inset = block.bottom, icon * 1.5
    block.bottom += (icon - TEXT_SIZE) / 2
    teller = f" (told by {store.teller})" if store.teller else ""
    _note(block, Note(f"{store.label}: {store.words}{teller}", false), left + inset, width - inset)
    block.bottom = max(block.bottom, top + icon + 1.6)
