"""Prompts: Jinja2 templates over a read-only view of a belief.

Each name is imported on first use, so that commands that only list templates start fast.
"""

import importlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:  # Each name is imported when it is first used.
    from beliefnest.prompts.builtin import BUILT_IN
    from beliefnest.prompts.filterset import FilterSet, PromptFilter, filter
    from beliefnest.prompts.rendering import Renderer, instructions, render
    from beliefnest.prompts.simulator_view import BranchView
    from beliefnest.prompts.templates import Template, built_in_template, load_template

__all__ = [
    "BUILT_IN",
    "BranchView",
    "FilterSet",
    "PromptFilter",
    "Renderer",
    "Template",
    "built_in_template",
    "filter",
    "instructions",
    "load_template",
    "render",
]

_HOMES = ("templates", "filterset", "simulator_view", "builtin", "rendering")
"""Modules of these names, those that are imported fastest first."""


def __getattr__(name: str) -> object:
    if name not in __all__:
        raise AttributeError(f"beliefnest.prompts has no {name!r}; it has {', '.join(__all__)}")
    modules = (importlib.import_module(f"{__name__}.{home}") for home in _HOMES)
    return next(getattr(module, name) for module in modules if hasattr(module, name))
