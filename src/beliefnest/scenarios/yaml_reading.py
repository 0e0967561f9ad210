"""Reading of scenario files: YAML with the line number of every key."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import msgspec
from msgspec.structs import replace
from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedMap, CommentedSeq
from ruamel.yaml.composer import Composer, ComposerError
from ruamel.yaml.constructor import ConstructorError, RoundTripConstructor
from ruamel.yaml.error import MarkedYAMLError, YAMLError
from ruamel.yaml.nodes import MappingNode, ScalarNode

from beliefnest.errors import ScenarioError
from beliefnest.files import decode_json, read_regular_text
from beliefnest.prompts.templates import BUILT_IN_TEMPLATES
from beliefnest.scenarios.document import (
    MAX_CHARACTERS,
    MAX_DEPTH,
    MAX_VALUES,
    Document,
    KeyPath,
    YamlNode,
)
from beliefnest.world.texts import quoted, shortened

LONGEST = 16 * 2**20
"""Greatest size of a scenario file in bytes."""
_LONGEST_PROBLEM = 200
_NO_KEY = "a key is no text; put it into quotes"
_FLOW = ("while parsing a flow mapping", "while parsing a flow sequence")
_IN_BRACES = (
    "; inside {...} and [...] a text with commas, colons or quotes breaks it: "
    "write a program as 'program: |' with its lines below, each key on a line of its own"
)
_TOO_MUCH = (
    f"holds more than {MAX_VALUES} values or is nested more than {MAX_DEPTH} deep, "
    "aliases counted in"
)
_TOO_LONG = f"has texts of more than {MAX_CHARACTERS:,} characters, aliases counted in"
_REFUSALS = (
    *(ArithmeticError, AssertionError, AttributeError, LookupError, NotImplementedError),
    *(RecursionError, TypeError, ValueError),
)
"""Exceptions that the parser raises instead of its own for content that it did not foresee, such as
a merge key that is an alias of itself, or an escape of no character."""


def read_yaml(path: Path) -> Document:
    """Return the document in a YAML file, with the templates that a run kept beside it, if any.

    Raises:
        ScenarioError: The file cannot be read, or is not a single YAML mapping.
    """
    document = parse_yaml(_text(path), str(path))
    kept = templates_file(path)
    templates = _templates(kept) if kept.is_file() else {}
    return replace(document, folder=path.parent, templates=templates)


def templates_file(path: Path) -> Path:
    """Return the JSON file beside a kept scenario file that has its templates by name."""
    return path.with_suffix(".templates.json")


def template_text(document: Document, path: KeyPath, name: str) -> str:
    """Return the text of a template, not a built-in one, that a document names.

    Args:
        document: Document that keeps the template, or whose folder has it.
        path: Place of the name in the document.
        name: Name of the template.

    Raises:
        ScenarioError: The template cannot be read.
    """
    if name in document.templates:
        return document.templates[name]
    file = document.folder / name
    try:
        return read_regular_text(file)
    except FileNotFoundError:
        message = (
            f"there is no template {quoted(name)}; give a file beside the scenario, or the name of "
            f"a built-in template: {', '.join(BUILT_IN_TEMPLATES)}"
        )
        raise document.fault(path, message) from None
    except (OSError, ValueError) as error:
        raise document.fault(path, f"{file} cannot be read: {error}") from None


def parse_yaml(text: str, source: str) -> Document:
    """Parse a document from a YAML text.

    Args:
        text: The text.
        source: Name of the source for messages.

    Raises:
        ScenarioError: The text is not a single YAML mapping.
    """
    try:
        content = _parser().load(text)
    except MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line = f":{mark.line + 1}" if mark is not None else ""
        problem = shortened(error.problem or "it cannot be parsed", _LONGEST_PROBLEM)
        hint = _IN_BRACES if error.context in _FLOW else ""
        raise ScenarioError(f"{source}{line}: broken YAML: {problem}{hint}") from None
    except _REFUSALS as error:
        # The parser builds collections late, when it no longer knows their lines.
        raise ScenarioError(
            f"{source}: broken YAML: a key or value cannot be: {_said(error)}"
        ) from None
    except YAMLError as error:
        said = shortened(str(error), _LONGEST_PROBLEM)
        raise ScenarioError(f"{source}: broken YAML: {said}") from None
    if not isinstance(content, CommentedMap):
        raise ScenarioError(f"{source}: is not a mapping of keys to values")
    root = _Conversion(source).node(content, 1, 0)
    return Document(source=source, root=root, folder=Path(), text=text)


def _said(error: Exception) -> str:
    """Return what an exception of the parser says of a value."""
    if isinstance(error, TypeError | ValueError | OverflowError):
        return shortened(str(error).partition(";")[0], _LONGEST_PROBLEM)
    return "it contains itself, or is no value of the type that its tag names"


def _text(path: Path) -> str:
    if path.is_dir():
        raise ScenarioError(f"{path} is a folder; give a .yaml file")
    try:
        return read_regular_text(path, LONGEST)
    except OSError as error:
        raise ScenarioError(f"{path}: cannot be read: {error.strerror}") from None
    except UnicodeDecodeError as error:
        raise ScenarioError(f"{path}: is not UTF-8 text (byte {error.start})") from None


def _templates(path: Path) -> dict[str, str]:
    try:
        return decode_json(_text(path), dict[str, str])
    except msgspec.MsgspecError as error:
        raise ScenarioError(f"{path}: is no mapping from names to texts: {error}") from None


def _parser() -> YAML:
    """Return a parser that refuses too deep or too large content before it builds it."""
    parser = YAML(typ="rt", pure=True)
    parser.Composer = _Composer
    parser.Constructor = _Constructor
    return parser


class _Composer(Composer):
    """Composer that counts nodes and their depth."""

    _depth = 0
    _values = 0

    def compose_node(self, parent: Any, index: Any) -> Any:
        self._values += 1
        self._depth += 1
        if self._values > MAX_VALUES or self._depth > MAX_DEPTH:
            mark = self.parser.peek_event().start_mark
            raise ComposerError(None, None, f"it {_TOO_MUCH}", mark)
        node = super().compose_node(parent, index)
        if isinstance(parent, MappingNode) and index is None and not isinstance(node, ScalarNode):
            context = _FLOW[0] if parent.flow_style else None
            raise ComposerError(context, None, _NO_KEY, node.start_mark)
        self._depth -= 1
        return node


class _Constructor(RoundTripConstructor):
    """Constructor that names the line of an invalid scalar, such as a number of 5,000 digits."""

    def construct_object(self, node: Any, deep: bool = False) -> Any:
        try:
            return super().construct_object(node, deep)
        except _REFUSALS as error:
            problem = f"a value cannot be read: {_said(error)}"
            raise ConstructorError(None, None, problem, node.start_mark) from None


class _Conversion:
    """Converter from the parser's values to nodes.

    Aliases can expand a small file to endless or enormous content; the converter refuses both.
    """

    def __init__(self, source: str) -> None:
        self._source = source
        self._values = 0
        self._characters = 0

    def _count(self, text: object, line: int) -> None:
        if isinstance(text, str):
            self._characters += len(text)
            if self._characters > MAX_CHARACTERS:
                raise ScenarioError(f"{self._source}:{line}: {_TOO_LONG}")

    def node(self, value: object, line: int, depth: int) -> YamlNode:
        self._values += 1
        if self._values > MAX_VALUES or depth > MAX_DEPTH:
            raise ScenarioError(f"{self._source}:{line}: {_TOO_MUCH}")
        if isinstance(value, CommentedMap):
            lines = value.lc.data or {}
            for key in value:
                if not isinstance(_scalar(key), str | int | float | None):
                    place = f"{self._source}:{_line(lines, key, line)}"
                    raise ScenarioError(f"{place}: {_NO_KEY}")
                self._count(key, line)
            return YamlNode(
                {
                    _scalar(key): self.node(child, _line(lines, key, line), depth + 1)
                    for key, child in value.items()
                },
                line,
            )
        if isinstance(value, CommentedSeq):
            lines = value.lc.data or {}
            return YamlNode(
                [
                    self.node(child, _line(lines, index, line), depth + 1)
                    for index, child in enumerate(value)
                ],
                line,
            )
        self._count(value, line)
        return YamlNode(_scalar(value), line)


def _line(lines: Mapping[object, list[int]], key: object, default: int) -> int:
    return lines[key][0] + 1 if key in lines else default


def _scalar(value: object) -> object:
    """Return the plain value of a scalar of the parser, without its notation."""
    for kind in (bool, int, float, str):
        if isinstance(value, kind):
            return kind(value)
    return value
