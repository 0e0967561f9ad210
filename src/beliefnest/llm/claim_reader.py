"""Model-based reader that extracts claims from utterances."""

import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import msgspec

from beliefnest.errors import BeliefNestError
from beliefnest.files import decode_json
from beliefnest.llm.failures import UnusableAnswerError, excerpt
from beliefnest.llm.messages import Answer, Message, Model, Sampling, WrappedModel

if TYPE_CHECKING:  # Claims check blocks and items with NumPy; most who import models read none.
    from beliefnest.world.claims import Claim
    from beliefnest.world.nameable import Nameable
    from beliefnest.world.values import Position

_FENCED = re.compile(r"\s*```(?:json)?[ \t]*\n(.*)\n[ \t]*```\s*", re.DOTALL)
_MOST = 8
"""Greatest number of claims in one utterance. An answer with more is not a sensible reading."""

_SYSTEM = """\
You read what somebody in a block world has said, and list what it states as fact about the world.

Answer with one JSON object and nothing else: {"claims": [...]}. Each claim is one of
{"kind": "located", "item": NAME, "place": [x, y, z]}: that item is in the container there
{"kind": "absent", "item": NAME, "place": [x, y, z]}: that item is not in the container there
{"kind": "position", "agent": NAME, "place": [x, y, z]}: that agent is there
{"kind": "block", "state": "NAME[PROPERTY=VALUE]", "place": [x, y, z]}: the block there is so

Take names and positions from the lists. Whether it is true does not matter. Questions, wishes, \
orders, plans, guesses and what others are said to think are no claims. Where it is not clear what \
is meant, claim nothing. If nothing is claimed, answer {"claims": []}.\
"""


class _Found(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    claims: list[dict[str, Any]]


def _as_it_is(model: Model) -> Model:
    return model


@dataclass(frozen=True, slots=True)
class ClaimsFromModel:
    """Reader that asks a model which claims a text makes; see `claims_from_model`.

    Attributes:
        model: Model to ask.
        sampling: Sampling parameters.
        wrap: Wrapper applied to the model for each text; the model it receives already refuses
            invalid answers.
    """

    model: Model
    sampling: Sampling = field(default_factory=Sampling)
    wrap: Callable[[Model], Model] = _as_it_is

    @property
    def name(self) -> str:
        """Name of the model."""
        return self.model.name

    def through(self, wrap: Callable[[Model], Model]) -> "ClaimsFromModel":
        """Return a copy that asks through the given wrapper."""
        return replace(self, wrap=wrap)

    def __call__(self, text: str, speaker: str, nameable: "Nameable") -> "tuple[Claim, ...]":
        """Return the claims of a text.

        Raises:
            ModelError: The model failed, or its answer is not a list of claims about this world.
        """
        model = self.wrap(_Strict(self.model, nameable))
        question = (Message("system", _SYSTEM), Message("user", _question(text, speaker, nameable)))
        return _claims_in(model.answer(question, self.sampling).text, nameable)


def claims_from_model(model: Model, sampling: Sampling | None = None) -> ClaimsFromModel:
    """Return a reader for `Nest(..., claims_from=...)` that asks a model.

    The run records the requests and answers (`nest.prompts()`). If the model fails or gives an
    invalid answer, the run records the error and the text has no claims.

    Args:
        model: Model with limits and cache, as of `open_model`.
        sampling: Sampling parameters; None asks for the likeliest answer.
    """
    return ClaimsFromModel(model, sampling or Sampling())


class _Strict(WrappedModel, frozen=True):
    """Model wrapper that raises if an answer is not a list of claims about this world."""

    nameable: "Nameable"

    def answer(self, messages: Sequence[Message], sampling: Sampling) -> Answer:
        answer = self.model.answer(messages, sampling)
        try:
            _claims_in(answer.text, self.nameable)
        except (BeliefNestError, msgspec.MsgspecError) as fault:
            raise UnusableAnswerError(
                f"{self.name} gave no claims: {fault}; it answered: {excerpt(answer.text)}",
                answer.usage,
            ) from fault
        return answer


def _claims_in(text: str, nameable: "Nameable") -> "tuple[Claim, ...]":
    from beliefnest.world.claims import claims_from_plain

    fenced = _FENCED.fullmatch(text)
    entries = decode_json(text if fenced is None else fenced[1], _Found)
    if len(entries.claims) > _MOST:
        raise msgspec.ValidationError(f"{len(entries.claims)} claims are more than {_MOST}")
    claims = claims_from_plain(entries.claims)
    for claim in claims:
        claim.check(nameable.box, nameable.agents)
    return tuple(dict.fromkeys(claims))


def _question(text: str, speaker: str, nameable: "Nameable") -> str:
    def listed(lines: Iterable[str]) -> str:
        return "\n".join(lines) or "none"

    def item(name: str) -> str:
        called = nameable.called.get(name, name)
        return name if called == name else f"{name} (called {called})"

    def at(place: "Position") -> str:
        return f"[{', '.join(map(str, place))}]"

    parts = {
        "Agents": ", ".join(nameable.agents),
        "Items": ", ".join(item(name) for name in nameable.items) or "none",
        "Containers": listed(f"{at(p)}: {name}" for p, name in nameable.containers.items()),
        "Doors and switches": listed(f"{at(p)}: {block}" for p, block in nameable.doors.items()),
        "Places": listed(f"{at(p)}: {name}" for name, p in nameable.places.items()),
        "Coordinates": f"from {at(nameable.box.low)} to {at(nameable.box.high)}",
    }
    lists = "\n\n".join(f"{title}:\n{body}" for title, body in parts.items())
    # Quote the utterance as JSON, so that it cannot imitate a part of the question.
    said = msgspec.json.encode(text).decode()
    return f"{lists}\n\n{speaker} said:\n{said}"
