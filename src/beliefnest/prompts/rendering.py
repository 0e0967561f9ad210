"""Rendering of prompts from a template and a simulator."""

import functools
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from types import TracebackType
from typing import Any, NoReturn

import jinja2
import msgspec
from jinja2 import meta, nodes, pass_context
from jinja2.runtime import Context, Macro
from jinja2.sandbox import ImmutableSandboxedEnvironment
from jinja2.utils import missing

from beliefnest.errors import BeliefNestError, TemplateError
from beliefnest.prompts.bounds import StepMeter, check_numbers, metered
from beliefnest.prompts.builtin import BUILT_IN
from beliefnest.prompts.filterset import FilterSet, installed_filters
from beliefnest.prompts.simulator_view import BranchView
from beliefnest.prompts.templates import (
    BUILT_IN_TEMPLATES,
    Template,
    built_in_template,
    load_template,
)
from beliefnest.prompts.text import nearest
from beliefnest.world.texts import quoted, shortened, visible

NO_CODE = "No code was executed"
NO_ERROR = "No error"

LAST_CODE = "$$LAST_CODE$$"
LAST_ERROR = "$$LAST_ERROR$$"


_MARKERS = {LAST_CODE: "{{ last_code }}", LAST_ERROR: "{{ last_error }}"}
_OPTIONAL = ("defined", "undefined", "default", "d")
"""Tests and filters that a variable without a value passes."""
_MOST_TEMPLATES = 64
"""Greatest number of compiled templates that a renderer keeps."""

_PLAIN_TYPES = (str, bytes, int, float, list, tuple, dict, set, frozenset)


def render(
    template: Template | Path | str,
    branch: BranchView,
    variables: Mapping[str, Any],
    filters: FilterSet | None = None,
) -> str:
    """Return the text of a prompt.

    A `Renderer` is faster if you render a template often, because it compiles it only once.

    Args:
        template: A template, the path of a template file, or Jinja2 source.
        branch: The simulator for the template's variable `branch`.
        variables: The template's other variables. `last_code` and `last_error` are the values of
            `$$LAST_CODE$$` and `$$LAST_ERROR$$`. If they are absent or None, these print `No
            code was executed` and `No error`.
        filters: Filters by name; None for the built-in and the installed ones.

    Raises:
        TemplateError: The template cannot be read or parsed, names an unknown filter or
            variable, or a filter failed; the message names the line.
        InputError: An installed filter cannot be used.
    """
    return Renderer(filters).render(template, branch, variables)


@functools.lru_cache(maxsize=_MOST_TEMPLATES)
def check_variables(template: Template, names_with_values: tuple[str, ...]) -> None:
    """Refuse a variable of a template that has no value, without rendering it.

    A variable that the template sets, or tests for being defined, may be missing. Variables are not
    checked if a filter is none of the built-in and installed ones: a nest may be given it.

    Args:
        template: The template.
        names_with_values: Names of variables, apart from those that `render` always sets.

    Raises:
        TemplateError: The template cannot be parsed, or a variable has no value.
    """
    environment = _ReadingEnvironment(_default_filters())
    try:
        tree = environment.parse(_with_markers(template.text))
        missing = meta.find_undeclared_variables(tree)
    except jinja2.TemplateAssertionError:
        return
    except jinja2.TemplateSyntaxError as error:
        raise TemplateError(f"{template.name}, line {error.lineno}: {error.message}") from None
    defined = {*names_with_values, "branch", "last_code", "last_error"}
    names = list(tree.find_all(nodes.Name))
    set_inside = {name.name for name in names if name.ctx != "load"}
    tests = [each for each in tree.find_all((nodes.Test, nodes.Filter)) if each.name in _OPTIONAL]
    optional = {each.node.name for each in tests if isinstance(each.node, nodes.Name)}
    missing -= {*defined, *set_inside, *optional, *environment.globals}
    for name in names:
        if name.name in missing:
            _refuse(template.name, name.lineno, "variable", name.name, defined)


