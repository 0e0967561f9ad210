"""Prompts: Jinja2 templates over a read-only view of a belief."""

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
