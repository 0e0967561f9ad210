"""Allocation of conditions to variations: balanced designs, and lists of a Latin square."""

import itertools
import random
from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from typing import Literal, get_args

Allocation = Literal["crossed", "balanced", "latin-square"]
"""Form of a design. `crossed`: every variation under every condition. `balanced`: every variation
under one condition. `latin-square`: crossed, and divided into lists."""

DESIGNS: tuple[Allocation, ...] = get_args(Allocation)

PARTICIPANT = "participant"
"""Column of the people who answered, and its key in the identity of their cells."""

_MOST_LISTED = 6
"""Greatest number of conditions whose orders are all tried; of more, as many orders are drawn as
these have."""


def latin_lists(steps: int, conditions: int) -> list[int]:
    """Return the list, from 1, to which each condition of a variation belongs.

    Each list contains each variation once, under one condition. Lists are rotations of each
    other, so that over all lists a variation has each condition once.

    Args:
        steps: Number of the variation, or the sum of the numbers of its values in their lists.
            With the sum, a list is a Latin square of any two lists of values that are as long as
            there are conditions.
        conditions: Number of conditions.
    """
    return [(number - steps) % conditions + 1 for number in range(conditions)]


def balanced(
    variations: Sequence[Mapping[str, str]],
    allowed: Sequence[Collection[int]],
    conditions: int,
    seed: str,
) -> list[int | None]:
    """Assign one condition to each variation.

    Variations are assigned in blocks of as many variations as there are conditions. Within a
    block every condition occurs once, as in permuted-block randomisation. Of all orders of a
    block, one is drawn from those that best balance how often each value has had each condition
    (minimisation, Pocock and Simon 1975). Earlier blocks do not depend on later ones, so that a
    study can be enlarged.

    Args:
        variations: Values of each variation, by name.
        allowed: For each variation the numbers of the conditions under which it is valid.
        conditions: Number of conditions; they are numbered from 0.
        seed: Seed of the draws.

    Returns:
        Number of the condition of each variation; None: no condition is valid.
    """
    had: Counter[tuple[str, str, int]] = Counter()
    overall: Counter[int] = Counter()
    chosen: list[int | None] = [None] * len(variations)
    valid = [number for number, each in enumerate(allowed) if each]
    for start in range(0, len(valid), conditions):
        block = valid[start : start + conditions]
        chance = random.Random(f"{seed} {start}")
        best = _best_order(
            [[_cost(variations[v], c, had, overall) for c in range(conditions)] for v in block],
            [allowed[v] for v in block],
            chance,
        )
        for variation, condition in zip(block, best, strict=True):
            chosen[variation] = condition
            overall[condition] += 1
            had.update((name, value, condition) for name, value in variations[variation].items())
    return chosen


_Cost = tuple[int, int]


def _cost(
    values: Mapping[str, str],
    condition: int,
    had: Mapping[tuple[str, str, int], int],
    overall: Mapping[int, int],
) -> _Cost:
    """Return how often a condition has occurred, and how often with these values."""
    return overall[condition], sum(had[name, value, condition] for name, value in values.items())


def _best_order(
    costs: Sequence[Sequence[_Cost]], allowed: Sequence[Collection[int]], chance: random.Random
) -> Sequence[int]:
    """Return a condition for each variation of a block, at the least sum of costs."""
    orders = [
        order
        for order in _orders(len(costs[0]), len(costs), chance)
        if all(condition in each for condition, each in zip(order, allowed, strict=True))
    ]
    if not orders:
        # Some condition of the block is valid for none of its variations, or two need the same.
        pairs = zip(allowed, costs, strict=True)
        return [min(each, key=own.__getitem__) for each, own in pairs]
    totals = [_total(costs, order) for order in orders]
    least = min(totals)
    return chance.choice(
        [order for order, total in zip(orders, totals, strict=True) if total == least]
    )


def _total(costs: Sequence[Sequence[_Cost]], order: Sequence[int]) -> _Cost:
    chosen = [own[condition] for own, condition in zip(costs, order, strict=True)]
    return sum(overall for overall, _ in chosen), sum(had for _, had in chosen)


def _orders(conditions: int, count: int, chance: random.Random) -> list[Sequence[int]]:
    if conditions <= _MOST_LISTED:
        return list(itertools.permutations(range(conditions), count))
    numbers = range(conditions)
    return [chance.sample(numbers, count) for _ in range(720)]
