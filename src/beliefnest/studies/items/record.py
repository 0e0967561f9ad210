"""Item of a set: one question with its text, its right answer, and the answers of shortcuts."""

from collections.abc import Mapping

import msgspec

from beliefnest.plan.cells import digest


class ItemRecord(msgspec.Struct, frozen=True, kw_only=True):
    """Question about a story, with all that made it.

    Attributes:
        id: Sixteen letters and digits, a digest of what produced the item.
        text: The story, as its reader is told it.
        question: The question.
        options: Options in the order in which they are asked; empty: an answer in words.
        right: The right answer.
        kind: Kind of the thing that is asked for: `item`, `agent`, `container`, `block`, `sign`;
            `given` if the scenario gives the answer itself.
        order: Greatest number of agents in the belief paths of the question.
        path: Path of the belief that gives the right answer.
        told_by: Path of the simulator that tells the text; `/`: a narrator.
        chain: Agents of `path`.
        chance: Probability that a guess is right; None: the question has no options.
        family: Label of the scenario's group, else the scenario's name.
        scenario: Name of the scenario.
        condition: Number of the condition; None: the scenario has none.
        variation: Name of the variation, as in the tables of studies.
        factors: Values of parameters and of further changes; what is no text, as JSON.
        probe: Name of the probe, or its number.
        seed: Seed of the cell.
        tick: Tick at which the question is asked.
        skeleton: Digest of text and question without names: items that share it differ in names
            only.
        checked: Result of the reader that knows the text alone: `follows`, or `unread` if the text
            is beyond it.
        shortcuts: Answers of rules that need no belief, or one of a lower order: an option, or None
            if the rule gives none. `reality`, `order_0` and so on, `lower_order` (the order below),
            `outermost` (the first agent's own belief), `first`, `last` and `most` (mentioned
            options), and the options of events: the `first_event`, the last, that of most, the
            last before the first and last loss of sight (`first_leaving`, `last_leaving`), and
            the last that the last agent took part in (`own_event`).
    """

    id: str
    text: str
    question: str
    options: tuple[str, ...]
    right: str
    kind: str
    order: int
    path: str
    told_by: str
    chain: tuple[str, ...]
    chance: float | None
    family: str
    scenario: str
    condition: int | None
    variation: str
    factors: Mapping[str, str]
    probe: str
    seed: int
    tick: int
    skeleton: str
    checked: str
    shortcuts: Mapping[str, str | None]


def item_id(scene: str, question: str) -> str:
    """Return the id of an item.

    Args:
        scene: Name of the scene, as `item_name` gives it and files of participants have it.
        question: Numbers of the probe and of the question in it, such as `1.2`.
    """
    return digest([scene, question])[:16]


class DroppedQuestion(msgspec.Struct, frozen=True, kw_only=True):
    """Question that makes no item.

    Attributes:
        scenario: Name of the scenario.
        condition: Number of the condition; None: the scenario has none.
        factors: Values of parameters and of further changes; what is no text, as JSON.
        probe: Name of the probe, or its number.
        question: The question.
        why: Reason.
        is_unanswerable: True if its options do not give the right answer, or cannot be told apart.
    """

    scenario: str
    condition: int | None
    factors: Mapping[str, str]
    probe: str
    question: str
    why: str
    is_unanswerable: bool
