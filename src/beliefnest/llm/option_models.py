"""Models that choose an option without reading the question: baselines of a study."""

import random
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from beliefnest.llm.messages import Answer, Message, Sampling

_OPTION = re.compile(r"^([A-Z])\) ", re.MULTILINE)
_NOT_KNOWN = "I do not know"

_Choose = Callable[[Sequence[str], Sampling, str], str]


@dataclass(frozen=True)
class OptionModel:
    """Model that names one of the options of a question.

    A question without options gets the answer that it does not know.

    Attributes:
        name: Name of the model.
        choose: Function from letters of options, sampling and prompt to one of the letters.
    """

    name: str
    choose: _Choose

    def answer(self, messages: Sequence[Message], sampling: Sampling) -> Answer:
        """Return the letter of an option, in the form that questions ask for."""
        prompt = messages[-1].text if messages else ""
        letters = _OPTION.findall(prompt.rpartition("Options:")[2])
        chosen = self.choose(letters, sampling, prompt) if letters else _NOT_KNOWN
        return Answer(f"Answer: {chosen}\nReason: I did not read the question.")


def _any(letters: Sequence[str], sampling: Sampling, prompt: str) -> str:
    return random.Random(f"{sampling.seed} {prompt}").choice(letters)


def _first(letters: Sequence[str], sampling: Sampling, prompt: str) -> str:
    return letters[0]


OPTION_MODELS: Mapping[str, OptionModel] = {
    each.name: each for each in (OptionModel("chance", _any), OptionModel("first-option", _first))
}
"""Models by name: `chance` draws an option from seed and prompt, `first-option` takes the first."""
