"""Models of minds: goals, utilities, doubts and credences that are considered for an agent.

Design: design/inference.md. A model is a value; nothing in it depends on a nest.
"""

import itertools
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import msgspec
import numpy as np
import numpy.typing as npt

from beliefnest.errors import InputError
from beliefnest.facts.reading import edits_of, plain_entry
from beliefnest.world.array_types import Floats
from beliefnest.world.registry import Registry, block_name
from beliefnest.world.texts import quoted
from beliefnest.world.values import Items, Point, Position

MOST_ALTERNATIVES = 62
"""Sets of alternatives are bits of a 64-bit number."""

_SUM_SLACK = 1e-9


class PossibleGoal(msgspec.Struct, frozen=True):
    """Thing that an agent may want to reach: exactly one field is set.

    Attributes:
        at: The cell in which to stand.
        block: Name of the block on which to stand.
        item: Name of the item to take.
    """

    at: Position | None = None
    block: str | None = None
    item: str | None = None


class Alternative(msgspec.Struct, frozen=True, eq=False):
    """Possible version of a world: the elements that it sets.

    Attributes:
        name: Its name in the doubt.
        blocks: Block state texts by position.
        containers: Complete contents by position.
        agents: Feet positions by agent name.
    """

    name: str
    blocks: Mapping[Position, str] = msgspec.field(default_factory=dict)
    containers: Mapping[Position, Items] = msgspec.field(default_factory=dict)
    agents: Mapping[str, Point] = msgspec.field(default_factory=dict)

    @property
    def elements(self) -> frozenset[tuple[str, object]]:
        """The elements that it sets, without their values."""
        return frozenset(
            (kind, key)
            for kind, edits in (
                ("block", self.blocks),
                ("contents of", self.containers),
                ("place of", self.agents),
            )
            for key in edits
        )


def simplex_grid(k: int, m: int, smoothing: float = 0.0) -> Floats:
    """Return all vectors of `k` multiples of `1/m` that sum to 1, drawn towards the uniform one.

    Args:
        k: Number of entries, at least 1.
        m: Number of steps from 0 to 1, at least 1.
        smoothing: Weight `e` of the uniform vector, 0 to 1: each entry `v` becomes
            `v * (1 - e) + e / k`.

    Returns:
        float64 (vectors, k), in lexicographic order.

    Raises:
        InputError: An argument is out of range.
    """
    for name, value in (("k", k), ("m", m)):
        if isinstance(value, bool) or not isinstance(value, int) or value < 1:
            raise InputError(f"{name} is {quoted(value)}; give a whole number from 1")
    if not 0 <= smoothing <= 1:
        raise InputError(f"smoothing is {quoted(smoothing)}; give a number from 0 to 1")
    # Each vector is a way to put k - 1 bars between m stars.
    rows = []
    for bars in itertools.combinations(range(m + k - 1), k - 1):
        edges = (-1, *bars, m + k - 1)
        rows.append([after - before - 1 for before, after in itertools.pairwise(edges)])
    grid = np.array(rows, dtype=np.float64) / m
    smoothed: Floats = grid * (1 - smoothing) + smoothing / k
    return smoothed


