"""Lists of a Latin square that are balanced over right answers and their positions.

Rotation alone is not enough. If values alternate ("left, right, left, right") and conditions do as
well, each list holds the same right answer throughout, so that who always says "left" scores 100 %
on one list and 0 % on another. The right answers are therefore computed before anything is played
with a model, and variations exchange their rotations until lists are as balanced as they can be.
"""

import warnings
from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence
from itertools import combinations

import msgspec
from msgspec.structs import replace

from beliefnest.errors import BeliefNestError
from beliefnest.nest.face.nest import Nest
from beliefnest.plan.cells import Plan
from beliefnest.plan.scenario_cells import Cell
from beliefnest.scenarios.probing import resolved
from beliefnest.scenarios.questioning import shuffled
from beliefnest.scenarios.scenario import Scenario
from beliefnest.worlds.by_name import Worlds

_MOST_ROUNDS = 50
_RIGHT = "right answer"
_WHOLE = 3
"""Length of a fact over all conditions."""
_Fact = tuple[str, ...]
_Counted = tuple[int, _Fact]
"""Number of a list, and a fact."""
_Lists = Mapping[str, Mapping[int | None, int]]
"""Number of the list by variation and condition."""


class ListsWarning(UserWarning):
    """Warning that lists of a Latin square differ in their right answers."""


class _Square(msgspec.Struct, frozen=True):
    """Cells of one scenario: facts on right answers, and lists.

    Attributes:
        facts: Number of each fact by variation and condition.
        lists: Number of the list by variation and condition.
    """

    facts: Mapping[str, Mapping[int | None, Counter[_Fact]]]
    lists: _Lists

    def counts(self, lists: _Lists) -> Counter[_Counted]:
        """Return the number of each fact in each list."""
        total: Counter[_Counted] = Counter()
        for variation, by_condition in lists.items():
            for condition, number in by_condition.items():
                for fact, count in self.facts[variation][condition].items():
                    total[number, fact] += count
        return total

    def balanced(self) -> _Lists:
        """Return lists after the exchanges of rotations that make them more alike.

        Lists are most alike where the sum of squared counts is least. Each list still contains each
        variation once and each condition as often as before.
        """
        best = dict(self.lists)
        counts = self.counts(best)
        for _ in range(_MOST_ROUNDS):
            exchanged = False
            for one, other in combinations(sorted(best), 2):
                # Only variations with the same valid conditions can exchange their rotations.
                if best[one] == best[other] or best[one].keys() != best[other].keys():
                    continue
                changes = self._changes(best, one, other)
                if sum((2 * counts[key] + more) * more for key, more in changes.items()) < 0:
                    best[one], best[other] = best[other], best[one]
                    for key, more in changes.items():
                        counts[key] += more
                    exchanged = True
            if not exchanged:
                break
        return best

    def _changes(self, lists: _Lists, one: str, other: str) -> Counter[_Counted]:
        """Return the changes of counts if two variations exchange their rotations."""
        changes: Counter[_Counted] = Counter()
        for leaving, coming in ((one, other), (other, one)):
            for condition, number in lists[leaving].items():
                for fact, count in self.facts[leaving][condition].items():
                    changes[number, fact] -= count
                    changes[lists[coming][condition], fact] += count
        return changes


def with_balanced_lists(plan: Plan[Cell]) -> Plan[Cell]:
    """Return a plan whose lists are balanced over right answers, where they can be.

    Args:
        plan: Plan of a study whose design is a Latin square.

    Warns:
        ListsWarning: Lists still differ, with a table; or right answers cannot be computed.
    """
    changed: dict[tuple[str, str, int | None], int] = {}
    with Worlds(0) as worlds:
        for scenario, cells in _by_scenario(plan.cells).items():
            try:
                square = _square(cells, worlds)
            except BeliefNestError as error:
                warnings.warn(
                    f"the lists of {scenario} are not balanced over right answers, which cannot "
                    f"be computed without a model: {error}",
                    ListsWarning,
                    stacklevel=3,
                )
                continue
            lists = square.balanced()
            for variation, by_condition in lists.items():
                for condition, number in by_condition.items():
                    changed[scenario, variation, condition] = number
            if table := _table(square.counts(lists)):
                warnings.warn(
                    f"the lists of {scenario} cannot be balanced over right answers (how often "
                    f"each is right, by list): {table}; add variations, or give values other pairs",
                    ListsWarning,
                    stacklevel=3,
                )
    cells = [
        replace(cell, list_number=changed.get(_place(cell), cell.list_number))
        for cell in plan.cells
    ]
    # As in the plan: in rounds of repeats, list after list.
    order = {model: n for n, model in enumerate(dict.fromkeys(c.key.model for c in plan.cells))}
    cells.sort(key=lambda each: (each.key.repeat, each.list_number or 0, order[each.key.model]))
    return replace(plan, cells=tuple(cells))


def _by_scenario(cells: Sequence[Cell]) -> dict[str, list[Cell]]:
    """Return one cell for each variation and condition, by scenario."""
    cells_by_place: dict[str, dict[tuple[str, str, int | None], Cell]] = {}
    for cell in cells:
        if cell.list_number is not None:
            cells_by_place.setdefault(cell.key.scenario, {}).setdefault(_place(cell), cell)
    return {name: list(each.values()) for name, each in cells_by_place.items()}


def _place(cell: Cell) -> tuple[str, str, int | None]:
    return cell.key.scenario, repr(sorted(cell.key.variation.items())), cell.key.condition


def _square(cells: Sequence[Cell], worlds: Worlds) -> _Square:
    facts: dict[str, dict[int | None, Counter[_Fact]]] = defaultdict(dict)
    lists: dict[str, dict[int | None, int]] = defaultdict(dict)
    for cell in cells:
        _, variation, condition = _place(cell)
        facts_of_cell = _facts(cell.scenario, cell.key.seed, worlds)
        # Under each condition answers are balanced as well, as far as they can be.
        under = {(*fact, str(condition)): count for fact, count in facts_of_cell.items()}
        facts[variation][condition] = facts_of_cell + Counter(under)
        lists[variation][condition] = cell.list_number or 0
    return _Square(facts, lists)


def _facts(scenario: Scenario, seed: int, worlds: Worlds) -> Counter[_Fact]:
    """Return right answers, and positions at which they are shown, of all questions with options.

    The script is played in the scripted world, in which all of it takes milliseconds.
    """
    counts: Counter[_Fact] = Counter()
    if not any(question.options for probe in scenario.probes for question in probe.questions):
        return counts
    with Nest.open(scenario, "scripted", None, seed, worlds) as nest:
        nest.play()
        for number, probe in enumerate(scenario.probes, start=1):
            for question in resolved(nest, probe).questions:
                shown = shuffled(question, seed)
                for option in set(question.right) & set(shown):
                    name = probe.label or f"probe {number}"
                    counts[name, _RIGHT, option] += 1
                    counts[name, "its position", str(shown.index(option) + 1)] += 1
    return counts


def _table(counts: Mapping[_Counted, int]) -> str:
    """Return the counts of right answers that differ by more than one between lists."""
    numbers = sorted({number for number, _ in counts})
    rights = sorted({fact for _, fact in counts if fact[1] == _RIGHT and len(fact) == _WHOLE})
    rows = []
    for fact in rights:
        row = [counts.get((number, fact), 0) for number in numbers]
        if max(row) - min(row) > 1:
            rows.append(f"{fact[0]}, {fact[2]}: {' '.join(map(str, row))}")
    return "; ".join(rows)
