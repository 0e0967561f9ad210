"""Inference on one node: read its timeline, run the filter, return the result."""

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import msgspec
import numpy as np
import numpy.typing as npt

from beliefnest.errors import InputError, TickError, TooLargeError
from beliefnest.minds.evidence import EvidenceMoment
from beliefnest.minds.hypotheses import Hypotheses
from beliefnest.minds.inference import Inference, reported_credence
from beliefnest.minds.mind_model import MindModel
from beliefnest.minds.perceived_course import CourseQuestion, CourseReading
from beliefnest.minds.planner import count_doubtful, count_values
from beliefnest.minds.surroundings import Surroundings
from beliefnest.minds.tracking import Tracker
from beliefnest.minds.transitions import known_after
from beliefnest.nest.past.recording import Recording
from beliefnest.world.memory import MEGABYTE, memory_limit
from beliefnest.world.paths import BeliefPath, path_text
from beliefnest.world.values import Position

_ROOM = 2**27
"""Limit of the values of one chunk of utilities, in bytes."""

_MOST_READINGS, _MOST_FILTERS = 8, 4

_STEP_TICKS = {"scripted": 1}
_MINECRAFT_STEP = 5
"""Ticks of a bot's diagonal step; a straight one takes 3 or 4. With fewer a diagonal step would
count as a step and a stay."""


def infer_in(
    recording: Recording,
    path: BeliefPath,
    model: MindModel,
    since: int,
    until: int | None,
    *,
    ended: bool,
    smooth: bool,
) -> Inference:
    """Infer an agent's desires and beliefs from the record of its course in a node.

    Raises:
        InputError: The model does not fit the node.
        PathError: There is no such agent.
        TickError: A tick lies in the future or before the start.
    """
    if not isinstance(model, MindModel):
        raise InputError(f"the model is {model!r}; give a MindModel")
    work = _work_on(recording, path, model, since, until)
    if not work.reading.has_seen:
        raise InputError(
            f"{path_text(path)} has not seen {model.agent} from tick {since} to "
            f"{work.reading.latest}; infer in a simulator that sees it, or up to a later tick"
        )
    step_ticks = model.step_ticks or _STEP_TICKS.get(recording.world, _MINECRAFT_STEP)
    _check_goals(model, work.reading.moments)
    return work.inferred(model, since, step_ticks, ended=ended, smooth=smooth)


class ModelStart(msgspec.Struct, frozen=True, eq=False):
    """Start of a model at one tick of a node.

    Attributes:
        model: The model.
        scene: All alternatives at that tick.
        agrees: The alternatives that agree with the node from that tick on.
        step_ticks: Ticks that an action takes.
        scenes: The same alternatives at all ticks that were read.
    """

    model: MindModel
    scene: Surroundings
    agrees: int
    step_ticks: int
    scenes: Sequence[Surroundings]

    def check_goals(self, cell: Position) -> None:
        """Raise InputError if no goal can be reached from a cell in any scene."""
        _check_reach(self.model, [(scene, cell) for scene in self.scenes if scene.can_stand(cell)])


def start_of_model(
    recording: Recording, path: BeliefPath, model: MindModel, since: int, until: int
) -> ModelStart:
    """Return the start of a model at a tick; agreement is tested up to another tick.

    Raises:
        InputError, PathError, TickError: As for `infer_in`.
    """
    reading = _work_on(recording, path, model, since, until).reading
    step_ticks = model.step_ticks or _STEP_TICKS.get(recording.world, _MINECRAFT_STEP)
    scenes = list({id(m.scene): m.scene for m in reading.moments}.values())
    return ModelStart(model, scenes[0], reading.agrees, step_ticks, scenes)


