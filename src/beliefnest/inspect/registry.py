"""Tasks of Inspect AI, as programs import them."""

from beliefnest.adapters.inspect_ai.registry import *  # noqa: F403  # the names are listed there
from beliefnest.adapters.inspect_ai.registry import __all__  # noqa: F401  # star imports leave it out
