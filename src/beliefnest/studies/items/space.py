"""Space of the items that a study can make: its factors, their levels, and pairs of items."""

import json
import random
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import Any

import msgspec
from msgspec.structs import replace

from beliefnest.errors import InputError
from beliefnest.scenarios.document import Document
from beliefnest.scenarios.loading import condition_numbers
from beliefnest.scenarios.parameters import choices, declared_in
from beliefnest.studies.cells import plan_cells
from beliefnest.studies.design import Design
from beliefnest.studies.items.making import made_items
from beliefnest.studies.items.record import DroppedQuestion, ItemRecord
from beliefnest.studies.random_variations import endless_draws
from beliefnest.studies.variation import CHANGES, Variation, short

ORDER = "order"
"""Factor of the number of agents in the belief path of a question."""
CONDITION = "condition"
"""Factor of the number of the scenario's condition."""

FactorLevels = Mapping[str, Mapping[str, Any]]
"""Values of each factor by their texts, as `ItemRecord.factors` has them."""
Questions = Sequence[ItemRecord | DroppedQuestion]


class Contrast(msgspec.Struct, frozen=True):
    """Level of a factor beside others of the same factor, all else the same.

    Attributes:
        factor: Name of the factor.
        hard: Level that may be hard.
        others: Levels that twins may have: the next lower or higher number, else all others.
    """

    factor: str
    hard: str
    others: tuple[str, ...]

    @property
    def text(self) -> str:
        """Return the contrast in words."""
        return f"{self.factor} {self.hard} rather than {' or '.join(self.others)}"


@dataclass
class ItemSpace:
    """Items that a study can make, by the levels of its factors.

    Attributes:
        design: Design of the study.
        documents: Documents of its scenarios, by name or path.
    """

    design: Design
    documents: Mapping[str, Document]
    _draws: dict[tuple[str, str], Iterator[Variation]] = field(default_factory=dict)
    _levels: dict[str, FactorLevels] = field(init=False)

    def __post_init__(self) -> None:
        self._levels = {name: self._levels_in(each) for name, each in self.documents.items()}

    def _levels_in(self, document: Document) -> FactorLevels:
        wanted = self.design.conditions
        numbers = [n for n in condition_numbers(document) if wanted is None or n in wanted]
        levels: dict[str, Sequence[Any]] = {CONDITION: numbers}
        for name, entry in declared_in(document).items():
            if name in self._lists or isinstance(self.design.variations, int):
                levels[name] = self._lists.get(name) or choices(entry) or ()
        by_text = {name: {short(each): each for each in own} for name, own in levels.items()}
        return {name: own for name, own in by_text.items() if len(own) > 1}

    @property
    def _lists(self) -> Mapping[str, Sequence[Any]]:
        variations = self.design.variations
        return {} if isinstance(variations, int) else variations

    @property
    def families(self) -> tuple[str, ...]:
        """Return the names or paths of the scenarios."""
        return tuple(self.documents)

    def levels(self, family: str) -> FactorLevels:
        """Return the levels of the factors of a scenario, but for the orders of its questions."""
        return self._levels[family]

    def contrasts(self, orders: Collection[int]) -> list[Contrast]:
        """Return the contrasts of all factors.

        Args:
            orders: Orders of the study's questions.

        Raises:
            InputError: No factor has two levels.
        """
        levels: dict[str, dict[str, Any]] = {ORDER: {str(each): each for each in sorted(orders)}}
        for own in self._levels.values():
            for name, values in own.items():
                levels[name] = levels.get(name, {}) | dict(values)
        contrasts = [each for name, own in levels.items() for each in _contrasts(name, own)]
        if not contrasts:
            raise InputError(
                "nothing varies in this study: no parameter has two values, and all questions are "
                "of one order; give `variations`, or parameters with values"
            )
        return contrasts

    def surface(self, family: str, seed: str) -> Mapping[str, Any]:
        """Draw a symmetry, names, and values of all parameters; each seed has its own draws."""
        document, key = self.documents[family], (family, seed)
        if key not in self._draws:
            self._draws[key] = endless_draws(document, f"{seed} {Path(family).name}")
        drawn = dict(next(self._draws[key]).values)
        if isinstance(self.design.variations, int):
            return drawn
        # Parameters that the study lists have no other values.
        chance = random.Random(json.dumps([seed, drawn], sort_keys=True))
        listed = {name: chance.choice(list(values)) for name, values in self._lists.items()}
        declared = declared_in(document)
        own = {name: each for name, each in listed.items() if name in (*CHANGES, *declared)}
        return {name: each for name, each in drawn.items() if name in CHANGES} | own

    def questions(
        self, family: str, point: Mapping[str, str], surface: Mapping[str, Any]
    ) -> Questions:
        """Play a scene, and return its questions; none if the combination is not valid.

        Args:
            family: Name or path of the scenario.
            point: Level of each factor but the order.
            surface: Values of all that is no factor; see `surface`.

        Raises:
            BeliefNestError: A script failed.
        """
        values = {name: self._levels[family][name][level] for name, level in point.items()}
        condition = values.pop(CONDITION, None)
        design = replace(
            self.design,
            scenarios=(family,),
            models=("offline",),
            templates=(),
            repeats=1,
            variations={name: [value] for name, value in {**surface, **values}.items()},
            conditions=self.design.conditions if condition is None else (condition,),
            design="crossed",
            balance=(),
        )
        cells = plan_cells(design, self.documents).cells
        made = made_items(cells, self.documents) if cells else {}
        return [each for questions in made.values() for each in questions]


def _contrasts(factor: str, levels: Mapping[str, Any]) -> Iterator[Contrast]:
    values = levels.values()
    if all(isinstance(each, int | float) and not isinstance(each, bool) for each in values):
        ordered = sorted(levels, key=lambda text: levels[text])
        for lower, upper in pairwise(ordered):
            yield Contrast(factor, upper, (lower,))
            yield Contrast(factor, lower, (upper,))
    elif len(levels) > 1:
        for each in levels:
            yield Contrast(factor, each, tuple(other for other in levels if other != each))
