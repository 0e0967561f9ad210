"""Inference in scenarios: a probe's `infer`, and what is reported of its result."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import msgspec

from beliefnest.errors import InputError, PathError, ScenarioError, TickError

if TYPE_CHECKING:
    from beliefnest.minds.inference import Inference
    from beliefnest.minds.mind_model import MindModel
    from beliefnest.nest.face.shown import ShownSimulator


class Inferring(msgspec.Struct, frozen=True, eq=False):
    """Inference of a probe.

    Attributes:
        model: The hypotheses.
        since: The first tick that counts.
        until: The last tick that counts; None: the end of the script.
        ended: True if the agent acted on the goal at its place after the last tick.
        smooth: True if current credences use later evidence too.
        where: File and line, for messages.
    """

    model: "MindModel"
    since: int
    until: int | None
    ended: bool
    smooth: bool
    where: str

    def inference(self, simulator: "ShownSimulator") -> "Inference":
        """Return what a simulator infers.

        Raises:
            ScenarioError: The inference does not fit the recorded events.
        """
        try:
            return simulator.infer(
                self.model, since=self.since, until=self.until, ended=self.ended, smooth=self.smooth
            )
        except (InputError, PathError, TickError) as error:
            raise ScenarioError(f"{self.where}: {error}") from None


class Inferred(msgspec.Struct, frozen=True):
    """The result of a probe that infers.

    Attributes:
        means: Posterior mean of each factor.
        log_evidence: Natural logarithm of the probability of the course; -inf: impossible.
        impossible: The first step that no hypothesis explains, in words; the means are then those
            before it. None: every step is explained.
    """

    means: Mapping[str, float]
    log_evidence: float
    impossible: str | None = None

    @staticmethod
    def of(inference: "Inference") -> "Inferred":
        """Return the means of an inference."""
        failed = inference.impossible
        return Inferred(
            {factor: inference.mean(factor) for factor in inference.model.factors},
            inference.log_evidence,
            None if failed is None else str(failed),
        )


def means_text(means: Mapping[str, float], factors: Sequence[str] = ()) -> str:
    """Return the means of some factors in words; without names, of all factors."""
    return ", ".join(f"{name} {means[name]:.3g}" for name in factors or means)