@dataclass(frozen=True, eq=False)
class MindModel:
    """Hypotheses about what an agent wants and believed at first, and how it acts.

    Attributes:
        agent: Name of the agent.
        goals: Goals by name: `{"at": cell}`, `{"block": name}` or `{"item": name}`.
        utilities: Values to consider by goal (all combinations, the last goal fastest), or a list
            of mappings from goal to value. A value is in units of the cost of one step.
        doubt: Alternatives by name, each a list of facts, or the same as a mapping of `blocks`,
            `containers` and `agents` to edits; None: the agent knows the world.
        credences: Initial credences to consider, rows over the alternatives in their order; None:
            the uniform one.
        actual: None: alternatives that agree with the observer's node; a name; `"unknown"`; or
            weights by name, which sum to 1.
        prior: Weights (utilities, credences) of the combinations, above 0 in sum; None: uniform.
        rationality: Inverse temperature of the softmax policy, per unit of utility; a list is a
            factor of its own.
        discount: Factor by which the value of the future shrinks with each action, above 0 to 1.
        step_cost: Cost of a step.
        stay_cost: Cost of staying.
        act_cost: Cost of acting on a goal and of opening a container.
        diagonal: True if steps also lead to the four diagonal neighbours.
        step_ticks: Ticks without movement that are one stay; None: 1 in the scripted world, 5 in
            Minecraft.
        stays: True if ticks without movement are evidence.
        lapse: Share of its probability that a contradicted alternative keeps in reported credences.

    Raises:
        InputError: A value is out of range or of the wrong shape, or names do not fit together.
    """

    agent: str
    goals: Mapping[str, Mapping[str, Any]]
    utilities: Mapping[str, Any] | Sequence[Mapping[str, float]]
    doubt: Mapping[str, Any] | None = None
    credences: npt.ArrayLike | None = None
    actual: str | Mapping[str, float] | None = None
    prior: npt.ArrayLike | None = None
    rationality: float | Sequence[float] = 2.5
    discount: float = 0.99
    step_cost: float = 1.0
    stay_cost: float = 0.0
    act_cost: float = 1.0
    diagonal: bool = False
    step_ticks: int | None = None
    stays: bool = True
    lapse: float = 0.0

    goal_values: Mapping[str, PossibleGoal] = field(init=False, repr=False)
    utility_rows: Floats = field(init=False, repr=False)
    """float64 (utilities, goals)."""
    alternatives: tuple[Alternative, ...] = field(init=False, repr=False)
    """Without a doubt: one alternative without edits and with an empty name."""
    credence_rows: Floats = field(init=False, repr=False)
    """float64 (credences, alternatives)."""
    prior_weights: Floats = field(init=False, repr=False)
    """float64 (utilities, credences), sums to 1."""
    rationalities: tuple[float, ...] = field(init=False, repr=False)
    actual_weights: Mapping[str, float] | None = field(init=False, repr=False)
    """None: alternatives that agree with the observer's node."""

    def __post_init__(self) -> None:
        if not isinstance(self.agent, str) or not self.agent:
            raise InputError(f"agent is {quoted(self.agent)}; give the name of the modelled agent")
        self._check_numbers()
        self._set("goal_values", _read_goals(self.goals))
        self._set("utility_rows", _utility_rows(self.utilities, tuple(self.goals)))
        self._set("alternatives", read_doubt(self.doubt))
        names = [each.name for each in self.alternatives]
        self._set("credence_rows", _credence_rows(self.credences, names, self.doubt is not None))
        shape = (len(self.utility_rows), len(self.credence_rows))
        self._set("prior_weights", _prior(self.prior, shape))
        self._set("actual_weights", _actual(self.actual, names, self.doubt is not None))

    @property
    def alternative_names(self) -> tuple[str, ...]:
        """Names of the alternatives in order; one empty name without a doubt."""
        return tuple(each.name for each in self.alternatives)

    @property
    def factors(self) -> tuple[str, ...]:
        """Names of the factors that have numbers as values, in order.

        These are `utility.GOAL`; with a doubt `credence.ALTERNATIVE`, `credence_now.ALTERNATIVE`
        and `actual.ALTERNATIVE`; and `rationality` if several are considered.
        """
        return tuple(self.factor_parts)

    @property
    def factor_parts(self) -> dict[str, tuple[str, str]]:
        """Kind of each factor and its goal or alternative, by the name of the factor, in order."""
        parts = [("utility", goal) for goal in self.goals]
        if self.doubt is not None:
            kinds = ("credence", "credence_now", "actual")
            parts += [(kind, name) for kind in kinds for name in self.alternative_names]
        named = {f"{kind}.{name}": (kind, name) for kind, name in parts}
        if len(self.rationalities) > 1:
            named["rationality"] = ("rationality", "")
        return named

    @property
    def observer_doubts(self) -> bool:
        """True if the observer's own values of the doubted elements are ignored."""
        return not (self.actual is None or isinstance(self.actual, str)) or self.actual == "unknown"

    def _set(self, name: str, value: object) -> None:
        object.__setattr__(self, name, value)

    def _check_numbers(self) -> None:
        for name in ("step_cost", "stay_cost", "act_cost"):
            value = getattr(self, name)
            if not _is_number(value) or value < 0:
                raise InputError(f"{name} is {quoted(value)}; give a number from 0")
        if not _is_number(self.discount) or not 0 < self.discount <= 1:
            raise InputError(
                f"discount is {quoted(self.discount)}; give a number above 0, at most 1"
            )
        if self.discount == 1 and self.stay_cost != 0:
            raise InputError(
                f"discount is 1 and stay_cost {self.stay_cost}: staying for ever would cost "
                "without end; set stay_cost to 0 or discount below 1"
            )
        if self.step_cost < self.stay_cost:
            raise InputError(
                f"step_cost is {self.step_cost}, below stay_cost {self.stay_cost}; "
                "a step costs at least as much as staying"
            )
        ticks = self.step_ticks
        if ticks is not None and (
            isinstance(ticks, bool) or not isinstance(ticks, int) or ticks < 1
        ):
            raise InputError(f"step_ticks is {quoted(ticks)}; give a whole number from 1, or None")
        for name in ("diagonal", "stays"):
            if not isinstance(getattr(self, name), bool):
                raise InputError(f"{name} is {quoted(getattr(self, name))}; give True or False")
        if not _is_number(self.lapse) or not 0 <= self.lapse <= 1:
            raise InputError(f"lapse is {quoted(self.lapse)}; give a number from 0 to 1")
        numbers: Any = self.rationality
        listed: list[Any] = (
            [numbers] if _is_number(numbers) else list(_listed("rationality", numbers))
        )
        if not listed or not all(_is_number(each) and each >= 0 for each in listed):
            raise InputError(f"rationality is {quoted(numbers)}; give numbers that are 0 or more")
        if len(set(listed)) < len(listed):
            raise InputError(f"rationality is {quoted(numbers)}; name each value once")
        self._set("rationalities", tuple(float(each) for each in listed))


