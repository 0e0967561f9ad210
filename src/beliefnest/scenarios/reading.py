"""Reading scenario files: YAML, with the line of every key kept."""

from collections.abc import Mapping
from pathlib import Path

from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedMap, CommentedSeq
from ruamel.yaml.error import MarkedYAMLError, YAMLError

from beliefnest.errors import ScenarioError
from beliefnest.scenarios.document import Document, Node

__all__ = ["read_yaml"]

_MAX_VALUES = 200_000
_MAX_DEPTH = 40


def read_yaml(path: Path) -> Document:
    """The document in a YAML file.

    Raises:
        ScenarioError: The file cannot be read, or is not one YAML mapping.
    """
    try:
        text = path.read_text(encoding="utf-8")
    except OSError as error:
        raise ScenarioError(f"{path}: cannot be read: {error.strerror}") from None
    except UnicodeDecodeError as error:
        raise ScenarioError(f"{path}: is not UTF-8 text (byte {error.start})") from None
    try:
        content = YAML(typ="rt", pure=True).load(text)
    except MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line = f":{mark.line + 1}" if mark is not None else ""
        problem = " ".join((error.problem or "it cannot be parsed").split())
        raise ScenarioError(f"{path}{line}: broken YAML: {problem}") from None
    except YAMLError as error:
        raise ScenarioError(f"{path}: broken YAML: {' '.join(str(error).split())}") from None
    if not isinstance(content, CommentedMap):
        raise ScenarioError(f"{path}: is not a mapping of keys to values; see docs/scenarios.md")
    root = _Conversion(str(path)).node(content, 1, 0)
    return Document(source=str(path), root=root, folder=path.parent, text=text)


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
