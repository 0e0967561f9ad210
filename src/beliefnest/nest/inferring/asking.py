"""Inference on one node: reads its timeline, filters, and gives the result."""

from collections.abc import Sequence

import numpy as np

from beliefnest.errors import InputError
from beliefnest.minds.evidence import Moment
from beliefnest.minds.inference import Inference, reported_credence
from beliefnest.minds.model import MindModel
from beliefnest.minds.tracking import Hypotheses, Tracker, known_after
from beliefnest.nest.inferring.reading import Question, Reading
from beliefnest.nest.past.recording import Recording
from beliefnest.world.paths import BeliefPath, path_text

__all__ = ["credence_in", "infer_in"]

_ROOM = 2**27
"""Bytes that values of one knowledge may take in one chunk of utilities."""

_STEP_TICKS = {"scripted": 1}
_MINECRAFT_STEP = 5


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
    """Infer what an agent wants and believes from what a node holds of its course.

    Raises:
        InputError: The model does not fit the node.
        PathError: There is no such agent.
        TickError: A tick lies in the future or before the start.
    """
    reading = _read(recording, path, model, since, until)
    if not reading.has_seen:
        raise InputError(
            f"{path_text(path)} has not seen {model.agent} from tick {since} to {reading.latest}; "
            "infer from a node and a tick at which it sees the agent"
        )
    step_ticks = model.step_ticks or _STEP_TICKS.get(recording.world, _MINECRAFT_STEP)
    _check_goals(model, reading.moments)
    return _inferred(model, reading.moments, since, reading.latest, step_ticks, ended=ended)


def _read(
    recording: Recording, path: BeliefPath, model: MindModel, since: int, until: int | None
) -> Reading:
    start = recording.moment(path, None)
    first = recording.stretches(start)[0]
    begin = recording.journal.info(first.timeline).start
    question = Question(
        path,
        model.agent,
        dict(model.goal_values),
        model.alternatives,
        model.observer_doubts or isinstance(model.actual, str),
        model.diagonal,
        max(since, begin) if since == 0 else since,
    )
    reading = Reading(recording, question)
    reading.read(until)
    return reading


def _check_goals(model: MindModel, moments: Sequence[Moment]) -> None:
    """Refuse goals of which none can be reached in any alternative."""
    cells = [moment for moment in moments if moment.cell is not None]
    for moment in cells:
        assert moment.cell is not None
        if moment.scene.stage(moment.cell).acts.any():
            return
    raise InputError(
        f"none of the goals {', '.join(model.goals)} can be reached by {model.agent} from "
        f"{cells[0].cell} in any alternative; check their places and the floor that is known"
    )


def _inferred(
    model: MindModel,
    moments: Sequence[Moment],
    since: int,
    until: int,
    step_ticks: int,
    *,
    ended: bool,
) -> Inference:
    trackers = []
    for part in _chunks(model, moments):
        with np.errstate(divide="ignore"):
            prior = np.log(model.prior_weights[part]) - np.log(len(model.rationalities))
        tracker = Tracker(Hypotheses.of(model, step_ticks, part), prior)
        tracker.follow([moment for moment in moments if moment.tick <= until], until)
        trackers.append(tracker.finished(until, ended=ended))

    def rerun(tick: int) -> Inference:
        return _inferred(model, moments, since, tick, step_ticks, ended=False)

    return Inference(model, since, until, trackers, rerun)


def _chunks(model: MindModel, moments: Sequence[Moment]) -> list[slice]:
    """Parts of the utilities whose values fit into memory."""
    first = next(moment for moment in moments if moment.cell is not None)
    assert first.cell is not None
    cells = len(first.scene.stage(first.cell).cells)
    each = cells * len(model.credence_rows) * 8
    size = max(1, _ROOM // each)
    count = len(model.utility_rows)
    return [slice(start, min(start + size, count)) for start in range(0, count, size)]


def credence_in(
    recording: Recording,
    path: BeliefPath,
    model: MindModel,
    since: int,
    tick: int | None,
) -> dict[str, float]:
    """Return the credence of an agent in alternatives, by its percepts alone, without a planner.

    Args:
        recording: Where the node is.
        path: The node that attributes the credence.
        model: Its doubt, its first credence, `actual` and `lapse` count.
        since: The tick just before whose percept the initial credence stands.
        tick: When; None: now.

    Raises:
        InputError, PathError, TickError: As for `infer_in`.
    """
    reading = _read(recording, path, model, since, tick)
    names = model.alternative_names
    weights = model.actual_weights
    agrees = reading.agrees
    shares = [
        float(agrees >> a & 1) if weights is None else weights[name] for a, name in enumerate(names)
    ]
    total = np.zeros(len(names))
    known = known_after(reading.moments, len(names))
    for share, (possible, believed) in zip(shares, known, strict=True):
        total += share * reported_credence(model.credence_rows[0], possible, believed, model.lapse)
    return dict(zip(names, (total / sum(shares)).tolist(), strict=True))