def read_doubt(doubt: Mapping[str, Any] | None) -> tuple[Alternative, ...]:
    """Check and return the alternatives of a doubt; None: one without edits.

    Raises:
        InputError: They do not set the same elements, two are equal, or an edit is malformed.
    """
    if doubt is None:
        return (Alternative(""),)
    if not isinstance(doubt, Mapping) or not doubt:
        raise InputError(f"doubt is {quoted(doubt)}; give alternatives by name, or None")
    if len(doubt) > MOST_ALTERNATIVES:
        raise InputError(
            f"the doubt has {len(doubt)} alternatives; give at most {MOST_ALTERNATIVES}"
        )
    read = [_read_alternative(name, edits) for name, edits in doubt.items()]
    first = read[0]
    for each in read[1:]:
        odd = sorted(first.elements ^ each.elements, key=str)
        if odd:
            kind, key = odd[0]
            has, lacks = (first, each) if odd[0] in first.elements else (each, first)
            raise InputError(
                f"alternative {quoted(has.name)} sets the {kind} {key}, {quoted(lacks.name)} does "
                "not; let all alternatives of a doubt set the same elements"
            )
    for number, each in enumerate(read):
        for other in read[:number]:
            if _values(each) == _values(other):
                raise InputError(
                    f"alternatives {quoted(other.name)} and {quoted(each.name)} are equal; "
                    "alternatives exclude each other, so let them differ or remove one"
                )
    return tuple(read)


def _values(each: Alternative) -> tuple[object, ...]:
    registry = Registry.load()
    blocks = {place: registry.state_id(text) for place, text in each.blocks.items()}
    return blocks, each.containers, each.agents


def _read_alternative(name: object, edits: object) -> Alternative:
    if not isinstance(name, str) or not name:
        raise InputError(f"an alternative is called {quoted(name)}; give it a name")
    if isinstance(edits, list | tuple):
        edits = edits_of(map(plain_entry, edits))
    if not isinstance(edits, Mapping) or set(edits) - {"blocks", "containers", "agents"}:
        raise InputError(
            f"alternative {quoted(name)} is {quoted(edits)}; give a list of facts, or a mapping "
            "with blocks, containers or agents"
        )
    registry = Registry.load()
    blocks = {}
    for place, text in dict(edits.get("blocks", {})).items():
        blocks[_position(name, place)] = str(text)
        registry.state_id(str(text))
    containers = {}
    for place, items in dict(edits.get("containers", {})).items():
        at = _position(name, place)
        if at in blocks and not registry.is_container(block_name(blocks[at])):
            raise InputError(
                f"alternative {quoted(name)} puts items into {quoted(blocks[at])} at {at}, which "
                "is no container; change its block or its contents"
            )
        containers[at] = _items(name, items)
    agents = {
        str(agent): _point(name, agent, feet)
        for agent, feet in dict(edits.get("agents", {})).items()
    }
    return Alternative(name, blocks, containers, agents)


