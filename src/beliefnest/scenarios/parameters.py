"""Parameters of a scenario: declarations, and replacement of `${name}` by values.

`${name}`, or `${expression of names}`, may be in any value or key of a scenario file. If it is the
complete value, the parameter's value of any type replaces it. Inside a text, the value is written
out, lists with commas, so that `new Vec3(${spot})` is a position. The value of a parameter may name
other parameters in the same way.
"""

import json
import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from typing import Any

from msgspec.structs import replace

from beliefnest.errors import InputError
from beliefnest.scenarios.document import (
    MAX_CHARACTERS,
    MAX_VALUES,
    Document,
    KeyPath,
    YamlNode,
    plain,
    under,
    wrapped,
)
from beliefnest.scenarios.document_form import converted_at
from beliefnest.scenarios.expressions import evaluate, names_in
from beliefnest.scenarios.format import ParameterEntry
from beliefnest.world.texts import quoted
from beliefnest.world.words import nearest_or_all

_HOLE = re.compile(r"\$\{([^{}]*)\}")
_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]{0,63}", re.ASCII)
_PROGRAMS = ("program", "programs")
"""Keys of programs, in which a `${...}` between backticks may belong to JavaScript."""
_MOST_VALUES = 1_000_000
_KEYS = ("parameters", "constraints")
"""Keys of the declarations, which a condition may override."""
_DECLARING = (*_KEYS, "instances")
"""Keys that are gone when parameters are filled in."""


def choices(declared: ParameterEntry) -> Sequence[Any] | None:
    """Return all values of a parameter, in order; None: any number in its range."""
    if declared.values:
        return list(declared.values)
    if declared.range is None:
        return [declared.default]
    low, high = declared.range
    whole = isinstance(low, int) and isinstance(high, int)
    step = declared.step if declared.step is not None else int(whole)
    if not step:
        return None
    if isinstance(low, int) and isinstance(high, int) and isinstance(step, int):
        return range(low, high + 1, step)
    return [low + number * step for number in range(int((high - low) / step + 1e-9) + 1)]


def declared_in(document: Document, condition: int | None = None) -> dict[str, ParameterEntry]:
    """Return the declared parameters of a document, with the overrides of a condition.

    Raises:
        ScenarioError: A declaration has a wrong form, or a condition declares a new parameter.
    """
    written = document.root.value.get("parameters")
    document = under(document, condition, _KEYS)
    node = document.root.value.get("parameters")
    if node is None:
        return {}
    if not isinstance(node.value, dict):
        raise document.fault(("parameters",), "must be a mapping from name to declaration")
    for name in node.value:
        if condition is not None and (written is None or name not in written.value):
            path = ("conditions", condition, "parameters", str(name))
            raise document.fault(path, "is not declared; declare it under the file's parameters")
    return {name: _declared(document, name, entry) for name, entry in node.value.items()}


def _declared(document: Document, name: object, entry: YamlNode) -> ParameterEntry:
    path = ("parameters", str(name))
    if not isinstance(name, str) or not _NAME.fullmatch(name):
        raise document.fault(path, "is no name; use letters, digits and _")
    declaration = converted_at(document, path, plain(entry), ParameterEntry)
    if declaration.values and declaration.range is not None:
        raise document.fault(path, "give 'values' or 'range', not both")
    if declaration.range is not None and declaration.range[0] > declaration.range[1]:
        raise document.fault((*path, "range"), "ends below its beginning")
    if declaration.step is not None and (declaration.range is None or declaration.step < 0):
        raise document.fault((*path, "step"), "needs a range, and must not be below 0")
    if declaration.range is not None and not all(map(math.isfinite, declaration.range)):
        raise document.fault((*path, "range"), "has an end that is no finite number")
    if declaration.range is not None and _count_of(declaration) > _MOST_VALUES:
        raise document.fault(path, f"has more than {_MOST_VALUES:,} values; give a greater step")
    return declaration


