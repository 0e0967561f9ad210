"""Bounds on the time and the memory that filling a template takes."""

import re
import threading
from collections.abc import Callable, Collection, Iterable, Iterator, Set, ValuesView
from typing import Any

from jinja2 import Environment, nodes, pass_context
from jinja2.exceptions import SecurityError
from jinja2.filters import FILTERS
from jinja2.runtime import Context
from jinja2.visitor import NodeTransformer

_TEXT = "count text"
_TURNS = "count turns"
_VALUE = "count value"
"""Filters that `metered` puts into templates; their names cannot be written there."""

_MOST_STEPS = 10_000_000
"""Greatest number of steps of a rendering, such as characters printed and parts of lists."""
_TURN = 10
_CALL = 50
_FILTER = 500
"""Steps of a turn of a loop, of a call, and of a filter that is not one of Jinja's."""
_PART = 3
"""Steps of a part of a list."""
_COPIES = 16
"""Characters that are copied in one step."""
_SQUARES = 1000
"""Letters or parts that are copied in one step where time grows with a square."""
_LARGEST_VALUE = 1_000_000
"""Greatest number of parts of the result of an operator, and greatest width."""
_LARGEST_TEXT = 10_000_000
"""Greatest number of letters and parts of any value."""
_LARGEST_PRODUCT = 100_000_000
"""Greatest product of the size of a value and the size of what a call puts into it."""

_WIDE = frozenset({"batch", "center", "indent", "round", "slice", "tojson"})
"""Jinja's filters that compute as many parts as a number says."""
_TIMES = frozenset({"expandtabs", "indent", "tojson"})
"""Functions that do so for each part of a value."""
_FORMATS = frozenset({"%", "format"})
"""The operator and the filter that put values into a text."""
_WIDTHS = re.compile(r"%(?:\([^)]*\))?[-+ #0]*([\d.]{1,20})")
_SPACES = re.compile(r"[\t\n\v\f\r ]+")
_GIVEN_WIDTHS = re.compile(r"%[^a-zA-Z%]*\*")


