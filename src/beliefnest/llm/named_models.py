"""Names of models, in the forms that commands accept."""

from beliefnest.llm.option_models import OPTION_MODELS
from beliefnest.llm.own_models import installed_models
from beliefnest.llm.providers import PROVIDERS


def model_names() -> tuple[str, ...]:
    """Return the forms of names that `resolve_model` accepts."""
    remote = (f"{name}:MODEL" for name in PROVIDERS)
    own = ("MODULE:CLASS", "FILE.py:CLASS", *installed_models())
    return ("offline", *OPTION_MODELS, "replay:FILE", "scripted:FILE", *remote, *own)
