"""Random variations of a scenario: parameters, symmetries, and names."""

import itertools
import math
import random
import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from typing import Any

import msgspec

from beliefnest.errors import BeliefNestError, InputError
from beliefnest.scenarios.document import Document, plain
from beliefnest.scenarios.drawn_map import with_map
from beliefnest.scenarios.loading import condition_numbers
from beliefnest.scenarios.parameters import broken_constraint, choices, declared_in, with_parameters
from beliefnest.studies.symmetry import SYMMETRIES
from beliefnest.studies.variation import Variation

_NAMES = (
    *("ada", "ben", "cleo", "dan", "eve", "finn", "gus", "hana", "ivan", "june", "kai", "lena"),
    *("milo", "nora", "otto", "pia", "quinn", "rosa", "sam", "tess", "uma", "vera", "walt", "zoe"),
)
_THINGS = (
    *("diamond", "emerald", "bone", "book", "carrot", "feather", "stick", "potato", "apple"),
    *("gold_ingot", "iron_ingot", "clock", "compass", "bowl", "bucket"),
)
"""Items without any effect, which can replace one another."""
_MISSES = 200
"""Draws in a row without a new variation, after which the remaining ones are listed."""
_MOST_LISTED = 100_000
"""Greatest number of combinations to list in search of variations that were not drawn."""


def drawn_variations(
    document: Document, count: int, seed: str, keeps: Callable[[Variation], bool] | None = None
) -> list[Variation]:
    """Draw different variations of a scenario.

    A variation changes the scenario's parameters, its symmetry, the names of its agents, and the
    names of items that are only carried. Names that are values of parameters stay. The first
    variations do not depend on `count`, so that a study can be enlarged.

    Args:
        document: The scenario.
        count: Number of variations.
        seed: Seed of the draws.
        keeps: Function that returns True for wanted variations; None: all that keep the
            scenario's constraints.

    Raises:
        ScenarioError: A declaration or constraint is wrong.
        InputError: There are fewer variations, or almost none keeps the constraints.
    """
    drawing = _Drawing.of(document)
    if _MOST_LISTED < count > drawing.size:
        raise InputError(
            f"{document.source}: variations is {count:,}, and there are at most "
            f"{drawing.size:,}: all combinations of {drawing.text}; ask for fewer"
        )
    draws = _draws(document, drawing, random.Random(seed), keeps or (lambda _: True))
    drawn = list(itertools.islice(draws, count))
    if not drawn:
        raise InputError(
            f"{document.source}: none of {_MISSES} draws keeps the constraints; widen a range"
        )
    if len(drawn) < count:
        raise InputError(
            f"{document.source}: variations is {count}, and there are {len(drawn)} different ones: "
            f"all combinations of {drawing.text} that keep the constraints; ask for {len(drawn)} "
            "at most, or give parameters more values"
        )
    return drawn


def endless_draws(document: Document, seed: str) -> Iterator[Variation]:
    """Yield random variations without end, also equal ones and those that break a constraint."""
    drawing, chance = _Drawing.of(document), random.Random(seed)
    while True:
        yield drawing.draw(chance)


def _draws(
    document: Document,
    drawing: "_Drawing",
    chance: random.Random,
    keeps: Callable[[Variation], bool],
) -> Iterator[Variation]:
    seen: set[str] = set()
    misses = 0
    while misses < _MISSES:
        variation = drawing.draw(chance)
        misses += 1
        if variation.key in seen or not _is_kept(document, variation, keeps):
            continue
        seen.add(variation.key)
        misses = 0
        yield variation
    if drawing.size <= _MOST_LISTED:
        left = [each for each in drawing.all() if each.key not in seen]
        chance.shuffle(left)
        yield from (each for each in left if _is_kept(document, each, keeps))


def _is_kept(document: Document, variation: Variation, keeps: Callable[[Variation], bool]) -> bool:
    return broken_constraint(document, variation.parameters) is None and keeps(variation)


