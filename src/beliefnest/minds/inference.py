"""The result of an inference: a posterior over hypotheses at every tick, and questions to it.

Where an agent was out of sight, its places are smoothed or drawn given later evidence, from the
layers that a `Tracker` keeps (forward filtering, backward smoothing and sampling).
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt
from msgspec.structs import replace

from beliefnest.errors import InputError, TickError
from beliefnest.minds.findings import EvidenceEffect, Impossible, SampledPath
from beliefnest.minds.hypotheses import Action, Hypotheses, Layer, WalkState
from beliefnest.minds.mind_model import MindModel
from beliefnest.minds.planner import log_sum
from beliefnest.minds.tracking import FilterStep, Tracker
from beliefnest.world.array_types import Floats
from beliefnest.world.values import Position

if TYPE_CHECKING:  # Few results become tables or figures.
    import pandas as pd

    from beliefnest.pictures.figure import Figure


_CHANGING = ("cell", "credence_now")
"""Kinds of factors that change from step to step."""


def reported_credence(row: Floats, possible: int, believed: int, lapse: float) -> Floats:
    """Return the credence that is reported for a knowledge.

    Args:
        row: float64 (..., alternatives), the initial credence.
        possible: Alternatives that no percept contradicts.
        believed: Those of them that claims allow.
        lapse: Factor on the initial credence in alternatives that a percept contradicts.
    """
    count = row.shape[-1]
    allowed = np.array([believed >> a & 1 for a in range(count)], dtype=np.bool_)
    refuted = np.array([not possible >> a & 1 for a in range(count)], dtype=np.bool_)
    kept = np.where(allowed, row, 0.0)
    nothing = kept.sum(axis=-1, keepdims=True) <= 0
    kept = np.where(nothing, allowed / allowed.sum(), kept)
    kept = kept + np.where(refuted, lapse * row, 0.0)
    shares: Floats = kept / kept.sum(axis=-1, keepdims=True)
    return shares


class Inference:
    """Probabilities of hypotheses about one agent, after each piece of evidence.

    Factors are `utility.GOAL`, `credence.ALTERNATIVE` (the initial one),
    `credence_now.ALTERNATIVE`, `actual.ALTERNATIVE` (1 if it is true), `rationality` if the
    model lists several, and `cell`.

    Attributes:
        model: The hypotheses.
        since: The tick from which on evidence counts.
        until: The last tick.
        smooth: True if marginals of `cell` and `credence_now` use later evidence, too.
    """

    def __init__(
        self,
        model: MindModel,
        since: int,
        until: int,
        trackers: Sequence[Tracker],
        rerun: Callable[[int], "Inference"],
        kept: Callable[[], Sequence[Tracker]],
        *,
        smooth: bool = False,
    ) -> None:
        self.model, self.since, self.until = model, since, until
        self._trackers, self._rerun, self._keep = tuple(trackers), rerun, kept
        self._steps = _merged([tracker.steps for tracker in trackers])
        self.smooth = smooth
        possible = [self._is_possible(step) for step in self._steps]
        self._failed = None if all(possible) else possible.index(False)
        if self._failed is not None:
            self._known = self._steps[: self._failed] or self._steps[:1]
        else:
            self._known = self._steps

    @property
    def factors(self) -> tuple[str, ...]:
        """Names of all factors."""
        return tuple(self.parts)

    @property
    def parts(self) -> dict[str, tuple[str, str]]:
        """Kind of each factor and its goal or alternative, by the name of the factor."""
        return {**self.model.factor_parts, "cell": ("cell", "")}

    @property
    def impossible(self) -> Impossible | None:
        """The first evidence that no hypothesis explains; the posterior is the one before it."""
        if self._failed is None:
            return None
        step = self._steps[self._failed]
        return Impossible(step.tick, step.text, step.why)

    @property
    def ticks(self) -> tuple[int, ...]:
        """Ticks at which evidence came, in order."""
        return tuple(dict.fromkeys(step.tick for step in self._known))

    @property
    def log_evidence(self) -> float:
        """Natural logarithm of the probability of all evidence; -inf if it is impossible."""
        if self._failed is not None:
            return -math.inf
        step = self._steps[-1]
        return float(log_sum((self._log_prior(step) + step.weights).reshape(-1)))

    def posterior(self, tick: int | None = None) -> Floats:
        """Return the probabilities of all hypotheses at a tick.

        Returns:
            float64 (actuals, rationalities, utilities, credences), sums to 1.
        """
        return self._posterior_of(self._step(tick))

    def mean(self, factor: str, tick: int | None = None) -> float:
        """Return the posterior mean of a factor at a tick; None: at the last one.

        Raises:
            InputError: There is no such factor, or its values are no numbers.
            TickError: The tick lies before the first evidence or after the last tick.
        """
        if factor == "cell":
            raise InputError("cells have no mean; ask for marginal('cell')")
        marginal = self.marginal(factor, tick)
        return math.fsum(float(value) * share for value, share in marginal.items())

    def marginal(self, factor: str, tick: int | None = None) -> dict[Any, float]:
        """Return the probability of each value of a factor at a tick; None: at the last one.

        Raises:
            InputError, TickError: As for `mean`.
        """
        return self._marginal_of(factor, self._number(tick))

    def joint(self, *factors: str, tick: int | None = None) -> dict[tuple[Any, ...], float]:
        """Return the probability of each combination of values of some factors.

        Raises:
            InputError: A factor is unknown, or is not part of a hypothesis: `cell` and
                `credence_now` change from step to step.
            TickError: As for `mean`.
        """
        if not factors:
            raise InputError(f"joint needs factors; there are {', '.join(self.factors)}")
        posterior = self.posterior(tick)
        shares: dict[tuple[Any, ...], float] = {}
        columns = [np.broadcast_to(self._values(name), posterior.shape) for name in factors]
        flat = [column.reshape(-1).tolist() for column in columns]
        for values, share in zip(
            zip(*flat, strict=True), posterior.reshape(-1).tolist(), strict=True
        ):
            shares[values] = shares.get(values, 0.0) + share
        return dict(sorted(shares.items()))

    def map(self, tick: int | None = None) -> dict[str, Any]:
        """Return the most probable hypothesis with its probability; of equal ones the first."""
        posterior = self.posterior(tick)
        return self._told(posterior, int(np.argmax(posterior)))

    def hypotheses(self, tick: int | None = None) -> list[dict[str, Any]]:
        """Return all hypotheses with their probabilities, in the order of the model."""
        posterior = self.posterior(tick)
        return [self._told(posterior, number) for number in range(posterior.size)]

    def frame(self) -> "pd.DataFrame":
        """Return the marginals of all factors at every tick with evidence.

        Returns:
            Columns tick, factor, value, probability.
        """
        import pandas as pd

        rows = [
            (tick, factor, value, share)
            for tick in self.ticks
            for factor in self.factors
            for value, share in self.marginal(factor, tick).items()
        ]
        return pd.DataFrame(rows, columns=["tick", "factor", "value", "probability"])

    def explain(self, tick: int | None = None) -> list[EvidenceEffect]:
        """Return the changes of factors by each piece of evidence; None: at all ticks.

        Raises:
            TickError: As for `mean`.
        """
        if tick is not None:
            self._number(tick)
        names, changes = self._lasting, []
        before = {name: self._grouped(name, self._posterior_of(None)) for name in names}
        for number, step in enumerate(self._known):
            after = {name: self._marginal_of(name, number) for name in names}
            if tick is None or step.tick == tick:
                bits = {name: _divergence(after[name], before[name]) for name in names}
                changes.append(
                    EvidenceEffect(step.tick, step.text, bits, step.is_action, step.is_movement)
                )
            before = after
        return changes

    def predict(self, steps: int = 1, tick: int | None = None) -> list[dict[Position, float]]:
        """Return where the agent will be after 1, 2, ... actions, by the posterior at a tick.

        After acting on a goal the agent stays where it is.

        Raises:
            InputError: The number of steps is not a whole number from 1.
            TickError: As for `mean`.
        """
        if isinstance(steps, bool) or not isinstance(steps, int) or steps < 1:
            raise InputError(f"steps is {steps!r}; give a whole number from 1")
        if self._failed is not None and tick is None:
            tick = self._known[-1].tick
        if tick is not None:
            self._number(tick)
            if tick < self.until:
                return self._rerun(tick).predict(steps)
        step = self._known[-1]
        actual = self._log_actual(step)
        predictions = []
        trackers = [tracker.again() for tracker in self._trackers]
        for _ in range(steps):
            shares: dict[Position, list[float]] = {}
            for tracker in trackers:
                tracker.foresee()
                for a, masses in enumerate(tracker.masses()):
                    for state, mass in masses.items():
                        shares.setdefault(state[0], []).append(float(actual[a] + log_sum(mass)))
            predictions.append(_shares(shares))
        return predictions

    def sample_paths(self, n: int, seed: int = 0) -> list[SampledPath]:
        """Draw hypotheses from the posterior, with courses that agree with all evidence.

        While the agent was in sight, its course is the observed one.

        Args:
            n: Number of paths.
            seed: Seed of the draws; equal seeds give equal paths.

        Raises:
            InputError: The number is below 1, the seed is below 0, or no hypothesis explains the
                course.
        """
        if isinstance(n, bool) or not isinstance(n, int) or n < 1:
            raise InputError(f"n is {n!r}; give a whole number from 1")
        if isinstance(seed, bool) or not isinstance(seed, int | np.integer) or seed < 0:
            raise InputError(f"seed is {seed!r}; give a whole number from 0")
        if self._failed is not None:
            raise InputError(f"there is no path to draw: {self.impossible}")
        random = np.random.default_rng(seed)
        posterior = self.posterior()
        drawn = random.choice(posterior.size, size=n, p=posterior.reshape(-1) / posterior.sum())
        paths = []
        for number in drawn.tolist():
            a, b, u, w = (int(part) for part in np.unravel_index(number, posterior.shape))
            for tracker in self._kept:
                size = len(tracker.hypotheses.utilities)
                if u < size:
                    break
                u -= size
            cells = _sampled_cells(tracker, a, (b, u, w), random)
            paths.append(SampledPath(self._told(posterior, number), cells))
        return paths

    def plot(self, *factors: str) -> "Figure":
        """Return a figure of the posterior over time, with the most informative movements.

        Utilities and credences are shown by their means. A single factor, as `utility.soup`, is
        shown by the probabilities of its values.

        Args:
            factors: Kinds (`utility`, `credence`, `credence_now`, `actual`, `rationality`) or
                single factors, each in a panel; none: all kinds that the model leaves open.

        Raises:
            InputError: There is no such factor, or it is `cell`.
        """
        from beliefnest.minds.charts import plot_of

        return plot_of(self, factors)

    def at(self, tick: int) -> "Inference":
        """Return the inference as it was at a tick: nothing after it counts.

        Raises:
            TickError: As for `mean`.
        """
        if tick is None:
            raise TickError("at() needs a tick; give a whole number")
        self._number(tick)
        return self._rerun(tick)

    def __repr__(self) -> str:
        head = f"<inference about {self.model.agent}"
        if self._failed is not None:
            return f"{head}: impossible from {self.impossible}>"
        means = [f"{name} {self.mean(name):.3g}" for name in self._lasting]
        return f"{head}, ticks {self.since} to {self.until}: {', '.join(means)}>"

    # Helpers of the questions above

    @property
    def _lasting(self) -> list[str]:
        """Names of the factors that do not change from step to step."""
        return [each for each, (kind, _) in self.parts.items() if kind not in _CHANGING]

    def _number(self, tick: int | None) -> int:
        if tick is None:
            return len(self._known) - 1
        if isinstance(tick, bool) or not isinstance(tick, int | np.integer):
            raise TickError(f"{tick!r} is not a tick; give a whole number")
        if not self.since <= tick <= self.until:
            raise TickError(
                f"tick {tick} is not in this inference, which is of ticks {self.since} to "
                f"{self.until}"
            )
        numbers = [number for number, step in enumerate(self._known) if step.tick <= tick]
        return numbers[-1] if numbers else -1

    def _step(self, tick: int | None) -> FilterStep | None:
        number = self._number(tick)
        return None if number < 0 else self._known[number]

    def _log_actual(self, step: FilterStep | None) -> Floats:
        """Log weights of the possible actual alternatives, as far as they agree with the node."""
        weights = self.model.actual_weights
        names = self.model.alternative_names
        agrees = -1 if step is None else step.agrees
        shares = [1.0 if weights is None else weights[name] for name in names]
        if weights is None:
            shares = [weight * (agrees >> a & 1) for a, weight in enumerate(shares)]
        with np.errstate(divide="ignore"):
            logs: Floats = np.log(np.array(shares)) - np.log(sum(shares))
        return logs

    @cached_property
    def _log_weights(self) -> Floats:
        """Log prior (rationalities, utilities, credences)."""
        count = len(self.model.rationalities)
        with np.errstate(divide="ignore"):
            prior = np.log(self.model.prior_weights) - math.log(count)
        return np.broadcast_to(prior, (count, *prior.shape))

    def _log_prior(self, step: FilterStep | None) -> Floats:
        prior: Floats = self._log_actual(step)[:, None, None, None] + self._log_weights
        return prior

    def _is_possible(self, step: FilterStep) -> bool:
        """Return True if a hypothesis that the model allows explains all evidence to a step."""
        return step.is_possible and bool(np.isfinite(self._log_prior(step) + step.weights).any())

    def _posterior_of(self, step: FilterStep | None) -> Floats:
        logs = self._log_prior(step)
        if step is not None:
            logs = logs + step.weights
        shares: Floats = np.exp(logs - log_sum(logs.reshape(-1)))
        return shares

    def _parts_of(self, factor: str) -> tuple[str, str]:
        parts = self.parts
        if factor not in parts:
            raise InputError(f"no factor {factor!r}; there are {', '.join(parts)}")
        return parts[factor]

    def _marginal_of(self, factor: str, number: int) -> dict[Any, float]:
        kind, name = self._parts_of(factor)
        step = None if number < 0 else self._known[number]
        if kind in _CHANGING:
            if step is None:
                raise TickError(
                    f"{self.model.agent} had not been seen until then; ask from tick "
                    f"{self._known[0].tick} on"
                )
            return self._changing(kind, name, self._smooth_step(number))
        return self._grouped(factor, self._posterior_of(step))

    def _smooth_step(self, number: int) -> FilterStep:
        # A course that no hypothesis explains stays unexplained.
        if not self.smooth or self._failed is not None:
            return self._known[number]
        return self._smoothed[number]

    @cached_property
    def _kept(self) -> Sequence[Tracker]:
        """The filters with their layers, computed for the first question about the past."""
        return self._keep()

    @cached_property
    def _smoothed(self) -> list[FilterStep]:
        return _merged([_smoothed_steps(tracker) for tracker in self._kept])

    def _grouped(self, factor: str, posterior: Floats) -> dict[Any, float]:
        values = self._values(factor)
        axes = tuple(axis for axis, size in enumerate(values.shape) if size == 1)
        shares: dict[Any, float] = {}
        summed = posterior.sum(axis=axes).reshape(-1).tolist()
        for value, share in zip(values.reshape(-1).tolist(), summed, strict=True):
            shares[value] = shares.get(value, 0.0) + share
        return dict(sorted(shares.items()))

    def _changing(self, kind: str, name: str, step: FilterStep) -> dict[Any, float]:
        actual = self._log_actual(step)
        logs: dict[Any, list[float]] = {}
        rows = self.model.credence_rows
        for a, masses in enumerate(step.states):
            for (cell, possible, believed, _), mass in masses.items():
                if kind == "cell":
                    logs.setdefault(cell, []).append(float(actual[a] + log_sum(mass)))
                    continue
                reported = reported_credence(rows, possible, believed, self.model.lapse)
                column = reported[:, self.model.alternative_names.index(name)]
                for value, weight in zip(column.tolist(), mass.tolist(), strict=True):
                    logs.setdefault(value, []).append(float(actual[a] + weight))
        return _shares(logs)

    def _values(self, factor: str) -> npt.NDArray[np.float64]:
        """Return values of a factor, on the axes (actual, rationality, utility, credence)."""
        kind, name = self._parts_of(factor)
        model = self.model
        if kind == "utility":
            number = list(model.goals).index(name)
            return model.utility_rows[:, number].reshape(1, 1, -1, 1)
        if kind == "credence":
            number = model.alternative_names.index(name)
            return model.credence_rows[:, number].reshape(1, 1, 1, -1)
        if kind == "actual":
            flags = [float(other == name) for other in model.alternative_names]
            return np.array(flags).reshape(-1, 1, 1, 1)
        if kind == "rationality":
            return np.array(model.rationalities).reshape(1, -1, 1, 1)
        raise InputError(
            f"{factor} is no part of a hypothesis: it changes from step to step; ask for its "
            "marginal"
        )

    def _told(self, posterior: Floats, number: int) -> dict[str, Any]:
        a, b, u, w = (int(part) for part in np.unravel_index(number, posterior.shape))
        model = self.model
        names = model.alternative_names
        report: dict[str, Any] = {
            f"utility.{goal}": float(model.utility_rows[u, n]) for n, goal in enumerate(model.goals)
        }
        if model.doubt is not None:
            report |= {
                f"credence.{name}": float(model.credence_rows[w, n]) for n, name in enumerate(names)
            }
            report["actual"] = names[a]
        if len(model.rationalities) > 1:
            report["rationality"] = model.rationalities[b]
        return {**report, "probability": float(posterior[a, b, u, w])}


def _merged(parts: Sequence[Sequence[FilterStep]]) -> list[FilterStep]:
    """Join the steps of chunks of utilities."""
    if len(parts) == 1:
        return list(parts[0])
    return list(_joined_steps(parts))


def _joined_steps(parts: Sequence[Sequence[FilterStep]]) -> Iterator[FilterStep]:
    longest = max(parts, key=len)
    for number, longest_step in enumerate(longest):
        at = [steps[min(number, len(steps) - 1)] for steps in parts]
        weights = np.concatenate([step.weights for step in at], axis=2)
        states = []
        for a in range(len(longest_step.states)):
            logs: dict[Any, list[Floats]] = {}
            for step in at:
                for state, mass in step.states[a].items():
                    logs.setdefault(state, []).append(mass)
            states.append({state: log_sum(np.stack(each)) for state, each in logs.items()})
        is_possible = any(step.is_possible for step in at)
        yield replace(longest_step, weights=weights, states=tuple(states), is_possible=is_possible)


def _shares(logs: Mapping[Any, Sequence[float]]) -> dict[Any, float]:
    """Probabilities of values from logarithms of their parts."""
    values = sorted(logs)
    totals = np.array([float(log_sum(np.array(logs[value]))) for value in values])
    shares = np.exp(totals - log_sum(totals))
    return {value: share for value, share in zip(values, shares.tolist(), strict=True) if share > 0}


def _divergence(after: Mapping[Any, float], before: Mapping[Any, float]) -> float:
    """Kullback and Leibler's divergence of one distribution from another, in bits."""
    terms = [
        share * math.log2(share / before[value])
        for value, share in after.items()
        if share > 0 and before.get(value, 0) > 0
    ]
    return max(0.0, math.fsum(terms))


