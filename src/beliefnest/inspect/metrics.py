"""Metrics of all tasks: accuracies with errors that are clustered by independent samples.

Samples about one scene are not independent. Each sample names its scene in its metadata, under
`cluster`: the variation of a scenario, the story, the film, the instance of a task.
"""

import math
from collections.abc import Sequence

import numpy as np
from inspect_ai.scorer import (
    Metric,
    SampleScore,
    Value,
    accuracy,
    grouped,
    metric,
    value_to_float,
)

from beliefnest.scenarios.judging import NOT_ANSWERED
from beliefnest.studies.clusters import rate_interval
from beliefnest.suites.films.film import JudgedPart

CLUSTER = "cluster"
"""Key of a sample's metadata with the name of its scene."""


def metrics_by(key: str) -> list[Metric | dict[str, list[Metric]]]:
    """Return the metrics of right answers, and accuracy grouped by a key of the samples."""
    by_group = grouped(accuracy(), key, all=False)
    return [accuracy(), stderr_of_scenes(), interval(), chance(), not_answered(), by_group]


def _clusters(scores: Sequence[SampleScore]) -> list[list[float]]:
    """Return the values of scores by scene."""
    to_float = value_to_float()
    scores_of_scene: dict[object, list[float]] = {}
    for each in scores:
        scene = (each.sample_metadata or {}).get(CLUSTER, each.sample_id)
        scores_of_scene.setdefault(scene, []).append(to_float(each.score.value))
    return list(scores_of_scene.values())


@metric
def interval() -> Metric:
    """Compute the 95 % interval of the accuracy, clustered by scene, as studies do."""

    # Inspect reads the annotation, and passes scores with the metadata of samples.
    def value(scores: list[SampleScore]) -> Value:
        clusters = _clusters(scores)
        if not clusters:
            return {"low": math.nan, "high": math.nan}
        low, high, _ = rate_interval(clusters)
        return {"low": low, "high": high}

    return value


@metric
def chance() -> Metric:
    """Compute the accuracy of blind guesses; nan if some sample is no choice of options."""

    def value(scores: list[SampleScore]) -> float:
        levels = [(each.sample_metadata or {}).get("chance") for each in scores]
        chances = [each for each in levels if each is not None]
        return float(np.mean(chances)) if chances and len(chances) == len(levels) else math.nan

    return value


@metric(scores="unreduced")
def not_answered() -> Metric:
    """Count the answers of each outcome without an answer, over all epochs of all samples."""

    def value(scores: list[SampleScore]) -> Value:
        outcomes = [(each.score.metadata or {}).get("outcome") for each in scores]
        return {name: outcomes.count(name) for name in NOT_ANSWERED}

    return value


@metric(name="mean", scores="unreduced")
def mean_of_epochs() -> Metric:
    """Compute the mean over all epochs of all samples."""

    def value(scores: list[SampleScore]) -> float:
        values = [one for cluster in _clusters(scores) for one in cluster]
        return float(np.mean(values)) if values else math.nan

    return value


def _error(scores: list[SampleScore]) -> float:
    """Return the standard error of the mean, clustered by scene; nan with fewer than two."""
    clusters = _clusters(scores)
    if len(clusters) < 2:
        return math.nan
    middle = np.mean([one for cluster in clusters for one in cluster])
    squares = sum(float(sum(one - middle for one in cluster)) ** 2 for cluster in clusters)
    count = sum(map(len, clusters))
    return math.sqrt(squares * len(clusters) / (len(clusters) - 1)) / count


@metric(name="stderr")
def stderr_of_scenes() -> Metric:
    """Compute the standard error of the accuracy. Inspect's own one is 0 with a single scene."""

    # Inspect marks the function, and so needs one for each metric.
    def value(scores: list[SampleScore]) -> float:
        return _error(scores)

    return value


@metric(name="stderr", scores="unreduced")
def stderr_of_epochs() -> Metric:
    """Compute the standard error of the mean over all epochs of all samples."""

    # Inspect marks the function, and so needs one for each metric.
    def value(scores: list[SampleScore]) -> float:
        return _error(scores)

    return value


@metric(scores="unreduced")
def rated() -> Metric:
    """Compute the share of answers with all ratings; correlations are over these."""

    def value(scores: list[SampleScore]) -> float:
        is_rated = [(each.score.metadata or {}).get("outcome") == "rated" for each in scores]
        return float(np.mean(is_rated)) if is_rated else math.nan

    return value


def _correlation(scores: Sequence[SampleScore], about: JudgedPart) -> float:
    """Return Pearson's coefficient over all epochs of all samples; nan if a side is constant."""
    metadata = [each.score.metadata or {} for each in scores]
    pairs = np.array([pair for each in metadata for pair in each.get(about, [])]).reshape(-1, 2)
    if len(pairs) < 3 or (np.ptp(pairs, axis=0) < 1e-12).any():
        return math.nan
    return float(np.corrcoef(pairs[:, 0], pairs[:, 1])[0, 1])


@metric(scores="unreduced")
def desires_r() -> Metric:
    """Correlate rated with inferred desires, over all epochs of all samples."""

    def value(scores: list[SampleScore]) -> float:
        return _correlation(scores, "desires")

    return value


@metric(scores="unreduced")
def beliefs_r() -> Metric:
    """Correlate rated with inferred initial beliefs, over all epochs of all samples."""

    def value(scores: list[SampleScore]) -> float:
        return _correlation(scores, "beliefs")

    return value
