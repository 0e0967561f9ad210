"""Choice of the variations of a study of which shortcuts are right as often as a guess."""

import random
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from beliefnest.errors import InputError, MissingExtraError
from beliefnest.studies.items.record import ItemRecord
from beliefnest.studies.items.report import FIXED_SOLVERS, OF_BELIEFS

_EXACT = 1e-6
_SLACK = 0.005
"""Share of the questions of an order by which right answers may differ from those of guesses. With
many shortcuts, to find a part with none can take for ever; in fewer than 67 questions it is less
than a third of an answer, so that there is none."""
_GAP = 0.05
"""Share by which the chosen part may be smaller than the largest: to prove that none is larger can
take for ever."""
_MOST_NODES = 2000
"""Greatest number of branches that are searched for a part, whatever time that takes."""
_MOST_TOLD = 5
_Excess = tuple[float, ...]
"""Number of right answers above what guesses have, for each shortcut and order."""


def balanced_names(
    made: Mapping[str, Sequence[ItemRecord]], names: Sequence[str], seed: int
) -> frozenset[str]:
    """Return the names of nearly the most scenes on which shortcuts are right as often as guesses.

    Each shortcut is balanced within each order, to half a percent of the questions.

    Args:
        made: Items by the name of their scene: variation and condition.
        names: Names of shortcuts.
        seed: Seed of the choice among equal scenes.

    Raises:
        InputError: No such scenes were found; the message has the numbers.
        MissingExtraError: SciPy is not installed.
    """
    orders = sorted({each.order for items in made.values() for each in items})
    dimensions = [(name, order) for name in names for order in orders]
    scenes: dict[_Excess, list[str]] = defaultdict(list)
    for scene, items in made.items():
        scenes[tuple(_excess(items, *dimension) for dimension in dimensions)].append(scene)
    kinds = sorted(scenes)
    asked = Counter(each.order for items in made.values() for each in items)
    slack = [_SLACK * asked[order] + _EXACT for _, order in dimensions]
    counts = _largest(kinds, [len(scenes[kind]) for kind in kinds], slack)
    if counts is None or not counts.any():
        raise InputError(_impossible(made, dimensions))
    chosen: set[str] = set()
    for kind, count in zip(kinds, counts, strict=True):
        chosen.update(random.Random(f"{seed} {kind}").sample(sorted(scenes[kind]), int(count)))
    return frozenset(chosen)


def _excess(items: Sequence[ItemRecord], name: str, order: int) -> float:
    """Return how many more answers of a shortcut are right than those of guesses."""
    return sum(
        float(answer == each.right) - (each.chance or 0.0)
        for each, answer in _answers(items, name, order)
    )


def _answers(
    items: Iterable[ItemRecord], name: str, order: int
) -> Iterator[tuple[ItemRecord, str]]:
    """Yield the questions of an order that a shortcut answers, with its answers."""
    for each in items:
        if each.order == order and each.options and (each.chain or name not in OF_BELIEFS):
            answer = FIXED_SOLVERS[name](each)
            if answer is not None:
                yield each, answer


def _largest(kinds: Sequence[_Excess], counts: Sequence[int], slack: Sequence[float]) -> Any:
    """Return how many scenes of each kind to take, so that excesses nearly add up to 0.

    Args:
        kinds: Excess of each kind of scene.
        counts: Number of scenes of each kind.
        slack: Greatest sum of each excess.

    Returns:
        The numbers; None: no such part is known.
    """
    try:
        from scipy.optimize import Bounds, LinearConstraint, milp
    except ImportError:
        raise MissingExtraError("balanced items need scipy", "stats") from None
    solution = milp(
        -np.ones(len(kinds)),
        integrality=np.ones(len(kinds)),
        bounds=Bounds(0, counts),
        constraints=LinearConstraint(np.array(kinds).T, -np.array(slack), slack),
        options={"mip_rel_gap": _GAP, "node_limit": _MOST_NODES},
    )
    return None if solution.x is None else np.rint(solution.x).astype(int)


def _impossible(
    made: Mapping[str, Sequence[ItemRecord]], dimensions: Sequence[tuple[str, int]]
) -> str:
    every = [each for items in made.values() for each in items]
    families: dict[str, list[ItemRecord]] = defaultdict(list)
    for each in every:
        families[each.family].append(each)
    totals = {each: total for each in dimensions if abs(total := _excess(every, *each)) > _EXACT}
    rates = []
    for name, order in sorted(totals, key=lambda each: -abs(totals[each]))[:_MOST_TOLD]:
        excess = {of: _excess(items, name, order) for of, items in families.items()}
        # The family that has most of the excess, in its direction.
        worst = max(excess, key=lambda of: excess[of] * totals[name, order])
        answers = list(_answers(families[worst], name, order))
        right = sum(answer == each.right for each, answer in answers)
        rates.append(f"{name}: {right} of {len(answers)} at order {order} in {worst}")
    return (
        "no part of the variations has these shortcuts at chance; right answers where they are "
        f"furthest off: {'; '.join(rates)}"
        "; draw more variations, vary what the answers depend on, add conditions, or name fewer"
    )