@dataclass
class _Work:
    """Reading of a node, and the filters that have processed it so far, by model.

    An inference at a later tick continues with them.
    """

    reading: CourseReading
    generation: int
    filters: dict[bytes, tuple[int, list[Tracker]]] = field(default_factory=dict)

    def goes_on(self, recording: Recording, until: int) -> bool:
        """Return True if the timeline has no new entries at ticks that were read."""
        same = recording.history.generation == self.generation
        return same and self.reading.latest <= until and self.reading.is_whole

    def inferred(
        self, model: MindModel, since: int, step_ticks: int, *, ended: bool, smooth: bool
    ) -> Inference:
        """Return the posterior at the last tick that was read."""
        moments, until = self.reading.moments, self.reading.latest
        key = _digest(model, step_ticks)
        count, trackers = self.filters.get(key) or (0, _trackers(model, moments, step_ticks))
        for tracker in trackers:
            tracker.follow(moments[count:], until)
        self.filters = {**self.filters, key: (len(moments), trackers)}
        while len(self.filters) > _MOST_FILTERS:
            del self.filters[next(iter(self.filters))]
        return _told(model, tuple(moments), since, until, step_ticks, trackers, ended, smooth)


def _work_on(
    recording: Recording, path: BeliefPath, model: MindModel, since: int, until: int | None
) -> _Work:
    """Return the reading of a node up to a tick; continue an earlier one if possible."""
    moment = recording.moment(path, until)
    question = _question(recording, path, model, since)
    if question.since > moment.tick:
        raise TickError(
            f"since is {since}, after the last tick, {moment.tick}; give an earlier one"
        )
    key = ("inference", moment.timeline, repr(question))
    older = recording.remembered.pop(key, None)
    if isinstance(older, _Work) and older.goes_on(recording, moment.tick):
        work = older
    else:
        work = _Work(CourseReading(recording, question), recording.history.generation)
    work.reading.read(until)
    work.generation = recording.history.generation
    if not isinstance(older, _Work) or work is older or work.reading.latest >= older.reading.latest:
        recording.remembered[key] = work
    else:
        recording.remembered[key] = older
    kept = [other for other in recording.remembered if isinstance(other, tuple)]
    for other in kept[:-_MOST_READINGS]:
        del recording.remembered[other]
    return work


def _question(
    recording: Recording, path: BeliefPath, model: MindModel, since: int
) -> CourseQuestion:
    first = recording.stretches(recording.moment(path))[0]
    begin = recording.journal.info(first.timeline).start
    if since != 0 and since < begin:
        raise TickError(f"since is {since}, before the start, which is tick {begin}")
    return CourseQuestion(
        path,
        model.agent,
        dict(model.goal_values),
        model.alternatives,
        model.actual is not None,
        model.diagonal,
        begin if since == 0 else since,
    )


def _check_goals(model: MindModel, moments: Sequence[EvidenceMoment]) -> None:
    """Raise InputError if no goal can be reached in any alternative."""
    _check_reach(
        model, [(moment.scene, moment.cell) for moment in moments if moment.cell is not None]
    )


def _check_reach(model: MindModel, places: Sequence[tuple[Surroundings, Position]]) -> None:
    if not places or any(scene.stage(cell).acts.any() for scene, cell in places):
        return
    raise InputError(
        f"none of the goals {', '.join(model.goals)} can be reached by {model.agent} from "
        f"{places[0][1]} in any alternative; check their places and the floor that is known"
    )


def _digest(model: MindModel, step_ticks: int) -> bytes:
    """Return a digest of the inputs of a filter other than the reading."""
    rules = Hypotheses.of(model, step_ticks).rules
    digest = hashlib.blake2b(repr((rules, model.rationalities, step_ticks, model.stays)).encode())
    for table in (model.utility_rows, model.credence_rows, model.prior_weights):
        digest.update(repr(table.shape).encode())
        digest.update(np.ascontiguousarray(table).tobytes())
    return digest.digest()


def _trackers(
    model: MindModel, moments: Sequence[EvidenceMoment], step_ticks: int, *, keeps: bool = False
) -> list[Tracker]:
    """Return filters at their start, one for each chunk of utilities."""
    trackers = []
    for part in _chunks(model, moments):
        with np.errstate(divide="ignore"):
            prior = np.log(model.prior_weights[part]) - np.log(len(model.rationalities))
        trackers.append(Tracker(Hypotheses.of(model, step_ticks, part), prior, keeps=keeps))
    return trackers