class _Drawing(msgspec.Struct, frozen=True):
    """Space of variations of a scenario.

    Attributes:
        lists: Values of parameters, by name; None: any number in the range.
        ranges: Lowest and highest value of parameters, by name.
        symmetries: Names of symmetries.
        agents: Names of agents that get new names.
        items: Names of items that get new names.
        taken: Names that cannot be given to other agents and items.
    """

    lists: Mapping[str, Sequence[Any] | None]
    ranges: Mapping[str, tuple[float, float]]
    symmetries: tuple[str, ...]
    agents: tuple[str, ...]
    items: tuple[str, ...]
    taken: frozenset[str]

    @classmethod
    def of(cls, document: Document) -> "_Drawing":
        """Return the space of variations of a document."""
        declared = declared_in(document)
        content: Any = plain(document.root)
        taken = frozenset(_words(content))
        fixed = _named_by_parameters(content)
        scene = _resolved(document)
        agents = tuple(name for name in _proper_names(scene) if name not in fixed)
        items = tuple(name for name in _carried(scene) if name not in fixed)
        return cls(
            lists={name: choices(entry) for name, entry in declared.items()},
            ranges={name: entry.range for name, entry in declared.items() if entry.range},
            symmetries=_symmetries(document),
            agents=_renamable(document, "agents", agents, _free(_NAMES, taken)),
            items=_renamable(document, "items", items, _free(_THINGS, taken)),
            taken=taken,
        )

    def draw(self, chance: random.Random) -> Variation:
        """Draw one variation, which may break a constraint."""
        values: dict[str, Any] = {
            name: chance.choice(listed)
            if listed is not None
            else round(chance.uniform(*self.ranges[name]), 3)
            for name, listed in self.lists.items()
        }
        if len(self.symmetries) > 1:
            values["symmetry"] = chance.choice(self.symmetries)
        for kind, own, free in self._renamed():
            values[kind] = dict(zip(own, chance.sample(free, len(own)), strict=True))
        return Variation(values)

    def _renamed(self) -> Iterator[tuple[str, tuple[str, ...], list[str]]]:
        """Yield for agents and items: the kind, the names as written, the names to draw from."""
        for kind, own, pool in (("agents", self.agents, _NAMES), ("items", self.items, _THINGS)):
            if own:
                yield kind, own, _free(pool, self.taken)

    @property
    def _sizes(self) -> dict[str, float]:
        """Return the number of values of each dimension; infinite for a range of numbers."""
        sizes: dict[str, float] = {
            name: math.inf if listed is None else len(listed) for name, listed in self.lists.items()
        }
        sizes["symmetry"] = len(self.symmetries)
        return sizes | {kind: math.perm(len(free), len(own)) for kind, own, free in self._renamed()}

    @property
    def size(self) -> float:
        """Return the number of all variations, including those that break a constraint."""
        return math.prod(self._sizes.values())

    @property
    def text(self) -> str:
        """Return the dimensions with their numbers of values, for messages."""
        return ", ".join(f"{name} ({size:,})" for name, size in self._sizes.items())

    def all(self) -> Iterator[Variation]:
        """Yield all variations of a finite space, including those that break a constraint."""
        choices: dict[str, Iterable[Any]] = {
            name: listed for name, listed in self.lists.items() if listed is not None
        }
        if len(self.symmetries) > 1:
            choices["symmetry"] = self.symmetries
        for kind, own, free in self._renamed():
            choices[kind] = [
                dict(zip(own, names, strict=True))
                for names in itertools.permutations(free, len(own))
            ]
        for values in itertools.product(*choices.values()):
            yield Variation(dict(zip(choices, values, strict=True)))


def _resolved(document: Document) -> Any:
    """Return the plain content of a document, with what a map draws among its agents."""
    if "map" in document.root.value:
        document = with_map(with_parameters(document, {}))
    return plain(document.root)


def _symmetries(document: Document) -> tuple[str, ...]:
    """Return the names of the symmetries that are possible under all conditions."""
    names = (symmetry.name for symmetry in SYMMETRIES)
    return tuple(name for name in names if _is_possible(document, {"symmetry": name}))


def _free(pool: Sequence[str], taken: Collection[str]) -> list[str]:
    return [name for name in pool if name not in taken]


def _renamable(
    document: Document, kind: str, names: Sequence[str], free: Sequence[str]
) -> tuple[str, ...]:
    """Return the agents or items that can be renamed; none if the scenario forbids it."""
    new = dict(zip(names, free, strict=False))
    return tuple(new) if new and _is_possible(document, {kind: new}) else ()


def _is_possible(document: Document, changes: Mapping[str, Any]) -> bool:
    try:
        for condition in condition_numbers(document):
            Variation(changes).scenario(document, condition)
    except BeliefNestError:
        return False
    return True


def _proper_names(content: Mapping[str, Any]) -> tuple[str, ...]:
    """Return agents whose names are not ordinary words in the tasks, as `seller` would be."""
    tasks = " ".join(str(probe.get("task", "")) for probe in content.get("probes", ()))
    words = set(re.findall(r"\w+", tasks))
    return tuple(name for name in content["agents"] if name not in words)[: len(_NAMES) // 2]


def _carried(content: Mapping[str, Any]) -> tuple[str, ...]:
    """Return items without effects that agents carry or containers hold at the start."""
    contents = [agent.get("inventory") or {} for agent in content["agents"].values()]
    contents += [container.get("items") or {} for container in content.get("containers", ())]
    return tuple(dict.fromkeys(name for items in contents for name in items if name in _THINGS))


def _named_by_parameters(content: Mapping[str, Any]) -> frozenset[str]:
    """Return the words in values of parameters; these stay, as columns of the table show them."""
    conditions = content.get("conditions") or {}
    entries = [content, *(each for each in conditions.values() if isinstance(each, Mapping))]
    return frozenset(word for each in entries for word in _words(each.get("parameters")))


def _words(content: object) -> Iterator[str]:
    """Yield all words of all texts in plain content."""
    if isinstance(content, Mapping):
        for key, inner in content.items():
            yield from _words(str(key))
            yield from _words(inner)
    elif isinstance(content, list):
        for inner in content:
            yield from _words(inner)
    elif isinstance(content, str):
        yield from re.findall(r"\w+", content)
