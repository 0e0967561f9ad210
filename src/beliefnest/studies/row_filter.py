"""Conditions on rows, such as `order == 2 and condition != "3"`."""

import ast
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import msgspec

from beliefnest.errors import InputError
from beliefnest.world.words import nearest_or_all

_Test = Callable[[Mapping[str, Any]], bool]

_ORDERED: dict[type[ast.cmpop], Callable[[Any, Any], bool]] = {
    ast.Lt: lambda one, other: one < other,
    ast.LtE: lambda one, other: one <= other,
    ast.Gt: lambda one, other: one > other,
    ast.GtE: lambda one, other: one >= other,
}
_LONGEST = 10_000
_HOW = (
    "give comparisons of columns with values, such as order == 2 and condition in (1, 3), joined "
    "by and, or, not"
)


class RowFilter(msgspec.Struct, frozen=True):
    """Condition that a row holds or does not.

    The grammar is a part of Python's: `==`, `!=`, `<`, `<=`, `>`, `>=`, `in`, `not in` between
    columns and values or lists of values, joined by `and`, `or`, `not` and parentheses. A column
    of truth values may stand alone. A value in quotation marks is compared with the text of the
    column's value, so that `"3"` equals 3. A missing value equals `None` only, and is neither
    less nor greater than anything.

    Attributes:
        text: The condition.
        columns: Columns that it names.
        holds: Function that returns True if a row holds it.
    """

    text: str
    columns: tuple[str, ...]
    holds: _Test

    @classmethod
    def parse(cls, text: str, columns: Sequence[str]) -> "RowFilter":
        """Return the condition that a text describes.

        Args:
            text: The condition.
            columns: Names of all columns.

        Raises:
            InputError: The text is no condition, or names an unknown column.
        """
        try:
            if len(text) > _LONGEST:
                raise _fault(text, "it is too long")
            tree = ast.parse(text.strip(), mode="eval")
            # Names in the order of the text.
            names = [each for each in ast.walk(tree) if isinstance(each, ast.Name)]
            names.sort(key=lambda each: (each.lineno, each.col_offset))
            return cls(text, tuple(each.id for each in names), _test(text, tree.body, columns))
        except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
            reason = error.msg if isinstance(error, SyntaxError) else str(error)
            raise _fault(text, reason) from None

    def kept(self, rows: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
        """Return the rows that hold the condition.

        Raises:
            InputError: A value cannot be compared, or no row holds the condition.
        """
        kept_rows = [row for row in rows if self.holds(row)]
        if rows and not kept_rows:
            name = self.columns[0] if self.columns else ""
            values = dict.fromkeys(str(row.get(name)) for row in rows)
            raise InputError(
                f"no row holds {self.text!r}; values of {name} are {', '.join(list(values)[:20])}"
                if name
                else f"no row holds {self.text!r}; {_HOW}"
            )
        return kept_rows


def _fault(text: str, why: str) -> InputError:
    return InputError(f"{text!r} is no condition on rows: {why}; {_HOW}")


def _test(text: str, node: ast.expr, columns: Sequence[str]) -> _Test:
    """Return the test of a part of a condition."""
    match node:
        case ast.BoolOp(op=op, values=values):
            parts = [_test(text, each, columns) for each in values]
            every = isinstance(op, ast.And)
            return lambda row: (all if every else any)(part(row) for part in parts)
        case ast.UnaryOp(op=ast.Not(), operand=operand):
            part = _test(text, operand, columns)
            return lambda row: not part(row)
        case ast.Compare(left=left, ops=ops, comparators=others):
            sides = [_side(text, each, columns) for each in (left, *others)]
            steps = list(zip(ops, sides, sides[1:], strict=False))
            return lambda row: all(_compared(text, op, a(row), b(row)) for op, a, b in steps)
        case ast.Name():
            value = _side(text, node, columns)
            return lambda row: _truth(text, node.id, value(row))
    raise _fault(text, f"{ast.unparse(node)!r} is not understood")


def _truth(text: str, name: str, value: object) -> bool:
    if value is not None and not isinstance(value, bool):
        raise _fault(text, f"{name} is {value!r} in some row; compare it with a value")
    return bool(value)


def _side(text: str, node: ast.expr, columns: Sequence[str]) -> Callable[[Mapping[str, Any]], Any]:
    """Return the function that reads one side of a comparison from a row."""
    if isinstance(node, ast.Name):
        name = node.id
        if name not in columns:
            hint = nearest_or_all(name, columns)
            raise InputError(f"there is no column {name!r}{hint}; a text stands in quotation marks")
        return lambda row: row.get(name)
    # A literal: a text, a number, True, False, None, or a tuple or list of these.
    try:
        value = ast.literal_eval(node)
    except (ValueError, TypeError):
        raise _fault(text, f"{ast.unparse(node)!r} is neither a column nor a value") from None
    parts = value if isinstance(value, tuple | list | set) else (value,)
    if not all(each is None or isinstance(each, str | int | float) for each in parts):
        raise _fault(text, f"{ast.unparse(node)!r} is no text, number or list of them")
    return lambda row: value


def _compared(text: str, op: ast.cmpop, one: Any, other: Any) -> bool:
    match op:
        case ast.Eq():
            return _equal(one, other)
        case ast.NotEq():
            return not _equal(one, other)
        case ast.In() | ast.NotIn():
            if not isinstance(other, tuple | list | set):
                raise _fault(text, f"{other!r} after in is no list; write it in parentheses")
            return any(_equal(one, each) for each in other) is isinstance(op, ast.In)
    if type(op) not in _ORDERED:
        raise _fault(text, "is compares objects; use == or !=")
    if one is None or other is None:
        return False
    if isinstance(one, str) != isinstance(other, str):
        raise _fault(text, f"{one!r} is neither less nor greater than {other!r}")
    try:
        return _ORDERED[type(op)](one, other)
    except TypeError:
        raise _fault(text, f"{one!r} is neither less nor greater than {other!r}") from None


def _equal(one: object, other: object) -> bool:
    """Return True if two values are equal; a text equals what is written so."""
    if one is None or other is None:
        return one is other
    if isinstance(one, str) or isinstance(other, str):
        return str(one) == str(other)
    return one == other
