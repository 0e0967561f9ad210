"""Search for hard items in a folder: each question is a cell of a plan that grows."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import msgspec

from beliefnest.errors import InputError, ModelError
from beliefnest.files import replace_file
from beliefnest.llm.budget import RunLimits
from beliefnest.llm.messages import Usage
from beliefnest.llm.resolve import check_model
from beliefnest.plan.cells import digest
from beliefnest.plan.jobs import OnStudyProgress
from beliefnest.plan.spending import spent_in
from beliefnest.studies.checking import is_whole
from beliefnest.studies.items.asking import check_readers
from beliefnest.studies.items.cells import ITEM_KIND, ItemCell, item_cells
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
from beliefnest.studies.study_folder import StudyFolder
from beliefnest.studies.suite_playing import PlayCells, cells_player
from beliefnest.world.words import listed

_SUITE = "search"
_FIRST = 20
"""Greatest number of draws for a valid scene of a scenario."""


class SearchReport(msgspec.Struct, frozen=True):
    """Result of a search.

    Attributes:
        model: Name of the model.
        asked: Number of questions that the model was asked in search and test.
        contrasts: Number of contrasts in the space.
        tests: Contrasts that were tested on fresh pairs, by model: this one, and the second one if
            there is any.
        usage: Tokens and known cost of all answers.
    """

    model: str
    asked: int
    contrasts: int
    tests: Mapping[str, Sequence[JudgedContrast]]
    usage: Usage

    def plain(self) -> dict[str, Any]:
        """Return the values by name."""
        tests = {name: [each.plain() for each in own] for name, own in self.tests.items()}
        return {
            "model": self.model,
            "asked": self.asked,
            "contrasts": self.contrasts,
            "tested": tests.pop(self.model),
            "transfer": tests,
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
    jobs: int = 1,
    on_progress: OnStudyProgress = lambda progress: None,
) -> SearchReport:
    """Search for factors that make items hard for a model, and test them on fresh items.

    Half of the questions search; the others test. A search that was interrupted continues: each
    question that the folder has an answer to is not asked again. The result depends on no number of
    jobs.

    Args:
        space: The items.
        folder: Folder of the search; made if it does not exist.
        model: Name of the model.
        budget: Greatest number of questions to the model.
        seed: Seed of all draws.
        transfer: Name of a second model that is asked the fresh items; None: no such model.
        max_cost: Cost limit of the folder in US dollars; None: that of the study.
        jobs: Number of questions to ask in parallel.
        on_progress: Function that receives the progress; its total grows.

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
    models = [model] if transfer is None else [model, transfer]
    check_readers(models)
    terms = StudyFolder(folder, ITEM_KIND).terms(limits)
    for name in models:
        check_model(name, terms.surroundings, terms.connection())
    place = StudyFolder.open(folder, ITEM_KIND)
    texts = [each.text for each in space.documents.values()]
    own_search = {"study": digest([space.design.plain(), texts]), "model": model, "seed": seed}
    _check_same(place, own_search)
    about = {"suites": [_SUITE], "models": models, "search": own_search}
    orders = {
        each.order for family in space.families for each in _first_questions(space, family, seed)
    }
    search = ItemSearch(space, space.contrasts(orders), seed)
    half = budget // 2
    with cells_player(place, about, models, on_progress, limits, jobs) as play:
        asker = _Asker(place, play)
        search.run(asker.asking(model), half)
        pairs = list(search.fresh(budget - half))
        _write_pairs(folder / "finds.jsonl", search.finds)
        _write_pairs(folder / "fresh.jsonl", pairs)
        tested = {name: judged_pairs(pairs, asker.asking(name)) for name in models}
        asked = sum(each.key.setting["model"] == model for each in asker.cells.values())
        usage = spent_in(place.ledger)
        report = SearchReport(model, asked, len(search.contrasts), tested, usage)
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
class _Asker:
    """Asker of items, whose cells are one plan that grows with what is asked.

    Attributes:
        place: Folder of the search.
        play: Function that plays the cells without a result.
        cells: All cells that were asked for, by name.
    """

    place: StudyFolder
    play: PlayCells
    cells: dict[str, ItemCell] = field(default_factory=dict)

    def asking(self, model: str) -> Ask:
        """Return the function that asks a model."""

        def ask(items: Sequence[ItemRecord]) -> list[bool]:
            asked = item_cells(_SUITE, items, [model])
            self.cells |= {each.key.name: each for each in asked}
            self.play(list(self.cells.values()))
            return [self._is_right(each) for each in asked]

        return ask

    def _is_right(self, cell: ItemCell) -> bool:
        content = self.place.cell(cell.key.name) or {"error": "it was not asked"}
        if content["error"] is not None:
            raise ModelError(
                f"{content['error']}; run the same command again to continue in {self.place.path}"
            )
        return bool(content["rows"][0]["ok"])


def _check_same(place: StudyFolder, search: Mapping[str, Any]) -> None:
    """Raise InputError if a folder holds another search, or none."""
    there = place.plan().get("search", {}) if place.has_plan else search
    differing = [name for name, value in search.items() if there.get(name) != value]
    if differing:
        raise InputError(
            f"{place.path} holds no search with this {listed(differing)}; name another folder with "
            "--out"
        )


def _write_pairs(file: Path, pairs: Sequence[ItemPair]) -> None:
    replace_file(file, b"".join(msgspec.json.encode(each) + b"\n" for each in pairs))
