"""Models that choose an option without reading the question: baselines of a study."""

import random
import re
from collections.abc import Callable, Mapping, Sequence

import msgspec

from beliefnest.llm.messages import Answer, ChoiceSampling, Message, Sampling

_OPTION = re.compile(r"^([A-Z])\) ", re.MULTILINE)
_NOT_KNOWN = "I do not know"

_Choose = Callable[[Sequence[str], Sampling, str], str]


class OptionModel(msgspec.Struct, frozen=True):
    """Model that names one of the options of a question.

    It answers with the letter of an option in the prompt. If the prompt lists none, because it was
    written by a template of one's own, it answers with one of the options of the request. A
    question without options gets the answer that it does not know.

    Attributes:
        name: Name of the model.
        choose: Function from letters or options, sampling and prompt to one of them.
    """

    name: str
    choose: _Choose

    def answer(self, messages: Sequence[Message], sampling: Sampling) -> Answer:
        """Return an option, in the form that questions ask for."""
        prompt = messages[-1].text if messages else ""
        options = _OPTION.findall(prompt.rpartition("Options:")[2])
        if not options and isinstance(sampling, ChoiceSampling):
            options = list(sampling.options)
        chosen = self.choose(options, sampling, prompt) if options else _NOT_KNOWN
        return Answer(f"Answer: {chosen}\nReason: I did not read the question.")


def _any(options: Sequence[str], sampling: Sampling, prompt: str) -> str:
    return random.Random(f"{sampling.seed} {prompt}").choice(options)


def _first(options: Sequence[str], sampling: Sampling, prompt: str) -> str:
    return options[0]


OPTION_MODELS: Mapping[str, OptionModel] = {
    each.name: each for each in (OptionModel("chance", _any), OptionModel("first-option", _first))
}
"""Models by name: `chance` draws an option from seed and prompt, `first-option` takes the first."""
