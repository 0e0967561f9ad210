"""Balance of a set of items, and how far rules without any belief come on it."""

import math
import re
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any

from beliefnest.studies.clusters import rate_interval
from beliefnest.studies.items.record import ItemRecord

Solver = Callable[[ItemRecord], str | None]
"""Rule that answers an item with one of its options; None: it does not answer."""

FOLDS = 5
"""Number of folds of the classifier of words if all items are of one family."""

_ROUNDING = 1e-9
"""Difference of two rates that only comes from how their numbers are added."""

_COUNTED = ("family", "scenario", "condition", "kind", "order", "checked")


def _only(options: Sequence[str], key: Callable[[str], float]) -> str | None:
    """Return the option of which a key is greatest; None if several have it."""
    greatest = max(map(key, options))
    greatest_options = [each for each in options if key(each) == greatest]
    return greatest_options[0] if len(greatest_options) == 1 else None


def _noted(name: str) -> Solver:
    return lambda each: each.shortcuts.get(name)


OF_BELIEFS = (
    *("reality", "lower_order", "outermost"),
    *("first_event", "last_event", "most_event", "first_leaving", "last_leaving", "own_event"),
)
"""Shortcuts that answer questions about beliefs only: reality and events answer those of order 0
rightly."""

FIXED_SOLVERS: Mapping[str, Solver] = {
    **{name: _noted(name) for name in (*OF_BELIEFS, "first", "last", "most")},
    "first_option": lambda each: each.options[0],
    "last_option": lambda each: each.options[-1],
    "longest_option": lambda each: _only(each.options, len),
    "shortest_option": lambda each: _only(each.options, lambda option: -len(option)),
}
"""Shortcuts that learn nothing, by name."""

LEARNED = ("majority", "words")
"""Shortcuts that learn from the other items of a set, so that no choice of items balances them."""


def report_of(items: Sequence[ItemRecord]) -> dict[str, Any]:
    """Return how balanced items are, and what shortcuts score on them.

    Returns:
        `items`, `by` (numbers of items by family, scenario, condition, kind, order, result of the
        reader), `positions` (how often the right option stands at each place, by number of
        options), `options` (how often each option is asked and right), `shortcuts` (see
        `shortcut_rows`), `same_text` (groups of items with the same text and question, as ids),
        `skeletons` (number of items by number of items with the same skeleton).
    """
    with_options = [each for each in items if each.options]
    skeletons = Counter(each.skeleton for each in items)
    return {
        "items": len(items),
        "by": {
            name: {str(value): n for value, n in sorted(_counts(items, name), key=str)}
            for name in _COUNTED
        },
        "positions": _positions(with_options),
        "options": _options(with_options),
        "shortcuts": list(shortcut_rows(with_options)),
        "same_text": _same_text(items),
        "skeletons": dict(sorted(Counter(skeletons.values()).items())),
    }


def _counts(items: Iterable[ItemRecord], name: str) -> list[tuple[Any, int]]:
    return list(Counter(getattr(each, name) for each in items).items())


def _positions(items: Iterable[ItemRecord]) -> dict[int, list[int]]:
    """Return how often the right option stands at each place, by number of options."""
    counts: dict[int, list[int]] = {}
    for each in items:
        places = counts.setdefault(len(each.options), [0] * len(each.options))
        places[each.options.index(each.right)] += 1
    return dict(sorted(counts.items()))


def _options(items: Iterable[ItemRecord]) -> dict[str, dict[str, int]]:
    asked: Counter[str] = Counter()
    right: Counter[str] = Counter()
    for each in items:
        asked.update(each.options)
        right[each.right] += 1
    return {name: {"asked": asked[name], "right": right[name]} for name in sorted(asked)}


def _same_text(items: Iterable[ItemRecord]) -> list[list[str]]:
    groups: dict[tuple[str, str], list[str]] = defaultdict(list)
    for each in items:
        groups[each.text, each.question].append(each.id)
    return [group for group in groups.values() if len(group) > 1]


