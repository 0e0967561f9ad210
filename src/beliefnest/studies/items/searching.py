"""Search for factors that make items hard for a model, and their test on fresh items."""

import random
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import msgspec

from beliefnest.studies.counting import Pairs
from beliefnest.studies.items.record import ItemRecord
from beliefnest.studies.items.space import CONDITION, ORDER, Contrast, ItemSpace, Questions

LEAST_BUDGET = 40
"""Least number of questions: half of them test one contrast on ten pairs."""
_LEAST_PAIRS, _MOST_PAIRS = 10, 50
"""Numbers of fresh pairs of a contrast."""
_ENOUGH = 3
"""Number of finds after which a contrast is searched no more, but tested."""
_HOPELESS = 20
"""Number of right answers at a hard level, without any find, after which it is given up."""
_TRIES = 20
"""Number of draws in a row without a new pair, after which there seems to be none."""
_TOGETHER = 8
"""Greatest number of pairs that are asked before the search learns from their answers."""
_ALPHA = 0.05

Ask = Callable[[Sequence[ItemRecord]], Sequence[bool]]
"""Function that asks a model items, and returns True for each right answer."""


class ItemPair(msgspec.Struct, frozen=True):
    """Item, and its twin that differs in the level of one factor only.

    Attributes:
        contrast: The factor and its levels.
        hard: The item at the level that may be hard.
        easy: The item at another level.
    """

    contrast: Contrast
    hard: ItemRecord
    easy: ItemRecord


class JudgedContrast(msgspec.Struct, frozen=True):
    """Contrast on fresh pairs.

    Attributes:
        contrast: The factor and its levels.
        pairs: Answers (right or not) to hard items and to their twins.
        p: Probability of at least this difference by chance, corrected for all tested contrasts.
    """

    contrast: Contrast
    pairs: Pairs
    p: float

    @property
    def is_weakness(self) -> bool:
        """Return True if the model is worse at the hard level than by chance."""
        return self.p < _ALPHA and self.pairs.difference < 0

    def plain(self) -> dict[str, Any]:
        """Return the values by name."""
        low, high = self.pairs.interval
        return {
            "factor": self.contrast.factor,
            "hard": self.contrast.hard,
            "others": list(self.contrast.others),
            "pairs": self.pairs.pairs,
            "right_hard": self.pairs.both + self.pairs.only_one,
            "right_easy": self.pairs.both + self.pairs.only_other,
            "difference": self.pairs.difference,
            "low": low,
            "high": high,
            "p": self.pairs.p,
            "p_corrected": self.p,
            "weakness": self.is_weakness,
        }