def _count_of(declared: ParameterEntry) -> float:
    """Return the number of values of a range with steps."""
    if declared.range is None or not declared.step or isinstance(declared.step, int):
        return 0
    return (declared.range[1] - declared.range[0]) / declared.step


def broken_constraint(
    document: Document, values: Mapping[str, object], condition: int | None = None
) -> str | None:
    """Return the first constraint of a document that values break; None: they break none.

    The constraints of a condition replace those of the document.

    Raises:
        ScenarioError: A constraint is no expression, or cannot be computed.
    """
    document = under(document, condition, _KEYS)
    node = document.root.value.get("constraints")
    for number, entry in enumerate(node.value if node is not None else ()):
        if not isinstance(entry.value, str):
            raise document.fault(("constraints", number), "is no text; write an expression")
        with document.naming(("constraints", number)):
            if not evaluate(entry.value, values):
                return str(entry.value)
    return None


def check_declared(
    document: Document, declared: Mapping[str, ParameterEntry], values: Mapping[str, object]
) -> None:
    """Check that all given parameters are declared, and have values.

    Raises:
        ScenarioError: One does not.
    """
    if not isinstance(values, Mapping):
        raise document.fault((), f"parameters is {quoted(values)}; give values by name")
    for name, value in values.items():
        if name not in declared:
            hint = nearest_or_all(str(name), [*declared], "declared are")
            raise document.fault((), f"there is no parameter {quoted(name)}{hint}")
        if value is None and None not in (declared[name].default, *(declared[name].values or ())):
            raise document.fault(("parameters", name), "is None; give a value")


def beyond(
    document: Document, declared: Mapping[str, ParameterEntry], values: Mapping[str, object]
) -> Iterator[str]:
    """Yield a line about each given value that its parameter does not list."""
    for name, each in values.items():
        value = plain(wrapped(each))
        if listed_values := _listed_instead(declared[name], value):
            place = document.key_at(("parameters", name))
            yield f"{place}is given {quoted(value)}, and lists {listed_values}; correct one of them"


def _listed_instead(declared: ParameterEntry, value: object) -> str:
    """Return what a parameter lists if a value is not among it; else an empty text."""
    if value == declared.default or (isinstance(value, str) and "${" in value):
        return ""
    if declared.values and value not in declared.values:
        return ", ".join(map(json.dumps, declared.values))
    if declared.range is not None:
        low, high = declared.range
        if not isinstance(value, int | float) or not low <= value <= high:
            return f"numbers from {low} to {high}"
    return ""


def with_parameters(
    document: Document, named: Mapping[str, object], condition: int | None = None
) -> Document:
    """Return a document with its parameters filled in, without declarations and constraints.

    Args:
        document: The document as written.
        named: Values of parameters, by name; the others have their defaults.
        condition: Number of the condition whose defaults and constraints apply; None: none.

    Raises:
        ScenarioError: A parameter is not declared, a constraint is broken, or `${...}` cannot be
            parsed.
    """
    _check_instances(document, condition)
    declared = declared_in(document, condition)
    check_declared(document, declared, named)
    if not declared:
        # A `${...}` that names nothing is refused here too; it would be shown to people.
        _Filling(document, {}).node(document.root, ())
        return document
    notes = (*document.notes, *_unused(document, declared), *beyond(document, declared, named))
    document = replace(document, notes=notes)
    values = _resolved(
        document, {name: named.get(name, entry.default) for name, entry in declared.items()}
    )
    broken = broken_constraint(document, values, condition)
    if broken is not None:
        chosen = ", ".join(f"{name} {json.dumps(value)}" for name, value in values.items())
        raise document.fault(("constraints",), f"{quoted(broken)} does not hold for {chosen}")
    root = _Filling(document, values).node(_without_declarations(document.root), ())
    return replace(document, root=root)


def _unused(document: Document, declared: Mapping[str, ParameterEntry]) -> Iterator[str]:
    """Yield a line about each parameter that no value, key or constraint names."""
    used = _names_within(document.root)
    for name in (each for each in declared if each not in used):
        yield (
            f"{document.key_at(('parameters', name))}is used nowhere, so that its value changes "
            f"nothing; write ${{{name}}} where it belongs, or remove it"
        )