def shortcut_rows(items: Sequence[ItemRecord]) -> Iterator[dict[str, Any]]:
    """Yield the accuracy of each shortcut on items with options.

    An item that a shortcut does not answer counts as a guess. Intervals are of 95 %, clustered by
    skeleton. Answers of lower orders are counted where there is a lower order.

    Yields:
        `shortcut`; `items`; `answered`; `accuracy`, `low`, `high`; `chance`; `at_chance`: True if
        chance lies within the interval.
    """
    folds = _folds(items)
    learned = {"majority": _majority, "words": _naive_bayes}
    solvers = {
        **FIXED_SOLVERS,
        **{name: _learned(items, folds, learned[name]) for name in LEARNED},
    }
    for name, solve in solvers.items():
        own = [each for each in items if each.chain or name not in OF_BELIEFS]
        if own:
            yield {"shortcut": name, **_scored(own, solve)}


def _scored(items: Sequence[ItemRecord], solve: Solver) -> dict[str, Any]:
    clusters: dict[str, list[float]] = defaultdict(list)
    answered = 0
    for each in items:
        answer = solve(each)
        answered += answer is not None
        guess = each.chance or 0.0
        clusters[each.skeleton].append(guess if answer is None else float(answer == each.right))
    low, high, _ = rate_interval(list(clusters.values()))
    chance = sum(each.chance or 0.0 for each in items) / len(items)
    return {
        "items": len(items),
        "answered": answered,
        "accuracy": sum(map(sum, clusters.values())) / len(items),
        "low": low,
        "high": high,
        "chance": chance,
        "at_chance": low - _ROUNDING <= chance <= high + _ROUNDING,
    }


def _folds(items: Sequence[ItemRecord]) -> Mapping[str, object]:
    """Return the fold of each item by id: its family, or parts of skeletons if there is one."""
    if len({each.family for each in items}) > 1:
        return {each.id: each.family for each in items}
    skeletons = {name: n % FOLDS for n, name in enumerate(sorted({i.skeleton for i in items}))}
    return {each.id: skeletons[each.skeleton] for each in items}


def _learned(
    items: Sequence[ItemRecord],
    folds: Mapping[str, object],
    learn: Callable[[Sequence[ItemRecord]], Solver],
) -> Solver:
    """Return a rule that is learned for each fold from all others."""
    solvers = {
        fold: learn([each for each in items if folds[each.id] != fold])
        for fold in dict.fromkeys(folds.values())
    }
    return lambda each: solvers[folds[each.id]](each)


def _majority(items: Sequence[ItemRecord]) -> Solver:
    """Learn the options that are most often right where they are asked."""
    counts = _options(items)

    def share(option: str) -> float:
        count = counts.get(option)
        return count["right"] / count["asked"] if count else 0.0

    return lambda each: _only(each.options, share)


def _naive_bayes(items: Sequence[ItemRecord]) -> Solver:
    """Learn right options from the words of texts: multinomial naive Bayes with add-one smoothing.

    Source: McCallum and Nigam (1998), A comparison of event models for naive Bayes text
    classification.
    """
    words: dict[str, Counter[str]] = defaultdict(Counter)
    for each in items:
        words[each.right].update(_words(each))
    every = len({word for counts in words.values() for word in counts}) or 1
    totals = {option: sum(counts.values()) + every for option, counts in words.items()}
    prior = Counter(each.right for each in items)

    def solve(item: ItemRecord) -> str | None:
        seen_options = [option for option in item.options if option in totals]
        used = _words(item)

        def score(option: str) -> float:
            counts, total = words[option], totals[option]
            return math.log(prior[option]) + sum(
                n * math.log((counts[word] + 1) / total) for word, n in used.items()
            )

        return _only(seen_options, score) if seen_options else None

    return solve


def _words(item: ItemRecord) -> Counter[str]:
    return Counter(re.findall(r"\w+", f"{item.text} {item.question}".casefold()))