@dataclass
class ItemSearch:
    """Search in a space of items, always the same for the same answers and seed.

    Each step chooses contrasts by Thompson sampling of the share of their hard items that fail
    while their twins do not, and asks them together. The levels of all other factors are drawn by
    how often items with them were right, so that one weakness does not hide another.

    Attributes:
        space: The items.
        contrasts: Contrasts to search.
        seed: Seed of all draws.
        passed: Number of items at a hard level that were right, by contrast.
        finds: Pairs of which the hard item failed and the twin did not.
        asked: Texts and questions of the search.
    """

    space: ItemSpace
    contrasts: Sequence[Contrast]
    seed: int
    passed: Counter[Contrast] = field(default_factory=Counter)
    finds: list[ItemPair] = field(default_factory=list)
    asked: set[tuple[str, str]] = field(default_factory=set)
    _answers: dict[tuple[str, str], list[bool]] = field(default_factory=lambda: defaultdict(list))

    def run(self, ask: Ask, budget: int) -> None:
        """Search until a number of questions is used up, or no contrast is left.

        Raises:
            BeliefNestError: The model cannot be asked, or a script failed.
        """
        chance, left = random.Random(f"search {self.seed}"), budget
        barren: set[Contrast] = set()
        while pairs := self._chosen(chance, barren, min(_TOGETHER, left // 2)):
            failed: list[ItemPair] = []
            for pair, right in self._asked(ask, [(each, each.hard) for each in pairs]):
                self.passed[pair.contrast] += right
                failed += [] if right else [pair]
            # If both fail, another weakness hides this one: the pair says nothing.
            twins = self._asked(ask, [(each, each.easy) for each in failed])
            self.finds += [pair for pair, right in twins if right]
            left -= len(pairs) + len(failed)

    def _chosen(self, chance: random.Random, barren: set[Contrast], most: int) -> list[ItemPair]:
        """Return the next pairs to ask; empty: no contrast is left, or no question."""
        pairs: list[ItemPair] = []
        while len(pairs) < most:
            chosen = Counter(each.contrast for each in pairs)
            contrast = self._next(chance, barren, chosen)
            if contrast is None:
                break
            pair = next(self._pairs(contrast, chance, f"search {self.seed}", self.asked), None)
            if pair is None:
                barren.add(contrast)
            else:
                pairs.append(pair)
        return pairs

    def _asked(
        self, ask: Ask, items: Sequence[tuple[ItemPair, ItemRecord]]
    ) -> list[tuple[ItemPair, bool]]:
        """Ask an item of each pair; return the pairs, with True for each right answer."""
        verdicts = ask([item for _, item in items]) if items else ()
        for (_, item), right in zip(items, verdicts, strict=True):
            self.asked.add((item.text, item.question))
            levels = {**item.factors, CONDITION: str(item.condition), ORDER: str(item.order)}
            for name, level in levels.items():
                self._answers[name, level].append(right)
        return [(pair, right) for (pair, _), right in zip(items, verdicts, strict=True)]

    def _found(self, contrast: Contrast) -> int:
        return sum(each.contrast == contrast for each in self.finds)

    def _next(
        self, chance: random.Random, barren: set[Contrast], chosen: Counter[Contrast]
    ) -> Contrast | None:
        """Choose the most promising contrast by a draw; None: none is left to search.

        Args:
            chance: Source of the draw.
            barren: Contrasts without further pairs.
            chosen: Number of pairs of each contrast that wait to be asked.
        """
        draws = {}
        for each in self.contrasts:
            finds, passed = self._found(each), self.passed[each]
            draw = chance.betavariate(1 + finds, 1 + passed)
            is_open = finds + chosen[each] < _ENOUGH and (finds or passed < _HOPELESS)
            if each not in barren and is_open:
                draws[each] = draw
        return max(draws, key=lambda each: draws[each], default=None)

    def candidates(self, budget: int) -> list[Contrast]:
        """Return the contrasts to test, the most promising first.

        Those are left out whose share of finds is less than half of the greatest one.

        Args:
            budget: Number of questions of the test.
        """
        tallies = {each: (self._found(each), self.passed[each]) for each in self.contrasts}
        shares = {
            each: finds / (finds + passed) for each, (finds, passed) in tallies.items() if finds
        }
        least = max(shares.values(), default=0.0) / 2
        promising = [each for each, share in shares.items() if share >= least]
        promising.sort(key=lambda each: -shares[each])
        return promising[: budget // (2 * _LEAST_PAIRS)]

    def fresh(self, budget: int) -> Iterator[ItemPair]:
        """Yield pairs of the candidates that were not asked in the search.

        Other factors are drawn as at the end of the search, with seeds of their own.

        Args:
            budget: Number of questions of the test.
        """
        chosen = self.candidates(budget)
        count = min(_MOST_PAIRS, budget // (2 * max(1, len(chosen))))
        for contrast in chosen:
            seed = f"fresh {self.seed} {contrast.text}"
            pairs = self._pairs(contrast, random.Random(seed), seed, set(self.asked))
            yield from (pair for _, pair in zip(range(count), pairs, strict=False))

    def _pairs(
        self, contrast: Contrast, chance: random.Random, seed: str, seen: set[tuple[str, str]]
    ) -> Iterator[ItemPair]:
        """Yield pairs of a contrast whose hard items are not in `seen`, and add them there."""
        misses = 0
        while misses < _TRIES:
            misses += 1
            pair = self._pair(contrast, chance, seed)
            if pair and (key := (pair.hard.text, pair.hard.question)) not in seen:
                seen.add(key)
                misses = 0
                yield pair

    def _pair(self, contrast: Contrast, chance: random.Random, seed: str) -> ItemPair | None:
        own = [
            each
            for each in self.space.families
            if contrast.factor == ORDER
            or contrast.hard in self.space.levels(each).get(contrast.factor, ())
        ]
        family = chance.choice(own)
        levels = self.space.levels(family)
        point = {name: self._easy(chance, name, list(values)) for name, values in levels.items()}
        surface = self.space.surface(family, seed)
        if contrast.factor == ORDER:
            questions = self.space.questions(family, point, surface)
            return _order_pair(contrast, questions, chance)
        others = [each for each in contrast.others if each in levels[contrast.factor]]
        other = chance.choice(others) if others else contrast.hard
        hards, easies = (
            self.space.questions(family, {**point, contrast.factor: level}, surface)
            for level in (contrast.hard, other)
        )
        pairs: dict[str, list[ItemPair]] = defaultdict(list)
        # The same scenario asks the same questions in the same order.
        for hard, easy in zip(hards, easies, strict=False):
            if isinstance(hard, ItemRecord) and isinstance(easy, ItemRecord) and hard.options:
                pairs[str(hard.order)].append(ItemPair(contrast, hard, easy))
        return chance.choice(pairs[self._easy(chance, ORDER, list(pairs))]) if pairs else None

    def _easy(self, chance: random.Random, factor: str, levels: Sequence[str]) -> str:
        """Draw a level of a factor, more probably one with which items were right."""
        answers = [self._answers.get((factor, level), ()) for level in levels]
        weights = [((1 + sum(each)) / (1 + len(each))) ** 4 for each in answers]
        return chance.choices(levels, weights)[0]


def _order_pair(contrast: Contrast, questions: Questions, chance: random.Random) -> ItemPair | None:
    """Return two questions about one story: of the hard order, and of a lower or higher one."""
    items = [each for each in questions if isinstance(each, ItemRecord) and each.options]
    hards = [each for each in items if str(each.order) == contrast.hard]
    if not hards:
        return None
    hard = chance.choice(hards)

    def likeness(easy: ItemRecord) -> tuple[bool, bool]:
        longer, shorter = sorted((hard.chain, easy.chain), key=len, reverse=True)
        return shorter in (longer[1:], longer[:-1]), easy.kind == hard.kind

    easies = [each for each in items if str(each.order) in contrast.others]
    return ItemPair(contrast, hard, max(easies, key=likeness)) if easies else None


def judged_pairs(pairs: Sequence[ItemPair], ask: Ask) -> list[JudgedContrast]:
    """Ask a model fresh pairs, and test each contrast; p is corrected by Holm (1979).

    Raises:
        ModelError: The model cannot be asked.
    """
    answers: dict[Contrast, list[tuple[bool, bool]]] = defaultdict(list)
    verdicts = ask([item for each in pairs for item in (each.hard, each.easy)])
    for each, hard, easy in zip(pairs, verdicts[::2], verdicts[1::2], strict=True):
        answers[each.contrast].append((hard, easy))
    # Pairs are independent draws from the region, so that each is a cluster of its own.
    compared = [
        (contrast, Pairs(contrast.hard, " or ".join(contrast.others), tuple((n,) for n in own)))
        for contrast, own in answers.items()
    ]
    corrected: dict[Contrast, float] = {}
    least = 0.0
    for number, (contrast, own) in enumerate(sorted(compared, key=lambda each: each[1].p)):
        least = max(least, min(1.0, own.p * (len(compared) - number)))
        corrected[contrast] = least
    return [JudgedContrast(contrast, own, corrected[contrast]) for contrast, own in compared]
