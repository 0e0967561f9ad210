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

_HOMES = {
    "BUILT_IN": "builtin",
    "BranchView": "simulator_view",
    "FilterSet": "filterset",
    "PromptFilter": "filterset",
    "Renderer": "rendering",
    "Template": "templates",
    "built_in_template": "templates",
    "filter": "filterset",
    "instructions": "rendering",
    "load_template": "templates",
    "render": "rendering",
}


def __getattr__(name: str) -> object:
    if name not in _HOMES:
        raise AttributeError(f"beliefnest.prompts has no {name!r}; it has {', '.join(__all__)}")
    return getattr(importlib.import_module(f"beliefnest.prompts.{_HOMES[name]}"), name)