class StepMeter(threading.local):
    """Count of the steps of a thread's rendering; its methods raise SecurityError above a bound."""

    steps = 0

    def spend(self, steps: int) -> None:
        """Count steps before they are taken."""
        self.steps += steps
        if self.steps > _MOST_STEPS:
            raise SecurityError(
                f"the template takes more than {_MOST_STEPS:,} steps; shorten its loops, "
                "recursion or texts"
            )

    def value(self, value: Any) -> Any:
        """Return a value after counting its parts."""
        self.spend(_steps(_size(value)))
        return value

    def turns(self, values: Iterable[Any]) -> Iterable[Any]:
        """Return what a loop goes through after counting all its turns."""
        sized = values if isinstance(values, Collection) else tuple(values)
        self.spend(_TURN * len(sized))
        return sized

    def text(self, letters: int) -> str:
        """Return the empty text after counting letters that a template prints as they are."""
        self.spend(letters)
        return ""

    def printed(self, value: object) -> None:
        """Count what is printed."""
        self.spend(sum(_size(value)))

    def call(self, name: str, first: object, arguments: list[Any]) -> None:
        """Count a call of a function, method, filter or operator on a value with arguments."""
        sizes = [_size(each) for each in (first, *arguments)]
        self.spend(_CALL + sum(map(_steps, sizes)))
        own, *others = map(sum, sizes)
        factor = 1 + sum(others)
        widths = 0
        if name == "sum" and any(isinstance(each, list | tuple) for each in arguments):
            self.spend(own * own // _SQUARES)
        if name == "wordwrap" and isinstance(first, str):
            self.spend(sum(len(word) ** 2 for word in _SPACES.split(first)) // _SQUARES)
        if name in _TIMES:
            factor += _numbers(arguments)
        if name in _FORMATS and isinstance(first, str):
            own, widths = 1 + first.count("%"), len(first) + _widths(first)
            factor += _numbers(arguments) if _GIVEN_WIDTHS.search(first) else 0
        if own * factor + widths > _LARGEST_PRODUCT:
            raise _too_large(_LARGEST_PRODUCT)

    def operate(self, operator: str, left: object, right: object) -> None:
        """Count an operation, and refuse one whose result would be too large."""
        _check_growth(operator, left, right)
        if operator == "%" and isinstance(left, str):
            self.call(operator, left, list(right) if isinstance(right, tuple) else [right])
        else:
            self.call(operator, None, [left, right])

    def counters(self) -> dict[str, Callable[..., Any]]:
        """Return the filters that `metered` puts into templates."""

        def counter(count: Callable[[Any], Any]) -> Callable[..., Any]:
            return pass_context(lambda _context, value: count(value))

        return {_TEXT: counter(self.text), _TURNS: counter(self.turns), _VALUE: counter(self.value)}

    def filter(self, name: str, environment: Environment) -> Callable[..., Any]:
        """Return an environment's filter so that it counts its work."""

        @pass_context
        def counted(context: Context, value: Any, /, *args: Any, **options: Any) -> Any:
            if name == "join" and isinstance(value, Iterator):
                value = tuple(value)
            arguments = [*args, *options.values()]
            if name in _WIDE:
                check_numbers(arguments)
            if name not in FILTERS:
                self.spend(_FILTER)
            self.call(name, value, arguments)
            return self.value(
                environment.call_filter(name, value, args, options, context, context.eval_ctx)
            )

        return counted

    def test(self, name: str, environment: Environment) -> Callable[..., Any]:
        """Return an environment's test so that it counts its work."""

        @pass_context
        def counted(context: Context, value: Any, /, *args: Any) -> Any:
            self.call(name, None, [value, *args])
            return environment.call_test(name, value, args, None, context, context.eval_ctx)

        return counted


def check_numbers(values: Iterable[object]) -> None:
    """Raise SecurityError if a number, which may be a width, is too large."""
    for each in values:
        _check_growth("*", "x", each)


def _check_growth(operator: str, left: object, right: object) -> None:
    """Raise SecurityError if a value would be too large: nothing interrupts its computation."""
    sized = [each for each in (left, right) if isinstance(each, str | bytes | list | tuple)]
    numbers = [each for each in (left, right) if isinstance(each, int)]
    match operator:
        case "*" if sized and numbers:
            size = len(sized[0]) * numbers[0]
        case "*" if len(numbers) == 2:
            size = numbers[0].bit_length() + numbers[1].bit_length()
        case "+" if len(sized) == 2:
            size = len(sized[0]) + len(sized[1])
        case "%" if isinstance(left, str):
            size = _widths(left)
        case "**" if len(numbers) == 2:
            size = numbers[0].bit_length() * max(0, numbers[1])
        case _:
            return
    if size > _LARGEST_VALUE:
        raise _too_large(_LARGEST_VALUE)


def _too_large(most: int) -> SecurityError:
    return SecurityError(f"a value would have more than {most:,} parts; shorten it")


def _widths(text: str) -> int:
    """Return the sum of the widths and precisions in a format."""
    return sum(int(n) for each in _WIDTHS.findall(text) for n in each.split(".") if n)


def _numbers(values: Iterable[object]) -> int:
    return sum(abs(each) for each in values if isinstance(each, int))


def _steps(size: tuple[int, int]) -> int:
    parts, letters = size
    return _PART * parts + letters // _COPIES


def _size(value: object) -> tuple[int, int]:
    """Return the number of parts of a value, and of its letters; lists in lists count too."""
    if type(value) is str and len(value) <= _LARGEST_TEXT:
        return 1, len(value)  # the usual case, and fast
    waiting, parts, letters = [value], 1, 0
    while waiting and parts + letters <= _LARGEST_TEXT:
        each = waiting.pop()
        inner: Collection[object] = ()
        if isinstance(each, str | bytes):
            letters += len(each)
        elif isinstance(each, int):
            parts += (each.bit_length() >> 6) ** 2
        elif isinstance(each, range):
            parts += len(each)
        elif isinstance(each, dict):
            inner = [*each.keys(), *each.values()]
        elif isinstance(each, list | tuple | Set | ValuesView):
            inner = each
        parts += len(inner)
        waiting += inner
    if parts + letters > _LARGEST_TEXT:
        raise _too_large(_LARGEST_TEXT)
    return parts, letters


def metered(tree: nodes.Template) -> nodes.Template:
    """Return a template's tree after changing it to count loops, texts, lists and comparisons."""
    _Metered().visit(tree)
    return tree


def _through(name: str, value: nodes.Node) -> nodes.Filter:
    return nodes.Filter(value, name, [], [], None, None, lineno=value.lineno)


class _Metered(NodeTransformer):
    def visit(self, node: nodes.Node, *_args: Any, **_options: Any) -> nodes.Node:
        self.generic_visit(node)
        match node:
            case nodes.For():
                node.iter = _through(_TURNS, node.iter)
            case nodes.Output():
                texts = [each.data for each in node.nodes if isinstance(each, nodes.TemplateData)]
                if texts:
                    letters = nodes.Const(sum(map(len, texts)), lineno=node.lineno)
                    node.nodes.insert(0, _through(_TEXT, letters))
            case nodes.Operand() | nodes.Compare() if not isinstance(node.expr, nodes.Const):
                node.expr = _through(_VALUE, node.expr)
            case nodes.Getitem() if not isinstance(node.arg, nodes.Const | nodes.Slice):
                node.arg = _through(_VALUE, node.arg)  # a key is read to its end
            case nodes.Concat():
                return _through("join", nodes.Tuple(node.nodes, "load", lineno=node.lineno))
            case (
                nodes.List()
                | nodes.Dict()
                | nodes.Tuple(ctx="load")
                | nodes.Getitem(arg=nodes.Slice())
            ):
                return _through(_VALUE, node)
        return node
