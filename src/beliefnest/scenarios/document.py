"""Scenario documents: the content of a file with its line numbers.

A `YamlNode` is a value with its line, so that errors in merged content can still name the line
in the file.
"""

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import msgspec
from msgspec.structs import replace

from beliefnest.errors import BeliefNestError, ScenarioError
from beliefnest.world.texts import quoted, shortened

MAX_DEPTH = 40
"""Greatest nesting depth of lists and mappings."""

MAX_VALUES = 50_000
"""Greatest number of values and keys of a document, aliases and parameters filled in."""

MAX_CHARACTERS = 16 * 2**20
"""Greatest number of characters of all texts of a document, aliases and parameters filled in."""

LABELLED = ("script", "probes", "expectations")
"""Lists whose entries a condition may change one by one, by label."""

KeyPath = tuple[str | int, ...]
"""Keys and list indices from the top of a document to a value."""


class YamlNode(msgspec.Struct, frozen=True):
    """Value of a document with its line.

    Attributes:
        value: A scalar, a list of nodes, or a dict from key to node.
        line: Line of the value or of its key; 0: the value is not from a file.
        origin: Place of the value for messages, if it is written at another place than its keys
            say; empty: the keys say it.
    """

    value: Any
    line: int = 0
    origin: str = ""


class Document(msgspec.Struct, frozen=True):
    """Scenario as written.

    Attributes:
        source: File name, or another name for messages.
        root: Content of the document.
        folder: Folder of files that the document names.
        text: Text of the file; empty if there is none.
        templates: Texts of templates that are kept with the document, by name; others are in
            files.
        notes: Lines that warn of what it says, such as facts in an older spelling.
    """

    source: str
    root: YamlNode
    folder: Path
    text: str = ""
    templates: Mapping[str, str] = msgspec.field(default_factory=dict)
    notes: tuple[str, ...] = ()

    def fault(self, path: KeyPath, message: str) -> ScenarioError:
        """Return an error that names file, line and key."""
        return ScenarioError(f"{self.key_at(path)}{message}")

    def key_at(self, path: KeyPath) -> str:
        """Return the start of a message about a key: file, line and key."""
        node: YamlNode | None = self.root
        origin, rest = "", path
        for number, key in enumerate(path):
            node = None if node is None else _child(node, key)
            if node is not None and node.origin:
                origin, rest = node.origin, path[number + 1 :]
        return f"{self.where(path)}: {key_words(rest, origin)}"

    def where(self, path: KeyPath) -> str:
        """Return file and line of a value, or of its innermost written parent."""
        node, line = self.root, self.root.line
        for key in path:
            child = _child(node, key)
            if child is None:
                break
            node, line = child, child.line or line
        return f"{self.source}:{line}" if line else self.source

    @contextmanager
    def naming(self, path: KeyPath) -> Iterator[None]:
        """Name file, line and key in every error of the package raised inside."""
        try:
            yield
        except ScenarioError:
            raise
        except BeliefNestError as error:
            raise self.fault(path, str(error)) from error


def key_words(path: KeyPath, origin: str = "") -> str:
    """Return the start of a message about a value: its keys, such as `agents.eve: `."""
    text = origin
    for key in path:
        text += f"[{quoted(key)}]" if isinstance(key, int) else f".{shortened(str(key))}"
    return f"{text.removeprefix('.')}: " if text else ""


def _child(node: YamlNode, key: str | int) -> YamlNode | None:
    if isinstance(node.value, dict):
        # A list of one entry may be written as the entry alone.
        child = node.value.get(key, node if key == 0 else None)
        return child if isinstance(child, YamlNode) else None
    if isinstance(node.value, list) and isinstance(key, int) and key < len(node.value):
        return node.value[key]  # type: ignore[no-any-return]  # lists hold nodes
    return None


def plain(node: YamlNode) -> object:
    """Return the value of a node without lines."""
    if isinstance(node.value, dict):
        return {key: plain(child) for key, child in node.value.items()}
    if isinstance(node.value, list):
        return [plain(child) for child in node.value]
    return node.value


def wrapped(value: object, depth: int = 0) -> YamlNode:
    """Return the nodes of a value built in code, which have no lines.

    Raises:
        ScenarioError: The value is nested too deep, or contains itself.
    """
    if depth > MAX_DEPTH:
        raise ScenarioError(f"the scenario is nested more than {MAX_DEPTH} deep")
    if isinstance(value, Mapping):
        return YamlNode({key: wrapped(child, depth + 1) for key, child in value.items()})
    if isinstance(value, list | tuple):
        return YamlNode([wrapped(child, depth + 1) for child in value])
    return YamlNode(value)


def merged(document: Document, condition: int) -> Document:
    """Return the document with the overrides of a condition merged in.

    Mappings are merged key by key, anything else and `{}` replaces. Where the base has a list of
    labelled entries and the override a mapping, the entries with these labels are merged.

    Raises:
        ScenarioError: The condition, or an entry with a label, does not exist.
    """
    base = dict(document.root.value)
    conditions = base.pop("conditions", YamlNode({})).value
    if condition not in conditions:
        numbers = ", ".join(str(number) for number in conditions)
        raise ScenarioError(
            f"{document.source}: there is no condition {condition}; "
            + (f"conditions are {numbers}" if numbers else "it has no conditions")
        )
    # Keep the scenario's own description: that of a condition describes only the condition.
    written = conditions[condition]
    kept = {key: node for key, node in written.value.items() if key != "description"}
    override = YamlNode(kept, written.line)
    for key in LABELLED:
        change = override.value.get(key)
        if change is not None and isinstance(change.value, dict) and key in base:
            _check_labels(document, ("conditions", condition, key), base[key], change)
    root = _merge(YamlNode(base, document.root.line), override)
    return replace(document, root=root)


def under(document: Document, condition: int | None, keys: Iterable[str]) -> Document:
    """Return the document with a condition's overrides of some keys merged in."""
    conditions = document.root.value.get("conditions")
    if conditions is None or not isinstance(conditions.value, dict):
        return document
    written = conditions.value.get(condition)
    if written is None or not isinstance(written.value, dict):
        return document
    root = dict(document.root.value)
    for key in written.value.keys() & set(keys):
        root[key] = _merge(root[key], written.value[key]) if key in root else written.value[key]
    return replace(document, root=YamlNode(root, document.root.line))


def _check_labels(document: Document, path: KeyPath, entries: YamlNode, change: YamlNode) -> None:
    labels = [_label(entry) for entry in entries.value]
    for label in change.value:
        if labels.count(label) != 1:
            how_many = "several entries are" if label in labels else "no entry is"
            written = ", ".join(quoted(written_label) for written_label in labels if written_label)
            raise document.fault(
                (*path, label), f"{how_many} labelled so; labels are {written or 'not given'}"
            )


def _label(entry: YamlNode) -> object:
    label = entry.value.get("label") if isinstance(entry.value, dict) else None
    return label.value if isinstance(label, YamlNode) else None


def _merge(base: YamlNode, over: YamlNode) -> YamlNode:
    if isinstance(base.value, dict) and isinstance(over.value, dict):
        value = base.value | over.value
        for key in base.value.keys() & over.value.keys():
            if over.value[key].value != {} or isinstance(base.value[key].value, list):
                value[key] = _merge(base.value[key], over.value[key])
        return YamlNode(value, over.line)
    if isinstance(base.value, list) and isinstance(over.value, dict):
        changes = over.value
        return YamlNode(
            [
                _merge(entry, changes[_label(entry)]) if _label(entry) in changes else entry
                for entry in base.value
            ],
            over.line,
        )
    return over
