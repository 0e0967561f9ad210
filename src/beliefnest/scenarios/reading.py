"""Reading scenario files: YAML, with the line of every key kept."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import msgspec
from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedMap, CommentedSeq
from ruamel.yaml.error import MarkedYAMLError, YAMLError

from beliefnest.errors import ScenarioError
from beliefnest.files import decode_json, read_regular_text
from beliefnest.scenarios.document import Document, Node

__all__ = ["parse_yaml", "read_yaml", "templates_file"]

_LONGEST = 4 * 2**20
"""Bytes of a scenario file."""
_MAX_VALUES = 200_000
_MAX_DEPTH = 40


def read_yaml(path: Path) -> Document:
    """The document in a YAML file, with the templates that were kept beside it, if any.

    Raises:
        ScenarioError: The file cannot be read, or is not one YAML mapping.
    """
    kept = templates_file(path)
    templates = _templates(kept) if kept.is_file() else {}
    return replace(parse_yaml(_text(path), str(path)), folder=path.parent, templates=templates)


def templates_file(path: Path) -> Path:
    """Where the templates that a scenario file names are kept beside it: name to text, as JSON."""
    return path.with_suffix(".templates.json")


def parse_yaml(text: str, source: str) -> Document:
    """The document that a YAML text holds.

    Args:
        text: The text.
        source: What messages call it.

    Raises:
        ScenarioError: It is not one YAML mapping.
    """
    try:
        content = YAML(typ="rt", pure=True).load(text)
    except MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line = f":{mark.line + 1}" if mark is not None else ""
        problem = " ".join((error.problem or "it cannot be parsed").split())
        raise ScenarioError(f"{source}{line}: broken YAML: {problem}") from None
    except YAMLError as error:
        raise ScenarioError(f"{source}: broken YAML: {' '.join(str(error).split())}") from None
    if not isinstance(content, CommentedMap):
        raise ScenarioError(f"{source}: is not a mapping of keys to values; see docs/scenarios.md")
    root = _Conversion(source).node(content, 1, 0)
    return Document(source=source, root=root, folder=Path(), text=text)


def _text(path: Path) -> str:
    try:
        return read_regular_text(path, _LONGEST)
    except OSError as error:
        raise ScenarioError(f"{path}: cannot be read: {error.strerror}") from None
    except UnicodeDecodeError as error:
        raise ScenarioError(f"{path}: is not UTF-8 text (byte {error.start})") from None


def _templates(path: Path) -> dict[str, str]:
    try:
        return decode_json(_text(path), dict[str, str])
    except msgspec.MsgspecError as error:
        raise ScenarioError(f"{path}: is no mapping from names to texts: {error}") from None


class _Conversion:
    """Turns the parser's values into nodes.

    Aliases can make a small file stand for an endless or enormous content: both are refused.
    """

    def __init__(self, source: str) -> None:
        self._source = source
        self._values = 0

    def node(self, value: object, line: int, depth: int) -> Node:
        self._values += 1
        if self._values > _MAX_VALUES or depth > _MAX_DEPTH:
            raise ScenarioError(
                f"{self._source}:{line}: holds more than {_MAX_VALUES} values or is nested more "
                f"than {_MAX_DEPTH} deep, aliases counted in"
            )
        if isinstance(value, CommentedMap):
            lines = value.lc.data or {}
            return Node(
                {
                    _scalar(key): self.node(child, _line(lines, key, line), depth + 1)
                    for key, child in value.items()
                },
                line,
            )
        if isinstance(value, CommentedSeq):
            lines = value.lc.data or {}
            return Node(
                [
                    self.node(child, _line(lines, index, line), depth + 1)
                    for index, child in enumerate(value)
                ],
                line,
            )
        return Node(_scalar(value), line)


def _line(lines: Mapping[object, list[int]], key: object, default: int) -> int:
    return lines[key][0] + 1 if key in lines else default


def _scalar(value: object) -> object:
    """The plain value of a scalar that remembers how it was written."""
    for kind in (bool, int, float, str):
        if isinstance(value, kind):
            return kind(value)
    return value