@functools.cache
def instructions(skills: tuple[object, ...]) -> str:
    """Return the text of the built-in template `instructions`, which needs no simulator.

    Args:
        skills: Skills that a program can call, each with a `signature` and a `description`.
    """
    compiled = _compiled(_ReadingEnvironment(BUILT_IN), built_in_template("instructions"))
    return compiled.template.render(skills=skills)


class _Compiled(msgspec.Struct, frozen=True):
    """A parsed, checked and compiled template.

    Attributes:
        name: Name in messages.
        filename: File name in tracebacks.
        tree: Syntax tree.
        template: Compiled code.
    """

    name: str
    filename: str
    tree: nodes.Template
    template: jinja2.Template


class Renderer:
    """Renderer that compiles each template only once; several nests may use it in turn.

    Args:
        filters: Filters by name; None for the built-in and the installed ones.
    """

    def __init__(self, filters: FilterSet | None = None) -> None:
        self._filters = filters
        self._compiled: dict[Template, _Compiled] = {}

    def render(
        self, template: Template | Path | str, branch: BranchView, variables: Mapping[str, Any]
    ) -> str:
        """Return the text of a prompt; arguments and errors as of the function `render`."""
        compiled = self._ready(_as_template(template))
        values = {
            **variables,
            "branch": branch,
            "last_code": _or_word(variables.get("last_code"), NO_CODE),
            "last_error": _or_word(variables.get("last_error"), NO_ERROR),
        }
        self._environment.meter.steps = 0
        try:
            return compiled.template.render(values)
        except Exception as error:
            line = _line_of(error, compiled.filename)
            defined = {*values, *self._environment.globals}
            said = _words(error)
            hint = _unknown_variable(compiled.tree, line, defined, said)
            raise TemplateError(f"{compiled.name}, line {line}: {said}{hint}") from error

    @functools.cached_property
    def _environment(self) -> "_ReadingEnvironment":
        return _ReadingEnvironment(_default_filters() if self._filters is None else self._filters)

    def _ready(self, source: Template) -> _Compiled:
        compiled = self._compiled.get(source)
        if compiled is None:
            compiled = _compiled(self._environment, source)
            if len(self._compiled) >= _MOST_TEMPLATES:
                del self._compiled[next(iter(self._compiled))]
            self._compiled[source] = compiled
        return compiled


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
    """Replace the paper's two markers by variables, so that their values are never parsed."""
    for marker, expression in _MARKERS.items():
        text = text.replace(marker, expression)
    return text


class _Missing(jinja2.StrictUndefined):
    """Value that is missing. Its message shows objects of this package, not their classes."""

    @property
    def _undefined_message(self) -> str:
        owner = self._undefined_obj
        if owner is missing or self._undefined_hint or isinstance(owner, _PLAIN_TYPES):
            return super()._undefined_message
        return f"{shortened(repr(owner))} has no {quoted(self._undefined_name)}"


class _ReadingEnvironment(ImmutableSandboxedEnvironment):
    """Sandbox in which a template can read simulators but not act through them."""

    intercepted_binops = frozenset({"*", "+", "-", "/", "//", "%", "**"})

    def __init__(self, filters: FilterSet) -> None:
        super().__init__(
            undefined=_Missing,
            autoescape=False,  # a prompt is plain text, not HTML
            keep_trailing_newline=True,
            loader=jinja2.FunctionLoader(_built_in_source),
        )
        self.filters.update({name: each.function for name, each in filters.filters.items()})
        self.meter = meter = StepMeter()
        plain = self.overlay()  # keeps the functions that do not count
        self.filters = {name: meter.filter(name, plain) for name in plain.filters}
        self.filters |= meter.counters()
        self.tests = {name: meter.test(name, plain) for name in plain.tests}
        del self.globals["lipsum"]  # a prompt has no chance in it, and no text without end

        @pass_context
        def printed(_context: Context, value: object) -> object:
            meter.printed(value)
            return _printed(value)

        self.finalize = printed

    def _generate(self, source: nodes.Template, *args: Any, **options: Any) -> str:
        tree = metered(source)
        tree.set_environment(self)
        return super()._generate(tree, *args, **options)

    def call_binop(self, context: Context, operator: str, left: Any, right: Any) -> Any:
        """Compute a value of limited size."""
        self.meter.operate(operator, left, right)
        return self.meter.value(super().call_binop(context, operator, left, right))

    def call(self, context: Context, obj: Any, /, *args: Any, **options: Any) -> Any:
        """Call a function with numbers of limited size, which may be widths."""
        args = tuple(tuple(each) if isinstance(each, Iterator) else each for each in args)
        arguments = [*args, *options.values()]
        check_numbers(arguments)
        bound_to = getattr(obj, "__self__", None)
        receiver = None if isinstance(bound_to, dict) else bound_to  # its methods do not walk it
        self.meter.call(getattr(obj, "__name__", ""), receiver, arguments)
        return self.meter.value(super().call(context, obj, *args, **options))

    def is_safe_callable(self, obj: object) -> bool:
        """Allow only macros, Jinja's own globals and methods of plain values."""
        if not super().is_safe_callable(obj):
            return False
        bound_to = getattr(obj, "__self__", None)
        return (
            isinstance(obj, Macro)
            or any(obj is function for function in self.globals.values())
            or (bound_to is not None and isinstance(bound_to, _PLAIN_TYPES))
        )


