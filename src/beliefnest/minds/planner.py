"""Planner: exact values of cells and knowledge, for many hypotheses at once.

A state is a cell and a knowledge. A knowledge consists of the alternatives that percepts leave
possible, and those of them that claims allow (the believed ones). Percepts only remove
alternatives, so the planner solves smaller sets first. For each set it uses value iteration over
the cells at which the agent perceives nothing new; from all other cells the next percept leads to
a smaller set. If only one alternative is believed, values do not depend on the credence.
"""

from collections import OrderedDict
from collections.abc import Callable
from functools import lru_cache

import msgspec
import numpy as np
import numpy.typing as npt

from beliefnest.minds.relaxing import relax
from beliefnest.minds.stage import Stage, numbers_in
from beliefnest.world.array_types import Floats

Knowledge = tuple[int, int]
"""Alternatives that percepts leave possible, and the believed ones among them, as bits."""

_MOST_COUNTED = 4096

_POLICY_ROOM = 32 * 2**20
"""Bytes of policies that a planner keeps."""

_ROOM = 256 * 2**20
"""Limit of the values of all planners together, in bytes."""


class PlanRules(msgspec.Struct, frozen=True):
    """Costs and discount of a model."""

    discount: float
    step_cost: float
    stay_cost: float
    act_cost: float

    @property
    def door_cost(self) -> float:
        """Cost of opening a door on a step through it, in values of the cell behind."""
        return self.act_cost / self.discount


class _Values(msgspec.Struct, frozen=True, eq=False):
    """Values of one knowledge, stored once for all hypotheses with equal values.

    Attributes:
        rows: Row of each cell in the table, or -1.
        kinds: Groups of hypotheses with equal values.
        table: float64 (rows, kinds of utilities, kinds of credences).
    """

    rows: npt.NDArray[np.int64]
    kinds: "_Kinds"
    table: Floats

    def at(self, cells: npt.NDArray[np.int64], kinds: "_Kinds") -> Floats:
        """Return values of some cells for some kinds: (cells, utilities, credences)."""
        mine = self.kinds
        utility, credence = mine.of_utility[kinds.utilities], mine.of_credence[kinds.credences]
        values: Floats = self.table[self.rows[cells]][:, utility][:, :, credence]
        return values


class _Kinds(msgspec.Struct, frozen=True, eq=False):
    """Hypotheses that have the same values with one knowledge.

    The utility of a goal has no effect if no believed alternative contains the goal. Credences
    count only on the believed alternatives.

    Attributes:
        utilities: One row of the utilities for each kind.
        of_utility: The kind of each row.
        credences: One row of the credences for each kind.
        of_credence: The kind of each row.
        weights: float64 (believed alternatives, kinds of credences).
    """

    utilities: npt.NDArray[np.int64]
    of_utility: npt.NDArray[np.int64]
    credences: npt.NDArray[np.int64]
    of_credence: npt.NDArray[np.int64]
    weights: Floats

    @property
    def shape(self) -> tuple[int, int]:
        """Numbers of kinds of utilities and credences."""
        return len(self.utilities), len(self.credences)


