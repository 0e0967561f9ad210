"""Answers of participants to the items of a set, as cells beside those of models."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import msgspec

from beliefnest.errors import InputError
from beliefnest.plan.terms import PlayStage
from beliefnest.studies.items.asking import ItemAnswer
from beliefnest.studies.items.cells import content_of, played_item, said_of
from beliefnest.studies.items.record import ItemRecord, item_id
from beliefnest.studies.participants.answers import (
    PersonAnswer,
    answer_files,
    read_answers,
    with_pseudonyms,
)
from beliefnest.studies.participants.joining import counted_answers, with_own_options
from beliefnest.studies.suite_cells import SuiteKey
from beliefnest.world.texts import quoted
from beliefnest.world.words import counted

PEOPLE = "people"
"""Name of participants in the column `model`."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _PersonItemKey(SuiteKey):
    """Identity of an item that a participant answered.

    Attributes:
        participant: Pseudonym of the participant.
    """

    participant: str


class PersonItemCell(msgspec.Struct, frozen=True):
    """Item that a participant answered: its playing asks nobody.

    Attributes:
        key: Identity of the cell.
        item: The item.
        response: The option that was chosen; empty: none.
    """

    key: _PersonItemKey
    item: ItemRecord
    response: str
    world: ClassVar[str] = ""
    is_quick: ClassVar[bool] = True

    def plain(self) -> dict[str, Any]:
        """Return the cell as plain values for the plan."""
        return self.key.planned(self.item.skeleton, [said_of(self.item, PEOPLE)])

    def play(self, stage: PlayStage) -> dict[str, Any]:
        """Return the answer as plain values."""
        ok = self.response == self.item.right
        outcome = ("ok" if ok else "wrong") if self.response else "no_answer"
        answer = ItemAnswer(
            id=self.item.id,
            model=PEOPLE,
            answered=self.response or None,
            ok=ok,
            outcome=outcome,
            why_not="" if ok else f"answered {quoted(self.response)}",
            finish="",
            text=self.response,
        )
        return played_item(self.item, answer, PEOPLE)


def people_cells(
    suite: str, items: Sequence[ItemRecord], held_out: Collection[str], files: Sequence[Path]
) -> tuple[list[PersonItemCell], list[str]]:
    """Return a cell for each counted answer of a participant to an item, and notes about others.

    Participants have pseudonyms in the order in which their sessions began.

    Args:
        suite: Name of the set.
        items: Its items with options.
        held_out: Ids of items that are held out.
        files: Files of answers of the study's page, or folders of such files.

    Raises:
        InputError: A file is damaged, or has no answer to these items.
    """
    by_id = {each.id: each for each in items}
    answers = [each for file in answer_files(files) for each in read_answers(file)]
    real_answers = [each for each in with_pseudonyms(answers) if not each.is_start]
    own = [each for each in real_answers if _id(each) in by_id]
    if not own:
        raise InputError(
            f"{files[0]} has no answer to an item of {suite}; give answers that people gave on the "
            "page of the study that made this set"
        )
    notes: list[str] = []
    left = {(each.participant, _id(each)) for each in real_answers if _id(each) not in by_id}
    hidden = sum(item in held_out for _, item in left)
    strange = len(left) - hidden
    for count, what in ((hidden, "items that are held out"), (strange, "no item of the set")):
        if count:
            notes.append(f"not counted: {counted(count, 'answer')} of people to {what}")
    checked = [with_own_options(each, by_id[_id(each)].options) for each in own]
    sessions = counted_answers(checked, notes)
    cells = [
        _cell(suite, by_id[_id(answer)], answer)
        for scenes in sessions.values()
        for sheet in scenes.values()
        for answer in sheet.values()
    ]
    return cells, notes


def _cell(suite: str, item: ItemRecord, answer: PersonAnswer) -> PersonItemCell:
    setting = {"model": PEOPLE, "seed": item.seed, "response": answer.response}
    key = _PersonItemKey(suite, content_of(item), setting, participant=answer.participant)
    return PersonItemCell(key, item, answer.response)


def _id(answer: PersonAnswer) -> str:
    return item_id(answer.cell, answer.question)
