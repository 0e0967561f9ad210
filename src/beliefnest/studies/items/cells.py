"""Items as cells of a plan: each asked once of one model."""

from collections.abc import Iterable, Sequence
from typing import Any, ClassVar

import msgspec

from beliefnest.llm.model_settings import ModelSettings
from beliefnest.plan.cells import digest
from beliefnest.plan.terms import PlayStage
from beliefnest.studies.items.asking import ItemAnswer, ask_item, check_readers
from beliefnest.studies.items.record import ItemRecord
from beliefnest.studies.suite_cells import SuiteKey, suite_kind


class AnsweredItem(ItemAnswer, frozen=True, kw_only=True):
    """Row of the table: an answer, with what the set says of its item.

    Attributes:
        family: Family of the item.
        order: Order of the item.
        kind: Kind of the item.
        chance: Probability that a guess is right.
        question: The question.
        expected: The right answer.
    """

    family: str
    order: int
    kind: str
    chance: float | None
    question: str
    expected: str


ITEM_KIND = suite_kind(
    "items", AnsweredItem, ("model", "order"), is_judged=True, identity=("id", "model")
)


class ItemCell(msgspec.Struct, frozen=True):
    """Item, asked once of one model.

    Attributes:
        key: Identity of the cell.
        item: The item.
    """

    key: SuiteKey
    item: ItemRecord
    world: ClassVar[str] = ""
    is_quick: ClassVar[bool] = False

    def plain(self) -> dict[str, Any]:
        """Return the cell as plain values for the plan."""
        asked = said_of(self.item, self.key.setting["model"])
        return self.key.planned(self.item.skeleton, [asked])

    def play(self, stage: PlayStage) -> dict[str, Any]:
        """Ask the model, and return its answer as plain values.

        Raises:
            ModelError: The model cannot be asked.
        """
        model = stage.terms.model(self.key.setting["model"], ModelSettings())
        return played_item(self.item, ask_item(model, self.item), self.key.setting["model"])


def said_of(item: ItemRecord, model: str) -> dict[str, Any]:
    """Return what a row says of its item and of the model, by column."""
    return {
        "id": item.id,
        "model": model,
        "family": item.family,
        "order": item.order,
        "kind": item.kind,
        "chance": item.chance,
        "question": item.question,
        "expected": item.right,
    }


def played_item(item: ItemRecord, answer: ItemAnswer, model: str) -> dict[str, Any]:
    """Return the result of the cell of an answer, as plain values."""
    row = AnsweredItem(**{**msgspec.to_builtins(answer), **said_of(item, model)})
    return {"error": None, "rows": [msgspec.to_builtins(row)]}


def item_cells(suite: str, items: Iterable[ItemRecord], models: Sequence[str]) -> list[ItemCell]:
    """Return a cell for each item with options and each model.

    Args:
        suite: Name of the set.
        items: The items.
        models: Names of the models.

    Raises:
        InputError: A model cannot read items.
    """
    check_readers(models)
    asked = [(each, content_of(each)) for each in items if each.options]
    return [
        ItemCell(SuiteKey(suite, content, {"model": model, "seed": item.seed}), item)
        for model in models
        for item, content in asked
    ]


def content_of(item: ItemRecord) -> str:
    """Return a hash of what somebody is asked and judged by."""
    return digest([item.id, item.text, item.question, item.options, item.right])[:16]