class StagePlanner:
    """Values of one stage for utilities (u, goals) and credences (w, alternatives).

    Attributes:
        size: Bytes that values and policies take.
    """

    def __init__(
        self, stage: Stage, rules: PlanRules, utilities: Floats, credences: Floats
    ) -> None:
        self.stage, self.rules = stage, rules
        self._utilities, self._credences = utilities, credences
        self._solved: dict[Knowledge, _Values] = {}
        self.size = 0
        self._kinds: dict[int, _Kinds] = {}
        self._policies: dict[tuple[int, Knowledge, tuple[float, ...]], Floats] = {}

    def log_policy(
        self, cell: int, knowledge: Knowledge, rationalities: tuple[float, ...]
    ) -> Floats:
        """Log probabilities (actions, rationalities, utilities, credences or 1) in a state."""
        key = (cell, knowledge, rationalities)
        policy = self._policies.get(key)
        if policy is None:
            q = self.q(cell, knowledge)
            betas = np.array(rationalities)[:, None, None]
            # An unavailable action has probability 0, even for an irrational agent.
            there = np.logical_or.reduce(np.isfinite(q), axis=(1, 2))
            scaled = np.where(there[:, None, None], q, 0.0)[:, None] * betas
            scaled[~there] = -np.inf
            policy = self._policies[key] = scaled - log_sum(scaled)
            self.size += policy.nbytes
            while len(self._policies) * policy.nbytes > _POLICY_ROOM:
                self.size -= self._policies.pop(next(iter(self._policies))).nbytes
        return policy

    def actions(self, cell: int, knowledge: Knowledge) -> npt.NDArray[np.bool_]:
        """Return a mask of the available actions: stay, steps, openings, acts on goals."""
        stage, possible = self.stage, knowledge[0]
        free = np.ones(1 + stage.moves.shape[2], dtype=np.bool_)
        opens = [
            bool(stage.reach[box, cell]) and self._differs(box, possible)
            for box in range(len(stage.boxes))
        ]
        acts = np.logical_and.reduce(stage.acts[numbers_in(possible), :, cell], axis=0)
        return np.concatenate([free, np.array(opens, dtype=np.bool_), acts])

    def q(self, cell: int, knowledge: Knowledge) -> Floats:
        """Q of all actions: (actions, utilities, credences or 1); -inf for unavailable ones."""
        stage, rules = self.stage, self.rules
        possible, believed = knowledge
        kinds = self._kinds_of(believed)
        weights = kinds.weights
        available = self.actions(cell, knowledge)
        shape = kinds.shape
        q = np.full((len(available), *shape), -np.inf)
        members = numbers_in(believed)
        steps = stage.moves.shape[2]
        for action in range(1 + steps):
            cost = rules.stay_cost if action == 0 else rules.step_cost
            total = np.zeros(shape)
            for number, a in enumerate(members):
                to = cell if action == 0 else int(stage.moves[a, cell, action - 1])
                kept = int(stage.same[a, to])
                after = self._solve((possible & kept, believed & kept))
                total += weights[number] * after.at(np.array([to]), kinds)[0]
                if action > 0 and stage.doors[a, cell, action - 1]:
                    total -= weights[number] * rules.door_cost
            q[action] = rules.discount * total - cost
        for box in range(len(stage.boxes)):
            action = 1 + steps + box
            if available[action]:
                total = np.zeros(shape)
                for number, a in enumerate(members):
                    kept = int(stage.content[box, a]) & int(stage.same[a, cell])
                    after = self._solve((possible & kept, believed & kept))
                    total += weights[number] * after.at(np.array([cell]), kinds)[0]
                q[action] = rules.discount * total - rules.act_cost
        first = 1 + steps + len(stage.boxes)
        for goal in range(stage.acts.shape[1]):
            if available[first + goal]:
                q[first + goal] = self._utilities[kinds.utilities, goal, None] - rules.act_cost
        if len(numbers_in(believed)) == 1:
            return q[:, kinds.of_utility]
        return q[:, kinds.of_utility][:, :, kinds.of_credence]

    def _kinds_of(self, believed: int) -> _Kinds:
        kinds = self._kinds.get(believed)
        if kinds is None:
            members = numbers_in(believed)
            if len(members) == 1:
                weights = np.ones((1, len(self._credences)))
            else:
                part = self._credences[:, members].T
                total = part.sum(axis=0)
                weights = np.where(
                    total > 0, part / np.where(total > 0, total, 1), 1 / len(members)
                )
            there = np.logical_or.reduce(self.stage.acts[members], axis=(0, 2))
            utilities, of_utility = _distinct(self._utilities[:, there])
            credences, of_credence = _distinct(weights.T)
            kinds = self._kinds[believed] = _Kinds(
                utilities, of_utility, credences, of_credence, weights[:, credences]
            )
        return kinds

    def _differs(self, box: int, possible: int) -> bool:
        first = numbers_in(possible)[0]
        return int(self.stage.content[box, first]) & possible != possible

    def _solve(self, knowledge: Knowledge) -> _Values:
        values = self._solved.get(knowledge)
        if values is None:
            values = self._solved[knowledge] = self._computed(knowledge)
            self.size += values.table.nbytes
        return values

    def _computed(self, knowledge: Knowledge) -> _Values:
        stage, rules = self.stage, self.rules
        possible, believed = knowledge
        members, everyone = numbers_in(believed), numbers_in(possible)
        kinds = self._kinds_of(believed)
        weights, shape = kinds.weights, kinds.shape
        # The agent can have this knowledge only where all possible alternatives look the same.
        cells = np.flatnonzero(stage.same[everyone[0]] & possible == possible)
        rows = np.full(len(stage.cells), -1, dtype=np.int64)
        rows[cells] = np.arange(len(cells))
        start = 0.0 if rules.stay_cost == 0 else -rules.stay_cost / (1 - rules.discount)
        table = np.full((len(cells), *shape), start)
        acts = np.logical_and.reduce(stage.acts[everyone], axis=0)
        for goal in range(stage.acts.shape[1]):
            at = np.flatnonzero(acts[goal, cells])
            worth = self._utilities[kinds.utilities, goal, None] - rules.act_cost
            table[at] = np.maximum(table[at], worth)
        for box in range(len(stage.boxes)):
            at = np.flatnonzero(stage.reach[box, cells])
            if len(at) and self._differs(box, possible):
                total = np.zeros((len(at), *shape))
                for number, a in enumerate(members):
                    kept = int(stage.content[box, a])
                    after = self._solve((possible & kept, believed & kept))
                    total += weights[number] * after.at(cells[at], kinds)
                table[at] = np.maximum(table[at], rules.discount * total - rules.act_cost)
        steps = stage.moves.shape[2]
        inner = np.full((len(cells), steps), -1, dtype=np.int32)
        mixes: list[tuple[int, Floats, list[tuple[int, Floats]]]] = []
        for step in range(steps):
            to: npt.NDArray[np.int64] = stage.moves[members][:, cells, step].astype(np.int64)
            left = np.take_along_axis(stage.same[members], to, axis=1) & possible
            stays_in = left == possible
            doors = stage.doors[members][:, cells, step]
            plain = np.logical_and.reduce(stays_in & (to == to[0]) & ~doors, axis=0)
            inner[plain, step] = rows[to[0, plain]]
            at = np.flatnonzero(~plain)
            if not len(at):
                continue
            total = np.zeros((len(at), *shape))
            for number in range(len(members)):
                total[doors[number, at]] -= weights[number] * rules.door_cost
                for smaller in np.unique(left[number, at]).tolist():
                    if smaller == possible:
                        continue
                    which = np.flatnonzero(left[number, at] == smaller)
                    after = self._solve((smaller, smaller & believed))
                    total[which] += weights[number] * after.at(to[number, at[which]], kinds)
            leaves = ~np.logical_or.reduce(stays_in[:, at], axis=0)
            out = at[leaves]
            table[out] = np.maximum(table[out], rules.discount * total[leaves] - rules.step_cost)
            for row in np.flatnonzero(~leaves).tolist():
                within = [
                    (int(rows[to[n, at[row]]]), np.broadcast_to(weights[n], shape).reshape(-1))
                    for n in range(len(members))
                    if stays_in[n, at[row]]
                ]
                mixes.append((int(at[row]), total[row].reshape(-1), within))
        flat = table.reshape(len(cells), -1)
        relax(flat, inner, mixes, rules.discount, rules.step_cost, start)
        return _Values(rows, kinds, table)


