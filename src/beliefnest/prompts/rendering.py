"""From a template and a simulator to the text of a prompt."""

import functools
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any, NoReturn

import jinja2
from jinja2 import meta, nodes
from jinja2.runtime import Macro
from jinja2.sandbox import ImmutableSandboxedEnvironment

from beliefnest.errors import BeliefNestError, TemplateError
from beliefnest.prompts.builtin import BUILT_IN
from beliefnest.prompts.filterset import FilterSet, installed_filters
from beliefnest.prompts.templates import (
    BUILT_IN_TEMPLATES,
    Template,
    built_in_template,
    load_template,
)
from beliefnest.prompts.text import nearest
from beliefnest.prompts.view import BranchView
from beliefnest.world.texts import visible

__all__ = ["LAST_CODE", "LAST_ERROR", "NO_CODE", "NO_ERROR", "Renderer", "instructions", "render"]

NO_CODE = "No code was executed"
NO_ERROR = "No error"

LAST_CODE = "$$LAST_CODE$$"
LAST_ERROR = "$$LAST_ERROR$$"

"""What programs and errors of several lines are set with."""

_MARKERS = {LAST_CODE: "{{ last_code }}", LAST_ERROR: "{{ last_error }}"}
_MOST_TEMPLATES = 64
"""That are kept compiled."""

_PLAIN_TYPES = (str, bytes, int, float, list, tuple, dict, set, frozenset)


def render(
    template: Template | Path | str,
    branch: BranchView,
    variables: Mapping[str, Any],
    filters: FilterSet | None = None,
) -> str:
    """Return the text of a prompt; `Renderer` compiles a template once that is rendered often.

    Args:
        template: A template, the path of a file that holds one, or Jinja2 source.
        branch: The simulator that the template's `branch` stands for.
        variables: The template's other variables. `last_code` and `last_error` are what
            `$$LAST_CODE$$` and `$$LAST_ERROR$$` stand for; absent or None they print
            as `No code was executed` and `No error`.
        filters: Filters by name; None: the built-in and the installed ones.

    Raises:
        TemplateError: The template cannot be read or parsed, names a filter or a variable
            that does not exist, or a filter failed; the message names the line.
        InputError: An installed filter cannot be used.
    """
    return Renderer(filters).render(template, branch, variables)


@functools.cache
def instructions(skills: tuple[object, ...]) -> str:
    """Return the text of the built-in template `instructions`, which is about no simulator.

    Args:
        skills: What a program can call, each with its `signature` and `description`.
    """
    compiled = _compiled(_environment(BUILT_IN), built_in_template("instructions"))
    return compiled.template.render(skills=skills)


@dataclass(frozen=True, slots=True)
class _Compiled:
    """A template that was parsed and checked, ready to be filled.

    Attributes:
        name: What messages call it.
        filename: What traces call it.
        tree: Its syntax.
        template: Its code.
    """

    name: str
    filename: str
    tree: nodes.Template
    template: jinja2.Template


class Renderer:
    """Fills templates, compiling each but once; it may serve one nest after the other.

    Args:
        filters: Filters by name; None: the built-in and the installed ones.
    """

    def __init__(self, filters: FilterSet | None = None) -> None:
        self._filters = filters
        self._compiled: dict[Template, _Compiled] = {}

    def render(
        self, template: Template | Path | str, branch: BranchView, variables: Mapping[str, Any]
    ) -> str:
        """Return the text of a prompt; arguments and errors are those of the function `render`."""
        compiled = self._ready(_as_template(template))
        values = {
            **variables,
            "branch": branch,
            "last_code": _or_word(variables.get("last_code"), NO_CODE),
            "last_error": _or_word(variables.get("last_error"), NO_ERROR),
        }
        try:
            return compiled.template.render(values)
        except Exception as error:
            line = _line_of(error, compiled.filename)
            known = {*values, *self._environment.globals}
            hint = _unknown_variables(compiled.tree, line, known)
            raise TemplateError(f"{compiled.name}, line {line}: {_words(error)}{hint}") from error

    @functools.cached_property
    def _environment(self) -> jinja2.Environment:
        return _environment(_default_filters() if self._filters is None else self._filters)

    def _ready(self, source: Template) -> _Compiled:
        known = self._compiled.get(source)
        if known is None:
            known = _compiled(self._environment, source)
            if len(self._compiled) >= _MOST_TEMPLATES:
                del self._compiled[next(iter(self._compiled))]
            self._compiled[source] = known
        return known


