"""Folder of a search for hard items: its answers, by which it continues, and its report."""

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec

from beliefnest.errors import InputError
from beliefnest.files import replace_file
from beliefnest.llm.budget import RunLimits
from beliefnest.llm.messages import Usage
from beliefnest.llm.model_settings import ModelSettings
from beliefnest.llm.resolve import check_model
from beliefnest.locking import holding
from beliefnest.plan.cells import digest
from beliefnest.plan.spending import append_line, spent_in
from beliefnest.plan.terms import Terms
from beliefnest.scenarios.record_forms import read_json, read_lines
from beliefnest.studies.checking import is_whole
from beliefnest.studies.items.asking import ItemAnswer, ask_item
from beliefnest.studies.items.record import ItemRecord
from beliefnest.studies.items.searching import (
    LEAST_BUDGET,
    Ask,
    ItemPair,
    ItemSearch,
    JudgedContrast,
    judged_pairs,
)
from beliefnest.studies.items.space import ItemSpace
from beliefnest.world.words import listed

_FORM = "beliefnest search 1"
_FIRST = 20
"""Greatest number of draws for a valid scene of a scenario."""
_NEW = "name another folder with --out"

OnAnswer = Callable[[str, int, int], None]
"""Function of a description with the cost, the number of answers, and the greatest number."""


@dataclass(frozen=True, slots=True)
class SearchReport:
    """Result of a search.

    Attributes:
        model: Name of the model.
        asked: Number of questions that the model was asked in search and test.
        contrasts: Number of contrasts in the space.
        tested: Contrasts that were tested on fresh pairs.
        transfer: The same for a second model; empty: there is none.
        usage: Tokens and known cost of all answers.
    """

    model: str
    asked: int
    contrasts: int
    tested: Sequence[JudgedContrast]
    transfer: Mapping[str, Sequence[JudgedContrast]]
    usage: Usage

    def plain(self) -> dict[str, Any]:
        """Return the values by name."""
        return {
            "model": self.model,
            "asked": self.asked,
            "contrasts": self.contrasts,
            "tested": [each.plain() for each in self.tested],
            "transfer": {
                name: [each.plain() for each in own] for name, own in self.transfer.items()
            },
            "tokens": self.usage.tokens,
            "cost": self.usage.cost,
        }


def search_items(
    space: ItemSpace,
    folder: Path,
    model: str,
    budget: int,
    *,
    seed: int = 0,
    transfer: str | None = None,
    max_cost: float | None = None,
    on_answer: OnAnswer = lambda what, done, total: None,
) -> SearchReport:
    """Search for factors that make items hard for a model, and test them on fresh items.

    Half of the questions search; the others test. A search that was interrupted continues: each
    question that the folder has an answer to is not asked again.

    Args:
        space: The items.
        folder: Folder of the search; made if it does not exist.
        model: Name of the model.
        budget: Greatest number of questions to the model.
        seed: Seed of all draws.
        transfer: Name of a second model that is asked the fresh items; None: no such model.
        max_cost: Cost limit of the folder in US dollars; None: that of the study.
        on_answer: Function that receives the progress.

    Raises:
        InputError: A number is wrong, or the folder holds something else.
        UnknownNameError: A model does not exist.
        ModelError: A model cannot be asked, or the cost limit is reached.
        BeliefNestError: A script failed.
    """
    if not is_whole(budget) or budget < LEAST_BUDGET:
        raise InputError(
            f"budget is {budget}; give at least {LEAST_BUDGET} questions: half of them search, and "
            "the others test what was found on fresh items"
        )
    limits = RunLimits(None, space.design.limits.cost if max_cost is None else max_cost)
    ledger = folder / "spent.jsonl"
    terms = Terms((folder / "answers").absolute(), ledger.absolute(), None, limits)
    for name in filter(None, (model, transfer)):
        check_model(name, terms.surroundings, terms.connection())
    _check_folder(folder, space, model, seed)
    with holding(folder):
        keeper = _Keeper(folder, terms, on_answer)
        orders = {
            each.order
            for family in space.families
            for each in _first_questions(space, family, seed)
        }
        search = ItemSearch(space, space.contrasts(orders), seed)
        half = budget // 2
        search.run(keeper.asking(model, budget), half)
        pairs = list(search.fresh(budget - half))
        _write_pairs(folder / "finds.jsonl", search.finds)
        _write_pairs(folder / "fresh.jsonl", pairs)
        own = judged_pairs(pairs, keeper.asking(model, budget))
        asked = keeper.asked
        others = {}
        if transfer is not None:
            others[transfer] = judged_pairs(pairs, keeper.asking(transfer, asked + 2 * len(pairs)))
        report = SearchReport(model, asked, len(search.contrasts), own, others, spent_in(ledger))
        replace_file(folder / "report.json", json.dumps(report.plain(), indent=2) + "\n")
    return report


def _first_questions(space: ItemSpace, family: str, seed: int) -> Sequence[ItemRecord]:
    """Return the items of the first valid scene of a family."""
    for number in range(_FIRST):
        point = {name: list(own)[number % len(own)] for name, own in space.levels(family).items()}
        made = space.questions(family, point, space.surface(family, f"first {seed}"))
        if items := [each for each in made if isinstance(each, ItemRecord) and each.options]:
            return items
    raise InputError(f"{family} asks no question with options; give its questions `options`")


@dataclass
class _Keeper:
    """Answers of a folder, which asks a model only for those that are not there yet."""

    folder: Path
    terms: Terms
    on_answer: OnAnswer
    asked: int = 0

    def __post_init__(self) -> None:
        self._file = self.folder / "rows.jsonl"
        self._answers = {(each.model, each.id): each for each in read_lines(self._file, ItemAnswer)}

    def asking(self, name: str, total: int) -> Ask:
        """Return the function that asks a model."""
        model = self.terms.model(name, ModelSettings())

        def ask(purpose: str, item: ItemRecord) -> ItemAnswer:
            answer = self._answers.get((name, item.id))
            if answer is None:
                answer = ask_item(model, item)
                self._answers[name, item.id] = answer
                append_line(self._file, msgspec.json.encode(answer).decode())
            self.asked += 1
            cost = spent_in(self.terms.ledger).cost or 0.0
            self.on_answer(f"{purpose}, {cost:.2f} US dollars", self.asked, total)
            return answer

        return ask


def _check_folder(folder: Path, space: ItemSpace, model: str, seed: int) -> None:
    """Make a folder of a search; raise InputError if it holds another one, or something else."""
    described = {
        "format": _FORM,
        "study": digest([space.design.plain(), [each.text for each in space.documents.values()]]),
        "model": model,
        "seed": seed,
    }
    file = folder / "search.json"
    if folder.exists() and not folder.is_dir():
        raise InputError(f"{folder} is a file; {_NEW}")
    if not file.is_file():
        if folder.is_dir() and any(folder.iterdir()):
            raise InputError(f"{folder} is not empty and holds no search; {_NEW}")
        folder.mkdir(parents=True, exist_ok=True)
        replace_file(file, json.dumps(described, indent=2) + "\n")
        return
    there = read_json(file, _NEW)
    differing = [name for name, value in described.items() if there.get(name) != value]
    if differing:
        raise InputError(f"{folder} holds a search with another {listed(differing)}; {_NEW}")


def _write_pairs(file: Path, pairs: Sequence[ItemPair]) -> None:
    replace_file(file, b"".join(msgspec.json.encode(each) + b"\n" for each in pairs))
