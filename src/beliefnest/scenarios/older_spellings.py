"""Older spellings of facts in scenario files, rewritten into today's (docs/facts.md)."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, TypeVar

from msgspec.structs import replace

from beliefnest.scenarios.document import Document, YamlNode

_OLD_WITHIN = 2.0
"""Distance that expectations had where none was given."""

_UNKNOWN = {"agent": "at", "block": "state", "sign": "text"}
"""Property of a subject that was unknown if an expectation said nothing else of it."""

_ALTERED: tuple[tuple[str, dict[str, str], dict[Any, YamlNode]], ...] = (
    ("blocks", {"at": "block", "block": "state"}, {}),
    ("containers", {"at": "container"}, {"items": YamlNode({})}),
)
"""Lists in alternatives of a doubt: their keys with those of facts, and usual values."""

_EACH, _ANY = "*", "?"
"""Steps of a path to all entries of a list or mapping; and to those of a list, or a single one."""

T = TypeVar("T", list[Any], dict[Any, Any])

_Change = Callable[[YamlNode, YamlNode | None], YamlNode]
"""Function from a mapping, and the one that it overrides if it does, to the new mapping."""


def respelled(document: Document) -> Document:
    """Return a document with its facts as they are written today.

    If there were older spellings, one of `Document.notes` says what to write.
    """
    spelling = _Spelling()
    root = spelling.scene(document.root, None)
    if not spelling.advice:
        return document
    line = min(spelling.advice.values())
    place = f"{document.source}:{line}" if line else document.source
    note = f"{place}: has facts in an older spelling; write {', '.join(spelling.advice)}"
    return replace(document, root=root, notes=(*document.notes, note))


@dataclass(slots=True)
class _Spelling:
    """Rewriting of one document.

    Attributes:
        advice: What to write, with the first line that it is about.
    """

    advice: dict[str, int] = field(default_factory=dict)

    def scene(self, written: YamlNode, base: YamlNode | None) -> YamlNode:
        """Return a document, or the overrides of one of its conditions."""
        expect = ("probes", _EACH, "expect")
        root = written
        for path, change in (
            (("signs", _EACH, "claims", _EACH), self._claim),
            (("map", "legend", _EACH, "claims", _EACH), self._claim),
            (("probes", _EACH, "infer", "doubt", _EACH), self._alternative),
            (("expectations", _EACH), self._expectation),
            ((*expect, "believes", _ANY), self._expectation),
            ((*expect, "answers", _ANY, "right"), self._asked),
            *(((*expect, key), self._asked) for key in ("opens", "arrives", "intends")),
            (expect, self._walk),
        ):
            root = _changed(root, path, change, base)
        if base is None:
            change_all = ("conditions", _EACH)
            root = _changed(root, change_all, lambda node, _: self.scene(node, written), None)
        return root

    def _expectation(self, node: YamlNode, base: YamlNode | None) -> YamlNode:
        entry = {"at" if key == "position" else key: child for key, child in node.value.items()}
        if "position" in node.value:
            self._note("'at' for 'position'", node.value["position"])
            if entry["at"].value is not None and not _has(base, "within", "position"):
                entry.setdefault("within", self._old_within(node, entry))
        for subject, key in _UNKNOWN.items():
            if subject in entry and base is None and entry.keys() <= {subject, "path", "label"}:
                entry[key] = YamlNode(None)
                self._note(f"'{key}: null' for what is unknown of the {subject}", node)
        return replace(node, value=entry)

    def _walk(self, node: YamlNode, base: YamlNode | None) -> YamlNode:
        """Return what is expected of a probe, with the distance of `arrives` and `intends`."""
        if not _has(node, "arrives", "intends") or _has(base, "within", "arrives", "intends"):
            return node
        within = self._old_within(node, node.value)
        return replace(node, value={**node.value, "within": within})

    def _claim(self, node: YamlNode, base: YamlNode | None) -> YamlNode:
        entry = dict(node.value)
        kind, place, item = (entry.pop(key, YamlNode(None)) for key in ("kind", "place", "item"))
        match kind.value, item.value:
            case "located", str(name):
                entry |= {"container": place, "items": YamlNode({name: YamlNode(1)}, item.line)}
            case "absent", str():
                entry |= {"container": place, "lacks": item}
            case "position" | "block", _:
                entry["at" if kind.value == "position" else "block"] = place
            case _:
                return node
        self._note("claims as facts, such as 'container' and 'items'", node)
        return replace(node, value=entry)

    def _alternative(self, node: YamlNode, base: YamlNode | None) -> YamlNode:
        self._note("the alternatives of 'doubt' as lists of facts", node)
        facts = [
            YamlNode(
                {**usual, **{keys.get(key, key): part for key, part in each.value.items()}},
                each.line,
            )
            for kind, keys, usual in _ALTERED
            for each in _values(node, kind, list)
            if _has(each, "at")
        ]
        facts += [
            YamlNode({"agent": YamlNode(agent), "at": feet}, feet.line)
            for agent, feet in _values(node, "agents", dict).items()
        ]
        return replace(node, value=facts)

    def _asked(self, node: YamlNode, base: YamlNode | None) -> YamlNode:
        if not _has(node, "believed"):
            return node
        self._note("'path' for 'believed'", node)
        entry = {"path" if key == "believed" else key: each for key, each in node.value.items()}
        return replace(node, value=entry)

    def _old_within(self, node: YamlNode, entry: dict[Any, YamlNode]) -> YamlNode:
        """Return the distance of an entry, which is the older one if it gives none."""
        if "within" not in entry:
            self._note(f"'within: {_OLD_WITHIN:g}' where a place has none", node)
        return entry.get("within", YamlNode(_OLD_WITHIN))

    def _note(self, advice: str, node: YamlNode) -> None:
        self.advice.setdefault(advice, node.line)


def _changed(
    node: YamlNode, path: tuple[str, ...], change: _Change, base: YamlNode | None
) -> YamlNode:
    """Return a node with the mappings at a path changed; other values stay as they are.

    Args:
        node: The node.
        path: Keys and steps `_EACH` and `_ANY` from the node to the mappings.
        change: Their change.
        base: The node that it overrides; None: it overrides none.
    """
    value: Any = node.value
    if not path:
        return change(node, base) if isinstance(value, dict) else node
    key, rest = path[0], path[1:]
    if isinstance(value, list) and key in (_EACH, _ANY):
        return replace(node, value=[_changed(each, rest, change, None) for each in value])
    if key == _ANY:
        return _changed(node, rest, change, base)
    if not isinstance(value, dict):
        return node
    inner = {
        name: _changed(each, rest, change, _child(base, name)) if key in (_EACH, name) else each
        for name, each in value.items()
    }
    return replace(node, value=inner)


def _child(node: YamlNode | None, name: object) -> YamlNode | None:
    """Return the value of a key, or the entry with a label; None: there is none."""
    value: Any = None if node is None else node.value
    if isinstance(value, list):
        labelled = (each for each in value if _has(each, "label"))
        return next((each for each in labelled if each.value["label"].value == name), None)
    return value.get(name) if isinstance(value, dict) else None


def _values(node: YamlNode, key: str, kind: type[T]) -> T:
    """Return the list or mapping under a key of a mapping; an empty one if there is none."""
    child = node.value.get(key)
    return child.value if child is not None and isinstance(child.value, kind) else kind()


def _has(node: YamlNode | None, *keys: str) -> bool:
    """Return True if a node is a mapping with one of some keys."""
    return (
        node is not None and isinstance(node.value, dict) and not node.value.keys().isdisjoint(keys)
    )