def _smoothed_steps(tracker: Tracker) -> list[FilterStep]:
    """Return the steps of a filter, with their states conditioned on all evidence."""
    by_actual = [_smoothed(tracker, actual, layers) for actual, layers in enumerate(tracker.trail)]
    count = len(tracker.hypotheses.credences)
    steps = []
    for step in tracker.steps:
        masses = []
        for layers, moments in zip(tracker.trail, by_actual, strict=True):
            joint = moments[sum(layer.tick <= step.tick for layer in layers)]
            masses.append(
                {
                    state: log_sum((weight + tracker.log_prior).reshape(-1, count))
                    for state, weight in joint.items()
                }
            )
        steps.append(replace(step, states=tuple(masses)))
    return steps


def _sampled_cells(
    tracker: Tracker, actual: int, hypothesis: tuple[int, int, int], random: np.random.Generator
) -> dict[int, Position]:
    """Draw the cell of the agent at each tick of its course, given all evidence.

    Random numbers are used only where several states are possible. A tick at which nothing of the
    course was perceived has one way back, so it changes no draw.

    Args:
        tracker: A filter with layers.
        actual: Number of the actual alternative.
        hypothesis: Numbers of rationality, utility and credence.
        random: Random generator.

    Returns:
        Cell by tick, from the first tick of the course to the last with evidence.
    """
    state = _drawn(
        {each: float(weight[hypothesis]) for each, weight in tracker.states[actual].items()}, random
    )
    cells: dict[int, Position] = {}
    left = tracker.steps[-1].tick
    for layer in reversed(tracker.trail[actual]):
        for tick in range(layer.tick, left + 1):
            cells[tick] = state[0]
        left = min(left, layer.tick - 1)
        parts: dict[WalkState, list[float]] = {}
        for source, action in layer.sources(state):
            chance = _chance(tracker.hypotheses, action)
            inside = 0.0 if chance is None else float(_at(chance, hypothesis))
            parts.setdefault(source, []).append(float(layer.before[source][hypothesis]) + inside)
        state = _drawn({source: _log_sum_of(logs) for source, logs in parts.items()}, random)
    for tick in range(tracker.steps[0].tick, left + 1):
        cells[tick] = state[0]
    return dict(sorted(cells.items()))