def _items(name: str, items: object) -> Items:
    registry = Registry.load()
    if not isinstance(items, Mapping):
        raise InputError(
            f"alternative {quoted(name)} has contents {quoted(items)}; give counts by item"
        )
    for item, count in items.items():
        registry.item_stack(str(item))
        if isinstance(count, bool) or not isinstance(count, int) or count < 1:
            raise InputError(
                f"alternative {quoted(name)} has {quoted(count)} {item}; give a count from 1"
            )
    return {str(item).removeprefix("minecraft:"): int(count) for item, count in items.items()}


def _position(name: str, place: object) -> Position:
    return _cell(f"alternative {quoted(name)}", place)


def _cell(owner: str, place: object) -> Position:
    parts = tuple(place) if isinstance(place, Sequence) and not isinstance(place, str) else ()
    if len(parts) != 3 or not all(
        isinstance(part, int | np.integer) and not isinstance(part, bool) for part in parts
    ):
        raise InputError(f"{owner} names the place {quoted(place)}; give three whole numbers")
    return (int(parts[0]), int(parts[1]), int(parts[2]))


def _point(name: str, agent: object, feet: object) -> Point:
    parts = tuple(feet) if isinstance(feet, Sequence) and not isinstance(feet, str) else ()
    if len(parts) != 3 or not all(_is_number(part) for part in parts):
        raise InputError(
            f"alternative {quoted(name)} puts {agent} at {quoted(feet)}; give the feet as three "
            "numbers"
        )
    return (float(parts[0]), float(parts[1]), float(parts[2]))


def _read_goals(goals: object) -> Mapping[str, PossibleGoal]:
    if not isinstance(goals, Mapping) or not goals:
        raise InputError(f"goals are {quoted(goals)}; give goals by name")
    registry = Registry.load()
    read = {}
    for name, what in goals.items():
        if not isinstance(name, str) or not name or "." in name:
            raise InputError(f"a goal is called {quoted(name)}; give it a name without dots")
        if not isinstance(what, Mapping) or len(what) != 1 or set(what) - {"at", "block", "item"}:
            raise InputError(
                f"goal {quoted(name)} is {quoted(what)}; give {{'at': cell}}, {{'block': name}} or "
                "{'item': name}: one place or thing. An agent that does several things one after "
                "the other is a program or a policy of `imagine`"
            )
        ((kind, value),) = what.items()
        if kind == "at":
            read[name] = PossibleGoal(at=_cell(f"goal {quoted(name)}", value))
            continue
        text = str(value).removeprefix("minecraft:")
        is_known = registry.has_block(text) if kind == "block" else registry.has_item(text)
        if not is_known:
            raise InputError(
                f"goal {quoted(name)} is about {kind} {quoted(value)}, which does not exist"
            )
        read[name] = PossibleGoal(block=text) if kind == "block" else PossibleGoal(item=text)
    return read


def _utility_rows(utilities: object, goals: Sequence[str]) -> Floats:
    if isinstance(utilities, Mapping):
        _check_goal_names(utilities, goals)
        values = []
        for goal in goals:
            levels = utilities[goal]
            values.append([levels] if _is_number(levels) else list(_listed(goal, levels)))
            if not values[-1]:
                raise InputError(f"goal {quoted(goal)} has no utility; give at least one value")
        rows = list(itertools.product(*values))
    elif isinstance(utilities, Sequence) and not isinstance(utilities, str) and utilities:
        rows = []
        for each in utilities:
            if not isinstance(each, Mapping):
                raise InputError(f"utilities list {quoted(each)}; give a mapping of values by goal")
            _check_goal_names(each, goals)
            rows.append(tuple(each[goal] for goal in goals))
    else:
        raise InputError(
            f"utilities are {quoted(utilities)}; give lists of values by goal, or a list of "
            "mappings"
        )
    if not all(_is_number(value) for row in rows for value in row):
        raise InputError("a utility is no finite number; give numbers in units of one step's cost")
    return np.array(rows, dtype=np.float64)


