"""Drawing variations of a scenario by a seed: parameters, symmetries, names."""

import itertools
import random
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from beliefnest.errors import BeliefNestError, InputError, MissingExtraError
from beliefnest.scenarios.document import Document, plain
from beliefnest.scenarios.loading import condition_numbers
from beliefnest.scenarios.parameters import broken_constraint, choices, declared_in
from beliefnest.scenarios.scenario import Scenario
from beliefnest.studies.symmetry import SYMMETRIES
from beliefnest.studies.variation import Variation

__all__ = ["drawn_variations"]

_NAMES = (
    *("ada", "ben", "cleo", "dan", "eve", "finn", "gus", "hana", "ivan", "june", "kai", "lena"),
    *("milo", "nora", "otto", "pia", "quinn", "rosa", "sam", "tess", "uma", "vera", "walt", "zoe"),
)
_THINGS = (
    *("diamond", "emerald", "bone", "book", "carrot", "feather", "stick", "potato", "apple"),
    *("gold_ingot", "iron_ingot", "clock", "compass", "bowl", "bucket"),
)
"""Items that do nothing but be carried, so that one is as good as another."""
_MISSES = 200
"""Draws in a row that give nothing new, after which there is no more."""


def drawn_variations(document: Document, count: int, seed: str) -> list[Variation]:
    """So many different variations of a scenario; fewer if there are not as many.

    What varies: parameters that it declares; the symmetries that it can be put into; of a
    scenario without parameters also the names of its agents, and of items that are only carried.
    Which come first does not depend on how many are drawn, so that a study can be extended.

    Args:
        document: The scenario.
        count: How many.
        seed: Decides which.

    Raises:
        ScenarioError: A declaration or constraint is wrong.
        InputError: The constraints leave next to nothing.
    """
    found = list(itertools.islice(_draws(document, random.Random(seed)), count))
    if not found:
        raise InputError(
            f"{document.source}: none of {_MISSES} draws keeps the constraints; widen a range"
        )
    return found


def _draws(document: Document, chance: random.Random) -> Iterator[Variation]:
    drawing = _Drawing.of(document)
    seen: set[str] = set()
    misses = 0
    while misses < _MISSES:
        found = drawing.draw(chance)
        misses += 1
        if found.key in seen or broken_constraint(document, found.parameters) is not None:
            continue
        seen.add(found.key)
        misses = 0
        yield found


@dataclass(frozen=True)
class _Drawing:
    """What there is to draw from.

    Attributes:
        lists: Parameter to its values; None: any number in its range.
        ranges: Parameter to its lowest and highest value.
        symmetries: Names of symmetries.
        agents: Names of agents that are drawn anew.
        items: Names of items that are drawn anew.
        taken: Names of agents and items that are not given to others.
    """

    lists: Mapping[str, Sequence[Any] | None]
    ranges: Mapping[str, tuple[float, float]]
    symmetries: tuple[str, ...]
    agents: tuple[str, ...]
    items: tuple[str, ...]
    taken: frozenset[str]

    @classmethod
    def of(cls, document: Document) -> "_Drawing":
        """What a document offers."""
        declared = declared_in(document)
        content: Any = plain(document.root)
        agents = () if declared else _proper_names(content)
        return cls(
            lists={name: choices(entry) for name, entry in declared.items()},
            ranges={name: entry.range for name, entry in declared.items() if entry.range},
            symmetries=_symmetries(document),
            agents=agents,
            items=() if declared else _carried(content),
            taken=frozenset(_words(content)),
        )

    def draw(self, chance: random.Random) -> Variation:
        """Return one variation, which may break a constraint."""
        values: dict[str, Any] = {
            name: chance.choice(listed)
            if listed is not None
            else round(chance.uniform(*self.ranges[name]), 3)
            for name, listed in self.lists.items()
        }
        if len(self.symmetries) > 1:
            values["symmetry"] = chance.choice(self.symmetries)
        for kind, own, pool in (("agents", self.agents, _NAMES), ("items", self.items, _THINGS)):
            free = [name for name in pool if name not in self.taken]
            if own:
                values[kind] = dict(zip(own, chance.sample(free, len(own)), strict=True))
        return Variation(values)


def _symmetries(document: Document) -> tuple[str, ...]:
    """Names of the symmetries that the scenario can be put into, under all its conditions."""
    return tuple(symmetry.name for symmetry in SYMMETRIES if _is_possible(document, symmetry.name))


def _is_possible(document: Document, symmetry: str) -> bool:
    scene = Variation({"symmetry": symmetry}).scene
    try:
        for condition in condition_numbers(document):
            Scenario.varied(document, condition, None, scene)
    except MissingExtraError:
        raise
    except BeliefNestError:
        return False
    return True


def _proper_names(content: Mapping[str, Any]) -> tuple[str, ...]:
    """Return agents whose names are no words of the tasks, as that of a seller would be."""
    told = " ".join(str(probe.get("task", "")) for probe in content.get("probes", ()))
    words = set(re.findall(r"\w+", told))
    return tuple(name for name in content["agents"] if name not in words)[: len(_NAMES) // 2]


def _carried(content: Mapping[str, Any]) -> tuple[str, ...]:
    """Return items that agents carry or containers hold at the start, and that do nothing."""
    held = [agent.get("inventory") or {} for agent in content["agents"].values()]
    held += [container.get("items") or {} for container in content.get("containers", ())]
    return tuple(dict.fromkeys(name for items in held for name in items if name in _THINGS))


def _words(content: object) -> Iterator[str]:
    """Yield all words of all texts."""
    if isinstance(content, Mapping):
        for key, inner in content.items():
            yield from _words(str(key))
            yield from _words(inner)
    elif isinstance(content, list):
        for inner in content:
            yield from _words(inner)
    elif isinstance(content, str):
        yield from re.findall(r"\w+", content)
