"""Groups of hypotheses that are processed together, and sums of weights by state.

Weights are logarithms of probabilities; -inf means impossible.
"""

import hashlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from beliefnest.minds.mind_model import MindModel
from beliefnest.minds.planner import Knowledge, PlanRules, StagePlanner, log_sum, planner_for
from beliefnest.minds.stage import Stage
from beliefnest.world.array_types import Floats
from beliefnest.world.values import Position

WalkState = tuple[Position, int, int, bool]
"""Cell, knowledge (possible, believed), and True if the course has ended."""

WalkStates = tuple[Mapping[WalkState, Floats], ...]
"""By actual alternative and state, log weights (rationalities, utilities, credences)."""


@dataclass(frozen=True, eq=False)
class Hypotheses:
    """Part of a model's hypotheses that is processed at once.

    Attributes:
        rules: Costs and discount.
        goals: Names of the goals.
        utilities: float64 (utilities, goals).
        credences: float64 (credences, alternatives).
        rationalities: Inverse temperatures.
        step_ticks: Ticks without movement that are a stay.
        stays: True if stays are evidence.
    """

    rules: PlanRules
    goals: tuple[str, ...]
    utilities: Floats
    credences: Floats
    rationalities: tuple[float, ...]
    step_ticks: int
    stays: bool

    @classmethod
    def of(
        cls,
        model: MindModel,
        step_ticks: int,
        utilities: slice = slice(None),
        credences: slice = slice(None),
        rationalities: slice = slice(None),
    ) -> "Hypotheses":
        """Return some of the hypotheses of a model."""
        rules = PlanRules(
            float(model.discount),
            float(model.step_cost),
            float(model.stay_cost),
            float(model.act_cost),
        )
        return cls(
            rules,
            tuple(model.goals),
            model.utility_rows[utilities],
            model.credence_rows[credences],
            model.rationalities[rationalities],
            step_ticks,
            model.stays,
        )

    @property
    def alternatives(self) -> int:
        """Number of alternatives."""
        return int(self.credences.shape[1])

    @property
    def shape(self) -> tuple[int, int, int]:
        """Numbers of rationalities, utilities and credences."""
        return len(self.rationalities), len(self.utilities), len(self.credences)

    def planner(self, stage: Stage) -> StagePlanner:
        """Return the planner of a stage."""
        return planner_for(stage, self._key, self._new_planner)

    def _new_planner(self, stage: Stage) -> StagePlanner:
        return StagePlanner(stage, self.rules, self.utilities, self.credences)

    @cached_property
    def _key(self) -> bytes:
        shapes = (self.rules, self.utilities.shape, self.credences.shape)
        digest = hashlib.blake2b(repr(shapes).encode())
        digest.update(np.ascontiguousarray(self.utilities).tobytes())
        digest.update(np.ascontiguousarray(self.credences).tobytes())
        return digest.digest()

    def log_policy(self, stage: Stage, cell: Position, knowledge: Knowledge) -> Floats:
        """Log probabilities (actions, rationalities, utilities, credences or 1) in a state."""
        planner = self.planner(stage)
        return planner.log_policy(stage.index[cell], knowledge, self.rationalities)


def joined(parts: Iterable[Floats]) -> Floats:
    """Return the log of the sum of the exponentials of some arrays."""
    listed = list(parts)
    return listed[0] if len(listed) == 1 else log_sum(np.stack(listed))


Action = tuple[Stage, Position, Knowledge, tuple[int, ...]]
"""A stage, a cell, a knowledge, and the numbers of actions."""

Edge = tuple[WalkState, WalkState, Action | None]
"""State, next state, and the actions between them; None: no action."""


@dataclass(frozen=True, eq=False)
class Layer:
    """Transitions of states in one part of a tick, kept for looking back.

    Attributes:
        tick: Tick of the transitions.
        edges: The transitions.
        before: Weights of the states before them.
    """

    tick: int
    edges: list[Edge]
    before: Mapping[WalkState, Floats]

    def sources(self, target: WalkState) -> Sequence[tuple[WalkState, Action | None]]:
        """Return the states that lead to a state, with the actions; call it at the end."""
        return self._by_target.get(target, ())

    @cached_property
    def _by_target(self) -> Mapping[WalkState, Sequence[tuple[WalkState, Action | None]]]:
        sources: dict[WalkState, list[tuple[WalkState, Action | None]]] = {}
        for source, target, action in self.edges:
            sources.setdefault(target, []).append((source, action))
        return sources


class Sums:
    """Sums of weights by state. If a layer is kept, the edges are listed in it."""

    def __init__(self, layer: Layer | None = None) -> None:
        self._parts: dict[WalkState, list[Floats]] = {}
        self._layer = layer

    def add(
        self,
        state: WalkState,
        weights: Floats,
        source: WalkState,
        policy: Floats | None = None,
        action: Action | None = None,
    ) -> None:
        """Add the weights of a source, times the policy's sum over some actions."""
        if policy is not None and action is not None:
            chosen = list(action[3])
            part = policy[chosen[0]] if len(chosen) == 1 else log_sum(policy[chosen])
            weights = weights + part
        self._parts.setdefault(state, []).append(weights)
        if self._layer is not None:
            self._layer.edges.append((source, state, action))

    def total(self) -> dict[WalkState, Floats]:
        """Return the sums."""
        return {state: joined(parts) for state, parts in self._parts.items()}


def conditioned(knowledge: Knowledge, mask: int) -> Knowledge:
    """Return the knowledge after a percept that allows some alternatives; it overrides claims."""
    possible = knowledge[0] & mask
    return possible, knowledge[1] & mask or possible


def told(knowledge: Knowledge, mask: int) -> Knowledge:
    """Return the knowledge after a believed claim that is true in some alternatives."""
    possible, believed = knowledge
    return possible, believed & mask or possible & mask or believed
