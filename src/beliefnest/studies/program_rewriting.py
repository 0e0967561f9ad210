"""Rewriting of positions and texts in agent programs, for another scene.

A JavaScript parser finds `new Vec3(...)` with plain numbers, and texts. Programs that compute with
directions, or that hold positions in another form, are refused.
"""

import re
from collections.abc import Callable
from typing import Any

import msgspec

from beliefnest.errors import InputError
from beliefnest.llm.offline.program_texts import vector
from beliefnest.skills.javascript import nodes_below, parsed
from beliefnest.world.texts import quoted

_COMPUTED = frozenset(
    ("x", "z", "yaw", "offset", "plus", "minus", "translate", "setControlState", "look", "face")
)
"""Properties that are a direction or a part of a position."""
_HELPERS = frozenset(("Move", "goals"))
_DIRECTIONAL = re.compile(r"\b(north|south|east|west)\b|facing=", re.IGNORECASE)
_Node = Any
"""Node of a tree-sitter tree; tree-sitter is imported only when it is needed."""
_DIRECTED = frozenset(("exploreUntil",))
"""Skills whose vector argument is a direction."""


class Rewriting(msgspec.Struct, frozen=True):
    """Functions that rewrite the parts of a program.

    Attributes:
        vector: Function that takes the coordinates of `new Vec3(x, y, z)`, and True if this is a
            direction, and returns new coordinates. None: leave positions as they are, unchecked.
        text: Function from the content of a text to new content.
        key: Function from a key or property, such as `diamond` in `{diamond: 1}`, to a new one.
    """

    vector: Callable[[tuple[float, float, float], bool], tuple[float, float, float]] | None
    text: Callable[[str], str]
    key: Callable[[str], str]


def rewritten(program: str, by: Rewriting) -> str:
    """Return a program with its positions and texts replaced.

    Args:
        program: JavaScript, the body of an async function or a whole one.
        by: Functions that rewrite its parts.

    Raises:
        InputError: A part cannot be rewritten with certainty; the message names the line.
    """
    source = program.encode()
    edits: list[tuple[int, int, str]] = []
    for node in nodes_below(_tree(source)):
        edits += _edits(node, by)
    for start, end, text in sorted(edits, reverse=True):
        source = source[:start] + text.encode() + source[end:]
    return source.decode()


def _tree(source: bytes) -> _Node:
    root = parsed(source)
    for node in nodes_below(root):
        if node.is_missing or node.type == "ERROR":
            raise _refused(node, "is not valid JavaScript")
    return root


def _edits(node: _Node, by: Rewriting) -> list[tuple[int, int, str]]:
    """Return the edits at a node itself: first byte, end byte (exclusive), new text."""
    kind, text = node.type, node.text.decode()
    if kind == "string_fragment":
        if by.vector is not None and _DIRECTIONAL.search(text):
            raise _refused(node, f"names a direction in the text {quoted(text)}")
        new = by.text(text)
        return [(node.start_byte, node.end_byte, new)] if new != text else []
    if kind in ("property_identifier", "shorthand_property_identifier"):
        if by.vector is not None and text in _COMPUTED:
            raise _refused(node, f"computes with {quoted(text)}")
        new = by.key(text)
        if new != text and kind == "shorthand_property_identifier":
            raise _refused(node, f"has {quoted(text)} both as a name and as a key")
        return [(node.start_byte, node.end_byte, new)] if new != text else []
    if by.vector is None:
        return []
    if kind == "new_expression":
        return _vector(node, by.vector)
    if kind == "identifier" and text in _HELPERS:
        raise _refused(node, f"holds positions by {quoted(text)}")
    if kind == "array" and _is_numbers(node):
        raise _refused(node, f"holds the numbers {text}, which may be a position")
    return []


def _vector(
    node: _Node, change: Callable[[tuple[float, float, float], bool], tuple[float, float, float]]
) -> list[tuple[int, int, str]]:
    if node.child_by_field_name("constructor").text != b"Vec3":
        return []
    arguments = node.child_by_field_name("arguments")
    parts = [] if arguments is None else arguments.named_children
    numbers = [_number(part) for part in parts]
    if len(numbers) != 3 or None in numbers:
        raise _refused(
            node, f"computes a position, {node.text.decode()}; write its numbers, or a parameter"
        )
    x, y, z = (number or 0 for number in numbers)
    new = change((x, y, z), _is_direction(node))
    return [(node.start_byte, node.end_byte, vector(new))]


def _is_direction(node: _Node) -> bool:
    call = node.parent.parent if node.parent is not None else None
    if call is None or call.type != "call_expression":
        return False
    return call.child_by_field_name("function").text.decode() in _DIRECTED


def _number(node: _Node) -> float | int | None:
    text = node.text.decode().replace(" ", "")
    if not re.fullmatch(r"[+-]?\d+(\.\d*)?", text):
        return None
    return float(text) if "." in text else int(text)


def _is_numbers(node: _Node) -> bool:
    parts = node.named_children
    return len(parts) in (2, 3) and all(_number(part) is not None for part in parts)


def _refused(node: _Node, why: str) -> InputError:
    return InputError(f"line {node.start_point[0] + 1} of the program {why}")