def _log_sum_of(logs: Sequence[float]) -> float:
    return logs[0] if len(logs) == 1 else float(log_sum(np.array(logs)))


def _smoothed(
    tracker: Tracker, actual: int, layers: Sequence[Layer]
) -> list[Mapping[WalkState, Floats]]:
    """Return joint weights of states and all evidence, before each layer and after the last."""
    last = tracker.states[actual]
    ahead: dict[WalkState, Floats] = {
        state: np.zeros_like(weight) for state, weight in last.items()
    }
    masses: list[Mapping[WalkState, Floats]] = [last]
    for layer in reversed(layers):
        parts: dict[WalkState, list[Floats]] = {}
        for source, target, action in layer.edges:
            if target in ahead:
                chance = _chance(tracker.hypotheses, action)
                rest = ahead[target]
                parts.setdefault(source, []).append(rest if chance is None else rest + chance)
        ahead = {
            state: each[0] if len(each) == 1 else log_sum(np.stack(each))
            for state, each in parts.items()
        }
        masses.append({state: layer.before[state] + weight for state, weight in ahead.items()})
    return masses[::-1]


def _chance(hypotheses: Hypotheses, action: Action | None) -> Floats | None:
    if action is None:
        return None
    stage, cell, knowledge, numbers = action
    policy = hypotheses.log_policy(stage, cell, knowledge)[list(numbers)]
    return log_sum(policy)


def _at(chance: Floats, hypothesis: tuple[int, int, int]) -> float:
    b, u, w = hypothesis
    # A certain knowledge has one value for all credences.
    return float(chance[b, u, min(w, chance.shape[2] - 1)])


def _drawn(logs: Mapping[WalkState, float], random: np.random.Generator) -> WalkState:
    possible = [state for state, log in logs.items() if log > -math.inf]
    if len(possible) == 1:
        return possible[0]
    states = sorted(possible)
    weights = np.array([logs[state] for state in states])
    shares = np.exp(weights - log_sum(weights))
    return states[int(random.choice(len(states), p=shares / shares.sum()))]