def _resolved(document: Document, values: Mapping[str, object]) -> dict[str, object]:
    """Return the values of parameters after replacement of `${...}` in them.

    Raises:
        ScenarioError: A parameter's value contains itself, by way of others or not.
    """
    resolved: dict[str, object] = {}

    def resolve(name: str, within: tuple[str, ...]) -> None:
        if name in resolved:
            return
        if name in within:
            chain = " in ".join(map(quoted, (name, *reversed(within[within.index(name) :]))))
            raise document.fault(("parameters", name), f"contains itself: {chain}")
        value = wrapped(values[name])
        for inner in sorted(_names_within(value) & values.keys()):
            resolve(inner, (*within, name))
        filling = _Filling(document, resolved, in_value=True)
        resolved[name] = plain(filling.node(value, ("parameters", name)))

    for name in values:
        resolve(name, ())
    return {name: resolved[name] for name in values}


def _names_within(node: YamlNode) -> frozenset[str]:
    """Return the names in all `${...}` of a value and its keys, and in constraints."""
    names: set[str] = set()
    for part in (node, *_parts(node)):
        keys = part.value if isinstance(part.value, dict) else {}
        inner = keys.get("constraints")
        expressions = [] if inner is None else [each.value for each in _parts(inner)]
        for text in (part.value, *keys):
            expressions += _HOLE.findall(text) if isinstance(text, str) else []
        for expression in expressions:
            with suppress(InputError):
                names |= names_in(expression)
    return frozenset(names)


def _check_instances(document: Document, condition: int | None) -> None:
    """Refuse rules of instances under a condition."""
    conditions = document.root.value.get("conditions")
    if conditions is None or not isinstance(conditions.value, dict):
        return
    written = conditions.value.get(condition)
    if written is not None and isinstance(written.value, dict) and "instances" in written.value:
        raise document.fault(
            ("conditions", str(condition), "instances"),
            "stands under a condition; put it at the top of the file: an instance is the same "
            "under all conditions",
        )


def _without_declarations(root: YamlNode) -> YamlNode:
    kept = {key: node for key, node in root.value.items() if key not in _DECLARING}
    conditions = kept.get("conditions")
    if conditions is not None and isinstance(conditions.value, dict):
        others = {
            number: _without_declarations(each) if isinstance(each.value, dict) else each
            for number, each in conditions.value.items()
        }
        kept["conditions"] = YamlNode(others, conditions.line)
    return YamlNode(kept, root.line)