def _told(
    model: MindModel,
    moments: Sequence[EvidenceMoment],
    since: int,
    until: int,
    step_ticks: int,
    trackers: Sequence[Tracker],
    ended: bool,
    smooth: bool,
) -> Inference:
    def again(tick: int, *, keeps: bool) -> Sequence[Tracker]:
        made = _trackers(model, moments, step_ticks, keeps=keeps)
        for tracker in made:
            tracker.follow([moment for moment in moments if moment.tick <= tick], tick)
        return made

    def rerun(tick: int) -> Inference:
        made = again(tick, keeps=False)
        return _told(model, moments, since, tick, step_ticks, made, False, False)

    def kept() -> list[Tracker]:
        return [tracker.finished(until, ended=ended) for tracker in again(until, keeps=True)]

    finished = [tracker.finished(until, ended=ended) for tracker in trackers]
    return Inference(model, since, until, finished, rerun, kept, smooth=smooth)


def _chunks(model: MindModel, moments: Sequence[EvidenceMoment]) -> list[slice]:
    """Return chunks of the utilities whose values fit into memory.

    Raises:
        TooLargeError: Those of one utility do not.
    """
    first = next(moment for moment in moments if moment.cell is not None)
    assert first.cell is not None
    stage, credences, limit = (
        first.scene.stage(first.cell),
        len(model.credence_rows),
        memory_limit(),
    )
    least = 8 * count_doubtful(stage) * credences
    if limit is not None and least > limit.bytes:
        raise TooLargeError(
            f"plans of {model.agent} from {first.cell} need at least {least // MEGABYTE:,} MB, for "
            f"{len(stage.cells):,} cells that it can get to and {credences:,} credences. This "
            f"process may use {limit.bytes // MEGABYTE:,} MB, {limit.source}: use a smaller box, "
            "walls or gaps in the floor, or a coarser grid of credences"
        )
    values = count_values(stage, credences)
    size = max(1, _ROOM // (8 * values))
    count = len(model.utility_rows)
    return [slice(start, min(start + size, count)) for start in range(0, count, size)]


def credence_in(
    recording: Recording,
    path: BeliefPath,
    agent: str,
    doubt: Mapping[str, Any],
    initial: npt.ArrayLike | None,
    actual: str | Mapping[str, float] | None,
    lapse: float,
    since: int,
    tick: int | None,
) -> dict[str, float]:
    """Return the credence of an agent in alternatives, by its percepts alone, without a planner.

    Args:
        recording: Record with the node.
        path: The node that attributes the credence.
        agent: The agent.
        doubt: Alternatives by name, as for `MindModel`.
        initial: Probabilities of the alternatives just before the percept at `since`; None:
            uniform.
        actual: The actual alternative, as for `MindModel`.
        lapse: As for `MindModel`.
        since: Tick whose percept is the first to update the initial credence.
        tick: Tick of the answer; None: the latest.

    Raises:
        InputError, PathError, TickError: As for `infer_in`.
    """
    rows: Any = None if initial is None else [initial]
    model = MindModel(
        agent, {"any": {"at": (0, 0, 0)}}, {"any": 0}, doubt, rows, actual, lapse=lapse
    )
    reading = _work_on(recording, path, model, since, tick).reading
    names = model.alternative_names
    weights = model.actual_weights
    agrees = reading.agrees
    shares = [
        float(agrees >> a & 1) if weights is None else weights[name] for a, name in enumerate(names)
    ]
    total = np.zeros(len(names))
    knowledge = known_after(reading.moments, len(names))
    for share, (possible, believed) in zip(shares, knowledge, strict=True):
        total += share * reported_credence(model.credence_rows[0], possible, believed, model.lapse)
    return dict(zip(names, (total / sum(shares)).tolist(), strict=True))
