"""Small expressions over named values, such as `gap + 1` or `spot[0] != other[0]`.

Expressions are a safe subset of Python for numbers, texts and lists: no attributes, and no calls
except `abs`, `len`, `max`, `min` and `round`. Untrusted files can therefore be read.
"""

import ast
import functools
import operator
from collections.abc import Callable, Mapping

from beliefnest.errors import InputError
from beliefnest.world.texts import quoted
from beliefnest.world.words import nearest_or_all

_LONGEST = 300
_BINARY: Mapping[type[ast.operator], Callable[..., object]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv,
    ast.Mod: operator.mod,
}
_UNARY: Mapping[type[ast.unaryop], Callable[..., object]] = {
    ast.USub: operator.neg,
    ast.UAdd: operator.pos,
    ast.Not: operator.not_,
}
_COMPARE: Mapping[type[ast.cmpop], Callable[..., object]] = {
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.In: lambda one, other: operator.contains(other, one),
    ast.NotIn: lambda one, other: not operator.contains(other, one),
}
_CALLS: Mapping[str, Callable[..., object]] = {
    "abs": abs,
    "len": len,
    "max": max,
    "min": min,
    "round": round,
}


def names_in(text: str) -> frozenset[str]:
    """Return the names of the values in an expression.

    Raises:
        InputError: The text is no expression.
    """
    nodes = ast.walk(_parsed(text))
    return frozenset(node.id for node in nodes if isinstance(node, ast.Name)) - _CALLS.keys()


def evaluate(text: str, values: Mapping[str, object]) -> object:
    """Evaluate an expression.

    Args:
        text: The expression.
        values: Values by name.

    Raises:
        InputError: The text is no expression, names an unknown value, or cannot be computed.
    """
    body = _parsed(text)
    try:
        return _value(body, values, text)
    except (TypeError, ArithmeticError, LookupError, ValueError) as error:
        raise InputError(f"{quoted(text)} cannot be computed: {error}") from None


@functools.lru_cache(maxsize=1024)
def _parsed(text: str) -> ast.expr:
    if len(text) > _LONGEST:
        raise InputError(f"an expression of {len(text)} characters is too long")
    try:
        return ast.parse(text.strip(), mode="eval").body
    except (SyntaxError, ValueError, RecursionError):
        raise InputError(f"{quoted(text)} is no expression") from None


# One return for each allowed kind of node.
def _value(  # noqa: PLR0911
    node: ast.expr, values: Mapping[str, object], text: str
) -> object:
    def inner(part: ast.expr) -> object:
        return _value(part, values, text)

    match node:
        case ast.Constant(value=bool() | int() | float() | str() | None as value):
            return value
        case ast.Name(id=name):
            if name not in values:
                hint = nearest_or_all(name, [*values], "declared are")
                raise InputError(f"{quoted(text)} names {quoted(name)}{hint}")
            return values[name]
        case ast.List(elts=parts) | ast.Tuple(elts=parts):
            return [inner(part) for part in parts]
        case ast.UnaryOp(op=op, operand=part) if type(op) in _UNARY:
            return _UNARY[type(op)](inner(part))
        case ast.BinOp(left=left, op=op, right=right) if type(op) in _BINARY:
            return _BINARY[type(op)](_number(inner(left)), _number(inner(right)))
        case ast.BoolOp(op=op, values=parts):
            joined = all if isinstance(op, ast.And) else any
            return joined(bool(inner(part)) for part in parts)
        case ast.Subscript(value=whole, slice=index):
            return _element(inner(whole), inner(index))
        case ast.Compare(left=left, ops=ops, comparators=others):
            return _compared(inner(left), ops, [inner(other) for other in others], text)
        case ast.Call(func=ast.Name(id=name), args=parts, keywords=[]) if name in _CALLS:
            return _CALLS[name](*(inner(part) for part in parts))
    written = ast.unparse(node)
    raise InputError(f"{quoted(text)}: {quoted(written)} is not allowed in an expression")


def _compared(left: object, ops: list[ast.cmpop], others: list[object], text: str) -> bool:
    for op, right in zip(ops, others, strict=True):
        if type(op) not in _COMPARE:
            raise InputError(f"{quoted(text)}: compare with ==, !=, <, <=, >, >=, in, not in")
        if not _COMPARE[type(op)](_plain(left), _plain(right)):
            return False
        left = right
    return True


def _plain(value: object) -> object:
    """Return a value with tuples as lists, so that both compare equal."""
    return [_plain(part) for part in value] if isinstance(value, list | tuple) else value


def _number(value: object) -> object:
    """Return a number; refuse texts, since a text times a number could have any length."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise TypeError(f"{quoted(value)} is no number")
    return value


def _element(whole: object, index: object) -> object:
    if isinstance(whole, list | tuple) and isinstance(index, int):
        return whole[index]
    if isinstance(whole, dict):
        return whole[index]
    raise TypeError(f"{quoted(whole)} has no element {quoted(index)}")
