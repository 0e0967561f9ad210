"""Recording model: asks another model and records requests and answers in the run."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from msgspec.structs import replace

from beliefnest.errors import ModelError
from beliefnest.nest.past.recording import Recording
from beliefnest.timeline.run_records import PromptRecord
from beliefnest.world.paths import BeliefPath

if TYPE_CHECKING:  # Models take long to import, and few nests have one.
    from beliefnest.llm.messages import Answer, Message, Model, Sampling, Usage


class RecordingModel:
    """Model for one conversation, asked from one simulator.

    Each request is recorded with its answer, or with the model's error, as soon as it is there.

    Args:
        model: The model to ask.
        recording: Recording of the nest.
        path: Path of the simulator from which it is asked.
        detail: Further facts to record.
        tick: Tick of the requests; None: the simulator's latest tick.
    """

    def __init__(
        self,
        model: "Model",
        recording: Recording,
        path: BeliefPath,
        detail: Mapping[str, str],
        tick: int | None = None,
    ) -> None:
        self._model = model
        self._recording = recording
        self._path = path
        self._detail = detail
        self._tick = tick
        self._asked = 0

    @property
    def name(self) -> str:
        """The name of the model that is asked."""
        return self._model.name

    def answer(self, messages: "Sequence[Message]", sampling: "Sampling") -> "Answer":
        """Ask the model, and record the request with its answer or error.

        Raises:
            ModelError: The model failed.
            StoreError: The run file cannot be written.
        """
        # Other threads may use the nest while the model computes its answer.
        with self._recording.turn:
            info = self._recording.info(self._path)
        self._asked += 1
        asked = PromptRecord(
            path=self._path,
            timeline=info.key,
            tick=info.head if self._tick is None else self._tick,
            model=self.name,
            attempt=self._asked,
            messages=tuple((message.role, message.text) for message in messages),
            sampling={
                "temperature": sampling.temperature,
                "seed": sampling.seed,
                "max_output_tokens": sampling.max_output_tokens,
            },
            answer=None,
            error=None,
            detail=self._detail,
        )
        try:
            answer = self._model.answer(messages, sampling)
        except ModelError as error:
            spent = _spent(getattr(error, "usage", None))
            self._note(replace(asked, error=str(error), **spent))
            raise
        spent = _spent(answer.usage)
        self._note(replace(asked, answer=answer.text, cached=answer.cached, **spent))
        return answer

    def _note(self, prompt: PromptRecord) -> None:
        with self._recording.turn:
            self._recording.records.add_prompt(prompt)


def _spent(usage: "Usage | None") -> dict[str, Any]:
    return {} if usage is None else asdict(usage)
