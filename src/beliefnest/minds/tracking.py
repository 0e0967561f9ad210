"""Filter that tracks how well each hypothesis explains an observer's percepts of an agent.

A state of the agent consists of its cell, its knowledge, and a flag for the end of its course. For
each possible actual alternative and each hypothesis, the filter keeps the weights of all possible
states. While the agent is in sight there are one or few states. In a gap (the agent is out of
sight) the policy spreads the weights, and states that contradict the observer's percepts vanish.
Weights are logarithms of the probability of all evidence so far; -inf means impossible.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import ceil

import msgspec
import numpy as np
from msgspec.structs import replace

from beliefnest.minds.evidence import EvidenceMoment
from beliefnest.minds.hypotheses import (
    Hypotheses,
    Layer,
    Sums,
    WalkState,
    WalkStates,
    conditioned,
    joined,
    told,
)
from beliefnest.minds.planner import log_sum
from beliefnest.minds.stage import Stage, shortest
from beliefnest.minds.surroundings import Surroundings
from beliefnest.minds.transitions import (
    act,
    arrive,
    by_stage,
    goal_acts,
    learn,
    look_round,
    spread,
    stage_of,
    unseen,
)
from beliefnest.world.array_types import Floats
from beliefnest.world.values import Position

# Reasons why no hypothesis explains a piece of evidence.
_DISAGREES = "no alternative agrees with what the observer's node holds"
_MOVES = "no steps lead from the one cell to the other on the floor that the observer knows"
_OPENS = "from there the container is out of reach, or its contents are not in doubt for the agent"
_ACTS = "the goal is not in reach there, or the agent cannot be certain of it"
_ENDS = "no goal is in reach there"
_HIDES = "the observer would have seen it wherever it can be by then"
_APPEARS = "no way leads there on which the observer would not have seen it"


class FilterStep(msgspec.Struct, frozen=True, eq=False):
    """The filter after a piece of evidence.

    Attributes:
        tick: Tick of the evidence.
        text: The evidence in words.
        weights: float64 (actuals, rationalities, utilities, credences), log probability of all
            evidence so far.
        states: By actual alternative and state, these weights summed with the prior over
            rationalities and utilities: log weights (credences,).
        agrees: The alternatives that have agreed with the node until then.
        is_action: True if the agent acted; False if it only perceived something.
        is_movement: True if the agent was seen to change its cell.
        why: The reason if no hypothesis explains the evidence.
    """

    tick: int
    text: str
    weights: Floats
    states: tuple[Mapping[WalkState, Floats], ...]
    agrees: int
    is_action: bool
    is_movement: bool
    why: str
    is_possible: bool


@dataclass
class _Gap:
    """Period in which the agent is out of sight.

    Attributes:
        start: The last tick at which it was seen.
        cell: Its cell at that tick.
        before: The states at that tick.
        moments: The moment of that tick, and all moments since.
        marks: By actual alternative, the number of layers at that tick.
        count: Number of actions that have ended since.
    """

    start: int
    cell: Position
    before: WalkStates
    moments: list[EvidenceMoment]
    marks: tuple[int, ...]
    count: int = 0


@dataclass
class Tracker:
    """Filter at the current moment; `again` makes an independent copy.

    Attributes:
        hypotheses: The tracked hypotheses.
        log_prior: float64 (utilities, credences), the prior with which `FilterStep.states` are
            summed.
        states: Weights after the latest evidence.
        steps: The filter after each piece of evidence.
        tick: The last processed tick.
        keeps: True if layers are kept.
        trail: Layers by actual alternative, if they are kept.
    """

    hypotheses: Hypotheses
    log_prior: Floats
    states: WalkStates = ()
    steps: list[FilterStep] = field(default_factory=list)
    tick: int = -1
    keeps: bool = False
    trail: tuple[list[Layer], ...] = ()
    _agrees: int = -1
    _moment: EvidenceMoment | None = None
    _cell: Position | None = None
    _quiet: int = 0
    _gap: _Gap | None = None
    _over: bool = False
    _claims: tuple[int, ...] = ()

    def again(self) -> "Tracker":
        """Return an independent copy."""
        gap = self._gap
        copied = (
            None
            if gap is None
            else _Gap(gap.start, gap.cell, gap.before, list(gap.moments), gap.marks, gap.count)
        )
        return Tracker(
            self.hypotheses,
            self.log_prior,
            self.states,
            list(self.steps),
            self.tick,
            self.keeps,
            tuple(list(layers) for layers in self.trail),
            self._agrees,
            self._moment,
            self._cell,
            self._quiet,
            copied,
            self._over,
            self._claims,
        )

    def follow(self, moments: Sequence[EvidenceMoment], until: int) -> None:
        """Process the next moments, and then quiet ticks up to a tick."""
        for moment in moments:
            if self._moment is None:
                if moment.cell is None:
                    self._claims += moment.claims
                else:
                    self._begin(moment)
                continue
            self._pass_to(moment.tick - 1)
            self._take(moment)
        self._pass_to(until)

    def finished(self, until: int, *, ended: bool) -> "Tracker":
        """Return the filter at the last tick, with the evidence that counts only at the end."""
        last = self.again()
        gap = last._gap
        if gap is not None and not last._over:
            due = round((until - gap.start) / last.hypotheses.step_ticks)
            if due > gap.count:
                last._act_unseen(until)
        if ended and not last._over:
            last._end(until)
        return last

    # Moments in sight

    def _begin(self, moment: EvidenceMoment) -> None:
        everyone = (1 << self.hypotheses.alternatives) - 1
        assert moment.cell is not None
        zeros = np.zeros(self.hypotheses.shape)
        knowledge = (everyone, everyone)
        for mask in self._claims:
            knowledge = told(knowledge, mask)
        start: WalkState = (moment.cell, *knowledge, False)
        self.states = tuple({start: zeros} for _ in range(self.hypotheses.alternatives))
        self.trail = tuple([] for _ in self.states)
        self._cell = moment.cell
        self._perceive(moment)
        self._note(moment.tick, f"is first seen at {moment.cell}", is_action=False)

    def _take(self, moment: EvidenceMoment) -> None:
        if self._over:
            self._moment, self.tick = moment, moment.tick
            self._agree(moment)
            return
        if self._moment is not None and moment.tick == self._moment.tick:
            self._fork(moment)
            return
        if moment.cell is None:
            if self._gap is None:
                assert self._cell is not None and self._moment is not None
                marks = tuple(len(layers) for layers in self.trail)
                self._gap = _Gap(moment.tick - 1, self._cell, self.states, [self._moment], marks)
                self._quiet = 0
            self._gap.moments.append(moment)
            self._moment, self.tick = moment, moment.tick
            self._agree(moment)
            due = self._due(moment.tick)
            if due:
                self._act_unseen(moment.tick)
            self._hear(moment)
            if not due:
                self.states = tuple(
                    self._look_round(moment.scene, actual, weights, self.tick)
                    for actual, weights in enumerate(self.states)
                )
            return
        if self._gap is not None:
            self._reappear(moment)
            return
        self._see(moment)

    def _fork(self, moment: EvidenceMoment) -> None:
        """Continue in a fork; there an agent out of sight stands at its last seen place."""
        if self._gap is not None and moment.cell is not None:
            self.states = self._gap.before
            for layers, mark in zip(self.trail, self._gap.marks, strict=True):
                del layers[mark:]
            self._gap = None
        self._quiet = 0
        self._cell = moment.cell or self._cell
        if moment.cell is None:
            self._moment = moment
            self._agree(moment)
        else:
            self._perceive(moment)
            self._note(moment.tick, f"perceives at {moment.cell}", is_action=False)

    def _see(self, moment: EvidenceMoment) -> None:
        """Explain what the agent does in sight."""
        assert moment.cell is not None and self._cell is not None
        self.tick = moment.tick
        before, cell = self._cell, moment.cell
        text, why, is_action = "", _DISAGREES, True
        if cell != before:
            self._quiet = 0
            self.states = self._moved(moment, before, cell)
            text, why = f"moves from {before} to {cell}", _MOVES
        elif moment.act is not None or moment.opened is not None:
            self._quiet = 0
            stage = self._stage(before)
            self.states = self._did(stage, moment)
            if moment.act is not None:
                text = f"acts on goal {self.hypotheses.goals[moment.act]} at {cell}"
                why = _ACTS
                self._over = True
            else:
                text, why = f"opens the container at {moment.opened} from {cell}", _OPENS
        elif not moment.deed and self._stays_now():
            self.states = self._stayed(self._stage(before))
            text = f"stays at {cell}"
        else:
            is_action = False
        self._cell = cell
        changed = self._perceive(moment)
        if text or changed:
            text = text or f"perceives at {cell}"
            self._note(moment.tick, text, why, is_action=is_action, is_movement=cell != before)

    def _stays_now(self) -> bool:
        """Count a tick without movement; return True if it completes a stay."""
        if not self.hypotheses.stays:
            return False
        self._quiet += 1
        if self._quiet < self.hypotheses.step_ticks:
            return False
        self._quiet = 0
        return True

    def _pass_to(self, tick: int) -> None:
        """Process quiet ticks (ticks without changes) up to a tick."""
        while self.tick < tick and not self._over and self._moment is not None:
            self.tick += 1
            if self._gap is not None:
                if self._due(self.tick):
                    self._act_unseen(self.tick)
            elif self._stays_now():
                assert self._cell is not None
                self.states = self._stayed(self._stage(self._cell))
                self._note(self.tick, f"stays at {self._cell}")
        self.tick = max(self.tick, tick)

    def _stayed(self, stage: Stage) -> WalkStates:
        assert self._cell is not None
        return self._seen(stage, self.states, self._cell)

    def _moved(self, moment: EvidenceMoment, before: Position, cell: Position) -> WalkStates:
        """Advance over a change of cell: one step, or several steps in one tick."""
        stage = self._stage(before)
        if cell not in stage.index:
            # The observer did not know before that an agent can stand there.
            stage = stage_of(moment.scene, before, cell)
        states: list[Mapping[WalkState, Floats]] = []
        for actual, weights in enumerate(self.states):
            steps = shortest(stage, actual, before, cell)
            states.append(
                {} if steps is None else self._way(stage, actual, weights, cell, steps, moment.tick)
            )
        return tuple(states)

    def _way(
        self,
        stage: Stage,
        actual: int,
        weights: Mapping[WalkState, Floats],
        cell: Position,
        steps: int,
        tick: int,
    ) -> Mapping[WalkState, Floats]:
        """Advance over several actions; only the end of the last one is seen."""
        for _ in range(steps - 1):
            sums = self._sums(actual, tick, weights)
            spread(self.hypotheses, stage, actual, weights, sums)
            weights = sums.total()
            sums = self._sums(actual, tick, weights)
            look_round(stage, actual, weights, sums)
            weights = sums.total()
        sums = self._sums(actual, tick, weights)
        arrive(self.hypotheses, stage, actual, weights, cell, sums)
        return sums.total()

    def _seen(self, stage: Stage, states: WalkStates, cell: Position) -> WalkStates:
        states_now = []
        for actual, weights in enumerate(states):
            sums = self._sums(actual, self.tick, weights)
            arrive(self.hypotheses, stage, actual, weights, cell, sums)
            states_now.append(sums.total())
        return tuple(states_now)

    def _did(self, stage: Stage, moment: EvidenceMoment) -> WalkStates:
        """Advance over a perceived opening or act on a goal."""
        if moment.act is not None:
            action = goal_acts(stage)[moment.act]
        elif moment.opened is not None and moment.opened in stage.box_index:
            action = 1 + stage.moves.shape[2] + stage.box_index[moment.opened]
        else:
            return tuple({} for _ in self.states)
        states = []
        for actual, weights in enumerate(self.states):
            sums = self._sums(actual, moment.tick, weights)
            act(self.hypotheses, stage, weights, (action,), sums, ends=moment.act is not None)
            states.append(sums.total())
        return tuple(states)

    def _end(self, tick: int) -> None:
        """Advance over the act after the last tick."""
        assert self._moment is not None
        states = []
        for actual, weights in enumerate(self.states):
            sums = self._sums(actual, tick, weights)
            for stage, part in by_stage(self._moment.scene, weights):
                act(self.hypotheses, stage, part, goal_acts(stage), sums, ends=True)
            states.append(sums.total())
        self.states = tuple(states)
        self._note(tick, f"acts on a goal where it is, at {self._cell}, and ends", _ENDS)

    # Gaps

    def _due(self, tick: int) -> bool:
        """Return True if the next action of a gap has ended at a tick."""
        assert self._gap is not None
        return tick >= self._gap.start + (self._gap.count + 1) * self.hypotheses.step_ticks

    def _act_unseen(self, tick: int) -> None:
        """Advance over one action whose end is not seen."""
        assert self._gap is not None and self._moment is not None
        before = self._gap.moments[-2] if self._moment.tick == tick else self._moment
        self.states = self._unseen_action(before.scene, self._moment, self.states)
        self._gap.count += 1
        self._note(tick, f"is out of sight, last seen at {self._gap.cell}", _HIDES)

    def _unseen_action(
        self, scene: Surroundings, moment: EvidenceMoment, states: WalkStates
    ) -> WalkStates:
        states_now = []
        for actual, weights in enumerate(states):
            moved = self._spread_all(scene, actual, weights, self.tick)
            hidden = unseen(moment, actual, moved)
            states_now.append(self._look_round(moment.scene, actual, hidden, self.tick))
        return tuple(states_now)

    def _spread_all(
        self, scene: Surroundings, actual: int, weights: Mapping[WalkState, Floats], tick: int
    ) -> Mapping[WalkState, Floats]:
        sums = self._sums(actual, tick, weights)
        for stage, part in by_stage(scene, weights):
            spread(self.hypotheses, stage, actual, part, sums)
        return sums.total()

    def _reappear(self, moment: EvidenceMoment) -> None:
        """Explain the cell in which the agent is seen again."""
        gap = self._gap
        assert gap is not None and moment.cell is not None
        self.tick = moment.tick
        ticks = moment.tick - gap.start
        usual = round(ticks / self.hypotheses.step_ticks)
        last = gap.moments[-1]
        if not last.scene.can_stand(moment.cell):
            # The observer did not know before that an agent can stand there.
            last = replace(last, scene=moment.scene)
            gap.moments[-1] = last
        states: list[Mapping[WalkState, Floats]] = []
        for actual in range(self.hypotheses.alternatives):
            stage = stage_of(last.scene, gap.cell, moment.cell)
            steps = shortest(stage, actual, gap.cell, moment.cell)
            if steps is None:
                states.append({})
            elif steps <= usual and usual == gap.count + 1:
                states.append(self._arrived_from(last.scene, actual, self.states[actual], moment))
            else:
                states.append(self._again_through(gap, actual, max(usual, steps), moment))
        self.states = tuple(states)
        self._gap = None
        self._quiet = 0
        self._cell = moment.cell
        if (moment.act is not None or moment.opened is not None) and not self._is_impossible():
            self.states = self._did(stage_of(moment.scene, moment.cell), moment)
            self._over = moment.act is not None
        self._perceive(moment)
        text = f"is seen again at {moment.cell}, last seen at {gap.cell}"
        self._note(moment.tick, text, _APPEARS, is_movement=moment.cell != gap.cell)

    def _arrived_from(
        self,
        scene: Surroundings,
        actual: int,
        weights: Mapping[WalkState, Floats],
        moment: EvidenceMoment,
    ) -> Mapping[WalkState, Floats]:
        assert moment.cell is not None
        sums = self._sums(actual, moment.tick, weights)
        for stage, part in by_stage(scene, weights):
            arrive(self.hypotheses, stage, actual, part, moment.cell, sums)
        return sums.total()

    def _again_through(
        self, gap: _Gap, actual: int, count: int, moment: EvidenceMoment
    ) -> Mapping[WalkState, Floats]:
        """Advance over a gap again, with a given number of evenly spread actions."""
        assert moment.cell is not None
        weights = gap.before[actual]
        del self.trail[actual][gap.marks[actual] :]
        if count == 0:
            return {state: weight for state, weight in weights.items() if state[0] == moment.cell}
        ticks = moment.tick - gap.start
        ends = [gap.start + ceil(ticks * number / count) for number in range(1, count + 1)]
        heard = 1
        for number in range(count - 1):
            before = _last_until(gap.moments, ends[number] - 1)
            weights = self._spread_all(before.scene, actual, weights, ends[number])
            now = _last_until(gap.moments, ends[number])
            if ends[number] < moment.tick and ends[number] != ends[number + 1]:
                weights = unseen(now, actual, weights)
            weights = self._look_round(now.scene, actual, weights, ends[number])
            while heard < len(gap.moments) and gap.moments[heard].tick <= ends[number]:
                weights = self._told_of(actual, weights, gap.moments[heard])
                heard += 1
        return self._arrived_from(gap.moments[-1].scene, actual, weights, moment)

    # Percepts

    def _perceive(self, moment: EvidenceMoment) -> bool:
        """Let the visible agent perceive; return True if its knowledge changed."""
        before = [set(weights) for weights in self.states]
        states = []
        for actual, weights in enumerate(self.states):
            sums = self._sums(actual, moment.tick, weights)
            masks = [same[actual] for same in (*moment.learnt, moment.alike)]
            learn(weights, conditioned, masks, sums)
            states.append(self._told_of(actual, sums.total(), moment))
        self.states = tuple(states)
        self._moment, self.tick = moment, max(self.tick, moment.tick)
        self._agree(moment)
        return before != [set(weights) for weights in self.states]

    def _agree(self, moment: EvidenceMoment) -> None:
        """Drop the alternatives that do not agree with the observer's node."""
        self._agrees &= moment.agrees
        self.states = tuple(
            weights if self._agrees >> actual & 1 else {}
            for actual, weights in enumerate(self.states)
        )

    def _hear(self, moment: EvidenceMoment) -> None:
        self.states = tuple(
            self._told_of(actual, weights, moment) for actual, weights in enumerate(self.states)
        )

    def _told_of(
        self, actual: int, weights: Mapping[WalkState, Floats], moment: EvidenceMoment
    ) -> Mapping[WalkState, Floats]:
        """Let the agent take up the claims of a moment."""
        if not moment.claims:
            return weights
        sums = self._sums(actual, moment.tick, weights)
        learn(weights, told, moment.claims, sums)
        return sums.total()

    def _look_round(
        self, scene: Surroundings, actual: int, weights: Mapping[WalkState, Floats], tick: int
    ) -> Mapping[WalkState, Floats]:
        """Let an agent out of sight perceive from the middle of its cell."""
        sums = self._sums(actual, tick, weights)
        for stage, part in by_stage(scene, weights):
            look_round(stage, actual, part, sums)
        return sums.total()

    # Records

    def foresee(self) -> None:
        """Let the agent do one more action without observation."""
        assert self._moment is not None
        nobody = replace(self._moment, watch=None)
        self.states = self._unseen_action(nobody.scene, nobody, self.states)

    def masses(self) -> tuple[Mapping[WalkState, Floats], ...]:
        """Return log weights of the states by credence, summed with the prior over the rest."""
        count = len(self.hypotheses.credences)
        return tuple(
            {
                state: log_sum((weight + self.log_prior).reshape(-1, count))
                for state, weight in weights.items()
            }
            for weights in self.states
        )

    def _stage(self, cell: Position) -> Stage:
        assert self._moment is not None
        return stage_of(self._moment.scene, cell)

    def _is_impossible(self) -> bool:
        return not any(
            np.isfinite(weight).any() for weights in self.states for weight in weights.values()
        )

    def _sums(self, actual: int, tick: int, before: Mapping[WalkState, Floats]) -> Sums:
        """Begin a layer of an alternative, if layers are kept."""
        if not self.keeps:
            return Sums()
        layer = Layer(tick, [], before)
        self.trail[actual].append(layer)
        return Sums(layer)

    def _note(
        self,
        tick: int,
        text: str,
        why: str = _DISAGREES,
        *,
        is_action: bool = True,
        is_movement: bool = False,
    ) -> None:
        shape = (self.hypotheses.alternatives, *self.hypotheses.shape)
        total = np.full(shape, -np.inf)
        for actual, weights in enumerate(self.states):
            if weights:
                total[actual] = joined(weights.values())
        is_possible = bool(np.isfinite(total).any())
        self.steps.append(
            FilterStep(
                tick,
                text,
                total,
                self.masses(),
                self._agrees,
                is_action,
                is_movement,
                why,
                is_possible,
            )
        )
        if not is_possible:
            self._over = True


def _last_until(moments: Sequence[EvidenceMoment], tick: int) -> EvidenceMoment:
    latest = moments[0]
    for moment in moments:
        if moment.tick <= tick:
            latest = moment
    return latest