def _distinct(rows: Floats) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]:
    """Return the first row of each group of equal rows, and the group number of each row."""
    kinds: dict[bytes, int] = {}
    of_row = [kinds.setdefault(row.tobytes(), len(kinds)) for row in rows]
    first = [of_row.index(kind) for kind in range(len(kinds))]
    return np.array(first, dtype=np.int64), np.array(of_row, dtype=np.int64)


def count_doubtful(stage: Stage) -> int:
    """Return the number of cells at which an agent can think all alternatives possible."""
    everyone = (1 << len(stage.moves)) - 1
    return int((stage.same[0] == everyone).sum())


def count_values(stage: Stage, credences: int) -> int:
    """Return the number of values for one utility, over all sets to which percepts lead."""
    masks = sorted({*np.unique(stage.same).tolist(), *np.unique(stage.content).tolist()})
    everyone = (1 << len(stage.moves)) - 1
    sets, waiting, total = {everyone}, [everyone], 0
    while waiting and len(sets) < _MOST_COUNTED:
        current = waiting.pop()
        first = numbers_in(current)[0]
        cells = int((stage.same[first] & current == current).sum())
        total += cells * (1 if current & (current - 1) == 0 else credences)
        smaller = {current & mask for mask in masks} - sets - {0}
        sets |= smaller
        waiting += smaller
    return max(1, total)


def log_sum(parts: Floats) -> Floats:
    """Log of the sum of exponentials along the first axis; -inf if all are -inf."""
    top = parts.max(axis=0)
    safe = np.where(np.isfinite(top), top, 0.0)
    with np.errstate(divide="ignore"):
        total: Floats = safe + np.log(np.exp(parts - safe).sum(axis=0))
    return total


class _Cache:
    """Planners by content, which drops the oldest ones when their values exceed the limit."""

    def __init__(self) -> None:
        self._planners: OrderedDict[bytes, StagePlanner] = OrderedDict()

    def planner(
        self, stage: Stage, key: bytes, make: Callable[[Stage], StagePlanner]
    ) -> StagePlanner:
        key = stage.key + key
        planner = self._planners.pop(key, None) or make(stage)
        room = _ROOM - planner.size
        for other in reversed(list(self._planners)):
            room -= self._planners[other].size
            if room < 0:
                del self._planners[other]
        self._planners[key] = planner
        return planner


@lru_cache(maxsize=1)
def _cache() -> _Cache:
    return _Cache()


def planner_for(stage: Stage, key: bytes, make: Callable[[Stage], StagePlanner]) -> StagePlanner:
    """Return the planner of a stage and of hypotheses with a digest; equal ones are shared."""
    return _cache().planner(stage, key, make)