def _compiled(environment: jinja2.Environment, source: Template) -> _Compiled:
    text = _with_markers(source.text)
    tree = _parse(environment, source.name, text)
    filename = f"<template {source.name}>"
    try:
        code = environment.compile(text, name=source.name, filename=filename)
    except Exception as error:
        line = _line_of(error, filename)
        raise TemplateError(f"{source.name}, line {line}: {_words(error)}") from error
    template = jinja2.Template.from_code(environment, code, environment.globals)
    return _Compiled(source.name, filename, tree, template)


@functools.cache
def _default_filters() -> FilterSet:
    return installed_filters(BUILT_IN)


def _as_template(template: Template | Path | str) -> Template:
    match template:
        case Template():
            return template
        case Path():
            return load_template(template)
        case _:
            return Template("template", template)


def _or_word(value: object, word: str) -> object:
    return word if value is None else value


def _with_markers(text: str) -> str:
    """Return the paper's two markers as variables, so that what they stand for is never parsed."""
    for marker, expression in _MARKERS.items():
        text = text.replace(marker, expression)
    return text


class _ReadingEnvironment(ImmutableSandboxedEnvironment):
    """A sandbox in which a template reads simulators and cannot act through them."""

    def is_safe_callable(self, obj: object) -> bool:
        """Only macros, Jinja's own globals, and methods of plain values may be called."""
        if not super().is_safe_callable(obj):
            return False
        bound_to = getattr(obj, "__self__", None)
        return (
            isinstance(obj, Macro)
            or any(obj is known for known in self.globals.values())
            or (bound_to is not None and isinstance(bound_to, _PLAIN_TYPES))
        )


def _printed(value: object) -> object:
    """What `{{ }}` prints, whoever wrote it: lines stay, what controls text is written out."""
    if not isinstance(value, str) or (value.isascii() and value.isprintable()):
        return value
    return visible(value)


def _environment(filters: FilterSet) -> jinja2.Environment:
    environment = _ReadingEnvironment(
        undefined=jinja2.StrictUndefined,
        autoescape=False,  # a prompt is plain text, not HTML
        finalize=_printed,
        keep_trailing_newline=True,
        loader=jinja2.FunctionLoader(_built_in_source),
    )
    environment.filters.update({name: each.function for name, each in filters.filters.items()})
    return environment


def _built_in_source(name: str) -> str | None:
    """Source for `{% include "instructions" %}`."""
    if name not in BUILT_IN_TEMPLATES:
        return None
    return _with_markers(built_in_template(name).text)


def _parse(environment: jinja2.Environment, name: str, text: str) -> nodes.Template:
    try:
        tree = environment.parse(text)
    except jinja2.TemplateSyntaxError as error:
        raise TemplateError(f"{name}, line {error.lineno}: {error.message}") from None
    for used in tree.find_all(nodes.Filter):
        if used.name not in environment.filters:
            _refuse(name, used.lineno, "filter", used.name, environment.filters)
    for test in tree.find_all(nodes.Test):
        if test.name not in environment.tests:
            _refuse(name, test.lineno, "test", test.name, environment.tests)
    return tree


def _refuse(template: str, line: int, kind: str, name: str, known: Iterable[str]) -> NoReturn:
    raise TemplateError(
        f"{template}, line {line}: there is no {kind} {name!r}{nearest(name, known)}"
    )


def _line_of(error: BaseException, filename: str) -> int:
    """Line of the template that was being rendered when an error was raised."""
    line = 1
    trace: TracebackType | None = error.__traceback__
    while trace is not None:
        if trace.tb_frame.f_code.co_filename == filename:
            line = trace.tb_lineno
        trace = trace.tb_next
    return line


def _unknown_variables(tree: nodes.Template, line: int, known: set[str]) -> str:
    """What comes near the unknown variables of a line, for the end of a message."""
    missing = meta.find_undeclared_variables(tree) - known
    here = {name.name for name in tree.find_all(nodes.Name) if name.lineno == line} & missing
    variables = sorted(known - set(jinja2.defaults.DEFAULT_NAMESPACE))
    return "".join(nearest(name, variables) for name in sorted(here))


def _words(error: Exception) -> str:
    """Return the message of an error, with its kind unless the message was written to be read."""
    if isinstance(error, jinja2.TemplateError):
        return error.message or type(error).__name__
    if isinstance(error, BeliefNestError):
        return str(error)
    return f"a filter or expression failed: {type(error).__name__}: {error}"