def _check_goal_names(by_goal: Mapping[object, object], goals: Sequence[str]) -> None:
    unknown = [str(name) for name in by_goal if name not in goals]
    missing = [name for name in goals if name not in by_goal]
    faults = [f"name unknown goals ({', '.join(unknown)})"] if unknown else []
    faults += [f"lack values for {', '.join(missing)}"] if missing else []
    if faults:
        raise InputError(f"utilities {' and '.join(faults)}; the goals are {', '.join(goals)}")


def _credence_rows(credences: object, names: Sequence[str], doubts: bool) -> Floats:
    if credences is None:
        return np.full((1, len(names)), 1 / len(names))
    if not doubts:
        raise InputError("credences are given without a doubt; give its alternatives")
    rows = _array("credences", credences)
    if rows.ndim != 2 or rows.shape[1] != len(names) or not len(rows):
        raise InputError(
            f"credences have shape {rows.shape}; give rows over the {len(names)} alternatives "
            f"{', '.join(names)}"
        )
    if not np.isfinite(rows).all() or (rows < 0).any():
        raise InputError("a credence is below 0 or no finite number; give probabilities")
    sums = rows.sum(axis=1)
    wrong = np.flatnonzero(np.abs(sums - 1) > _SUM_SLACK)
    if len(wrong):
        raise InputError(
            f"row {wrong[0]} of the credences sums to {sums[wrong[0]]:.6g}; let each sum to 1"
        )
    return rows


def _prior(weights: object, shape: tuple[int, int]) -> Floats:
    if weights is None:
        return np.full(shape, 1 / (shape[0] * shape[1]))
    prior = _array("prior", weights)
    if prior.shape != shape:
        raise InputError(
            f"the prior has shape {prior.shape}; give {shape[0]} utilities by {shape[1]} credences"
        )
    if not np.isfinite(prior).all() or (prior < 0).any() or not prior.sum() > 0:
        raise InputError("the prior has a negative or infinite weight, or none above 0")
    scaled: Floats = prior / prior.sum()
    return scaled


def _actual(actual: object, names: Sequence[str], doubts: bool) -> Mapping[str, float] | None:
    if actual is None:
        return None
    if not doubts:
        raise InputError(
            f"actual is {quoted(actual)} without a doubt; give the alternatives, or None"
        )
    if isinstance(actual, str):
        if actual in names:
            return {name: float(name == actual) for name in names}
        if actual == "unknown":
            return {name: 1 / len(names) for name in names}
        raise InputError(
            f"actual is {quoted(actual)}; give None, 'unknown', weights, or one of "
            f"{', '.join(names)}"
        )
    if not isinstance(actual, Mapping):
        raise InputError(
            f"actual is {quoted(actual)}; give None, a name, 'unknown' or weights by name"
        )
    unknown = [str(name) for name in actual if name not in names]
    if unknown:
        raise InputError(
            f"actual names {', '.join(unknown)}; the alternatives are {', '.join(names)}"
        )
    weights = {name: actual.get(name, 0.0) for name in names}
    if not all(_is_number(weight) and weight >= 0 for weight in weights.values()):
        raise InputError(f"actual is {quoted(dict(actual))}; give weights from 0")
    total = sum(weights.values())
    if abs(total - 1) > _SUM_SLACK:
        raise InputError(f"the weights of actual sum to {total:.6g}; let them sum to 1")
    return {name: float(weight) for name, weight in weights.items()}


def _listed(name: str, values: object) -> Iterable[Any]:
    if isinstance(values, str | Mapping) or not isinstance(values, Iterable):
        raise InputError(f"{quoted(name)} has {quoted(values)}; give a number or a list of numbers")
    return values


def _array(name: str, values: object) -> Floats:
    try:
        return np.array(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise InputError(f"{name} are no table of numbers; give rows of equal length") from None


def _is_number(value: object) -> bool:
    numbers = int | float | np.integer | np.floating
    return isinstance(value, numbers) and not isinstance(value, bool) and math.isfinite(value)
