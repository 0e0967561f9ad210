"""Models of the user's own, in a file, a module or an installed package."""

from collections.abc import Sequence
from typing import cast

import msgspec

from beliefnest.errors import BeliefNestError, ModelError
from beliefnest.importing import installed_names, is_importable, is_object_name, made_object
from beliefnest.llm.failures import excerpt
from beliefnest.llm.messages import Answer, Message, Model, Sampling

MODEL_GROUP = "beliefnest.models"
"""Group of entry points, each of which names a class or function that makes a model."""


class OwnModel(msgspec.Struct, frozen=True):
    """Model of the user's own, under the name by which it is found.

    Attributes:
        name: The name as given.
        model: The object, which has a method `answer`.
    """

    name: str
    model: Model

    def answer(self, messages: Sequence[Message], sampling: Sampling) -> Answer:
        """Ask the model.

        Raises:
            ModelError: It raised something, or gave no `Answer`.
        """
        try:
            answer: object = self.model.answer(messages, sampling)
        except BeliefNestError:
            raise
        except (Exception, SystemExit) as error:  # Code of users may raise anything.
            fault = excerpt(f"{type(error).__name__}: {error}")
            raise ModelError(f"{self.name} raised {fault}") from error
        if not isinstance(answer, Answer):
            raise ModelError(
                f"{self.name} gave {type(answer).__name__} and no answer; return "
                "beliefnest.llm.Answer(text)"
            )
        return answer


def installed_models() -> tuple[str, ...]:
    """Return the names of models that installed packages offer."""
    return installed_names(MODEL_GROUP)


def names_own_model(name: str) -> bool:
    """Return True if a name is `FILE.py:NAME`, or `MODULE:NAME` of a module that exists."""
    return is_object_name(name) and is_importable(name.rpartition(":")[0])


def own_model(name: str) -> OwnModel:
    """Return the model of the user's own with a name.

    Args:
        name: `FILE.py:NAME`, `MODULE:NAME` or the name of an entry point. A class, or a function
            that makes a model, is called without arguments.

    Raises:
        InputError: There is no such object, or it makes no model.
    """
    model = made_object(
        name, MODEL_GROUP, "model", "answer", "(messages, sampling), which returns an Answer"
    )
    return OwnModel(name, cast(Model, model))