def _printed(value: object) -> object:
    """Return a value for `{{ }}`: lines stay, control characters are escaped."""
    if not isinstance(value, str) or (value.isascii() and value.isprintable()):
        return value
    return visible(value)


def _built_in_source(name: str) -> str | None:
    """Return the source for `{% include "instructions" %}`."""
    if name not in BUILT_IN_TEMPLATES:
        return None
    return _with_markers(built_in_template(name).text)


def _parse(environment: jinja2.Environment, name: str, text: str) -> nodes.Template:
    try:
        tree = environment.parse(text)
    except jinja2.TemplateSyntaxError as error:
        raise TemplateError(f"{name}, line {error.lineno}: {error.message}") from None
    except RecursionError:
        raise TemplateError(f"{name} is nested too deeply") from None
    for used in tree.find_all(nodes.Filter):
        if used.name not in environment.filters:
            filters = filter(str.isidentifier, environment.filters)
            _refuse(name, used.lineno, "filter", used.name, filters)
    for test in tree.find_all(nodes.Test):
        if test.name not in environment.tests:
            _refuse(name, test.lineno, "test", test.name, environment.tests)
    return tree


def _refuse(template: str, line: int, kind: str, name: str, names: Iterable[str]) -> NoReturn:
    raise TemplateError(
        f"{template}, line {line}: there is no {kind} {quoted(name)}{nearest(name, names)}"
    )


def _line_of(error: BaseException, filename: str) -> int:
    """Return the line of the template that was rendered when an error was raised."""
    line = 1
    trace: TracebackType | None = error.__traceback__
    while trace is not None:
        if trace.tb_frame.f_code.co_filename == filename:
            line = trace.tb_lineno
        trace = trace.tb_next
    return line


def _unknown_variable(tree: nodes.Template, line: int, defined: set[str], said: str) -> str:
    """Return the end of a message about an unknown variable of a line: names similar to it."""
    missing = meta.find_undeclared_variables(tree) - defined
    here = {name.name for name in tree.find_all(nodes.Name) if name.lineno == line} & missing
    variables = sorted(defined - set(jinja2.defaults.DEFAULT_NAMESPACE))
    # Jinja tells of the first, and only in words.
    first = next((name for name in sorted(here) if repr(name) in said), None)
    return "" if first is None else nearest(first, variables)


def _words(error: Exception) -> str:
    """Return an error's message; add the type unless the message is written for users."""
    if isinstance(error, jinja2.TemplateNotFound):
        names = ", ".join(BUILT_IN_TEMPLATES)
        return f"no template {quoted(error.name)} to include; there are only the built-in {names}"
    if isinstance(error, jinja2.TemplateError):
        return error.message or type(error).__name__
    if isinstance(error, BeliefNestError):
        return str(error)
    if isinstance(error, RecursionError):
        return "a macro or value is nested too deeply"
    return f"a filter or expression failed: {type(error).__name__}: {error}"