class _Filling:
    """Filler that replaces `${...}` by values.

    Args:
        document: The document, for messages.
        values: Values by name.
        in_value: True: a `${...}` that names no parameter stays, as in a program.
    """

    def __init__(
        self, document: Document, values: Mapping[str, object], *, in_value: bool = False
    ) -> None:
        self._document = document
        self._values = values
        self._in_value = in_value
        self._count = self._characters = 0

    def node(self, node: YamlNode, path: KeyPath) -> YamlNode:
        filled = self._filled(node, path)
        self._check_size(filled, path)
        return filled

    def _check_size(self, node: YamlNode, path: KeyPath) -> None:
        """Refuse a value that makes the document larger than a file may be."""
        self._count += 1
        if isinstance(node.value, str):
            self._characters += len(node.value)
        if self._count > MAX_VALUES or self._characters > MAX_CHARACTERS:
            raise self._document.fault(
                path,
                f"makes more than {MAX_VALUES:,} values or {MAX_CHARACTERS:,} characters of the "
                "file; insert less",
            )

    def _filled(self, node: YamlNode, path: KeyPath) -> YamlNode:
        if isinstance(node.value, dict):
            filled = {}
            for key, child in node.value.items():
                name = self._text(key, path) if isinstance(key, str) else key
                filled[name] = self.node(child, (*path, key))
            return YamlNode(filled, node.line)
        if isinstance(node.value, list):
            parts = [self.node(child, (*path, n)) for n, child in enumerate(node.value)]
            return YamlNode(parts, node.line)
        if not isinstance(node.value, str) or "${" not in node.value:
            return node
        whole = _HOLE.fullmatch(node.value)
        if whole is None:
            return YamlNode(self._text(node.value, path), node.line)
        value_of_hole = self._found(whole, path)
        if value_of_hole is None:
            return node
        value = _on_line(wrapped(value_of_hole[0]), node.line)
        for part in (value, *_parts(value)):
            if isinstance(part.value, str):
                self._check_whole(part.value, path)
        for part in _parts(value):
            self._check_size(part, path)
        return value

    def _text(self, text: str, path: KeyPath) -> str:
        if "${" not in text:
            return text

        def written(hole: re.Match[str]) -> str:
            value_of_hole = self._found(hole, path)
            return hole[0] if value_of_hole is None else _written(value_of_hole[0])

        filled = _HOLE.sub(written, text)
        self._check_whole(filled, path)
        return filled

    def _check_whole(self, text: str, path: KeyPath) -> None:
        """Refuse a text that would be shown, or spoken, with a `${` in it."""
        if "${" not in text:
            return
        for left in _HOLE.finditer(text):
            if not self._is_javascript(left, path):
                message = "would hold {} from a parameter's value; name a declared parameter"
                raise self._document.fault(path, message.format(quoted(left[0])))
        if _HOLE.search(text) is None and not self._in_value and not _is_program(path):
            message = "has a '${' without an expression; write ${NAME}, with no braces inside"
            raise self._document.fault(path, message)

    def _is_javascript(self, hole: re.Match[str], path: KeyPath) -> bool:
        """Return True if a `${...}` may belong to a template literal of JavaScript."""
        before, after = hole.string[: hole.start()], hole.string[hole.end() :]
        return self._in_value or (_is_program(path) and "`" in before and "`" in after)

    def _found(self, hole: re.Match[str], path: KeyPath) -> tuple[object] | None:
        """Return the value of a hole in a tuple; None: it belongs to JavaScript."""
        try:
            names = names_in(hole[1])
        except InputError:
            names = frozenset()
        if self._is_javascript(hole, path) and not names & self._values.keys():
            return None
        with self._document.naming(path):
            return (evaluate(hole[1], self._values),)
        raise AssertionError("unreachable")


def _is_program(path: KeyPath) -> bool:
    return any(key in _PROGRAMS for key in path)


def _parts(node: YamlNode) -> Iterator[YamlNode]:
    """Yield all values inside a value."""
    inner = node.value.values() if isinstance(node.value, dict) else node.value
    for part in inner if isinstance(inner, list) or isinstance(node.value, dict) else ():
        yield part
        yield from _parts(part)


def _on_line(node: YamlNode, line: int) -> YamlNode:
    if isinstance(node.value, dict):
        return YamlNode({key: _on_line(child, line) for key, child in node.value.items()}, line)
    if isinstance(node.value, list):
        return YamlNode([_on_line(child, line) for child in node.value], line)
    return YamlNode(node.value, line)


def _written(value: object) -> str:
    """Return a value as written inside a text."""
    if isinstance(value, list | tuple):
        return ", ".join(_written(part) for part in value)
    return value if isinstance(value, str) else json.dumps(value)


def text_of(root: YamlNode) -> str:
    """Return a document's content as YAML, with one line for each top-level key."""
    value = plain(root)
    assert isinstance(value, Mapping)  # the root of a document is one
    return "".join(f"{_flow(key)}: {_flow(inner)}\n" for key, inner in value.items())


def _flow(value: object) -> str:
    scalar: Callable[[object], str] = json.dumps
    if isinstance(value, Mapping):
        inner = ", ".join(f"{_flow(key)}: {_flow(part)}" for key, part in value.items())
        return f"{{{inner}}}"
    if isinstance(value, list | tuple):
        return f"[{', '.join(_flow(part) for part in value)}]"
    return scalar(value)
