"""Older spellings of facts in scenario files, rewritten into today's (docs/facts.md)."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from beliefnest.scenarios.document import Document, YamlNode

__all__ = ["respelled"]

_OLD_WITHIN = 2.0
"""Distance that expectations had where none was given."""

_UNKNOWN = {"agent": ("at", "items"), "block": ("state", "like"), "sign": ("text",)}
"""Keys of a fact by its subject. Without any of them, an expectation meant something unknown."""

_Nodes = dict[Any, YamlNode]


def respelled(document: Document) -> Document:
    """Return a document with its facts as they are written today.

    If there were older spellings, `Document.older` is a line that says what to write.
    """
    if not isinstance(document.root.value, dict):
        return document
    spelling = _Spelling()
    root = spelling.scene(document.root.value)
    if not spelling.advice:
        return document
    line = min(spelling.advice.values())
    place = f"{document.source}:{line}" if line else document.source
    told = f"{place}: has facts in an older spelling; write {', '.join(spelling.advice)}"
    return replace(document, root=replace(document.root, value=root), older=told)


@dataclass(slots=True)
class _Spelling:
    """Rewriting of one document.

    Attributes:
        advice: What to write, with the first line that it is about.
    """

    advice: dict[str, int] = field(default_factory=dict)

    def scene(self, content: _Nodes, base: _Nodes | None = None) -> _Nodes:
        """Return the content of a document, or the overrides of one of its conditions."""
        found = dict(content)
        for key, entry in (("expectations", self._expectation), ("probes", self._probe)):
            if key not in content:
                continue
            value, usual = content[key].value, _labelled((base or {}).get(key))
            if isinstance(value, list):
                value = [replace(node, value=entry(node, {})) for node in value]
            elif isinstance(value, dict):
                value = {
                    label: replace(node, value=entry(node, usual.get(label, {})))
                    for label, node in value.items()
                }
            found[key] = replace(content[key], value=value)
        conditions = content.get("conditions")
        if base is None and conditions is not None and isinstance(conditions.value, dict):
            overrides = {
                number: replace(node, value=self.scene(node.value, content))
                if isinstance(node.value, dict)
                else node
                for number, node in conditions.value.items()
            }
            found["conditions"] = replace(conditions, value=overrides)
        return found

    def _expectation(self, node: YamlNode, usual: Mapping[str, Any]) -> Any:
        """Return an expectation; `usual` is the entry that it overrides, if it overrides one."""
        if not isinstance(node.value, dict):
            return node.value
        entry = {"at" if key == "position" else key: child for key, child in node.value.items()}
        if "position" in node.value:
            told = "'at' for 'position'"
            if entry["at"].value is not None and not {"within", "position"} & {*entry, *usual}:
                entry["within"] = YamlNode(_OLD_WITHIN)
                told += f", with 'within: {_OLD_WITHIN:g}'"
            self._note(told, node.value["position"])
        for subject, keys in _UNKNOWN.items():
            if subject in entry and not usual and not entry.keys() & {*keys}:
                entry[keys[0]] = YamlNode(None)
                self._note(f"'{keys[0]}: null' for what is unknown of the {subject}", node)
        return entry

    def _probe(self, node: YamlNode, usual: Mapping[str, Any]) -> Any:
        """Return a probe; `usual` is the entry that it overrides, if it overrides one."""
        expect = _inner(node, "expect")
        if expect is None:
            return node.value
        entry = dict(expect)
        before = _inner(YamlNode(usual), "expect") or {}
        for key in ("opens", "arrives", "intends"):
            if key in entry:
                entry[key] = self._asked(entry[key])
        walks = {"arrives", "intends"}
        if walks & entry.keys() and not {"within", *walks} & {*before, *(entry.keys() - walks)}:
            entry["within"] = YamlNode(_OLD_WITHIN)
            self._note(f"'within: {_OLD_WITHIN:g}' beside 'arrives' and 'intends'", node)
        for key, change in (("answers", self._question), ("believes", self._believes)):
            if key not in entry:
                continue
            value = entry[key].value
            changed = [change(each) for each in value] if isinstance(value, list) else None
            entry[key] = (
                change(entry[key]) if changed is None else replace(entry[key], value=changed)
            )
        return {**node.value, "expect": replace(node.value["expect"], value=entry)}

    def _believes(self, node: YamlNode) -> YamlNode:
        return replace(node, value=self._expectation(node, {}))

    def _question(self, node: YamlNode) -> YamlNode:
        if not isinstance(node.value, dict) or "right" not in node.value:
            return node
        return replace(node, value={**node.value, "right": self._asked(node.value["right"])})

    def _asked(self, node: YamlNode) -> YamlNode:
        """Return the fact that is asked for."""
        if not isinstance(node.value, dict) or "believed" not in node.value:
            return node
        self._note("'path' for 'believed'", node)
        return replace(
            node,
            value={"path" if key == "believed" else key: each for key, each in node.value.items()},
        )

    def _note(self, told: str, node: YamlNode) -> None:
        self.advice.setdefault(told, node.line)


def _labelled(node: YamlNode | None) -> dict[Any, _Nodes]:
    """Return the entries of a list by label."""
    entries = node.value if node is not None and isinstance(node.value, list) else []
    mappings = [entry.value for entry in entries if isinstance(entry.value, dict)]
    return {each["label"].value: each for each in mappings if _is_text(each.get("label"))}


def _is_text(node: YamlNode | None) -> bool:
    return node is not None and isinstance(node.value, str)


def _inner(node: YamlNode, key: str) -> _Nodes | None:
    """Return the mapping under a key of a mapping; None: there is none."""
    child = node.value.get(key) if isinstance(node.value, dict) else None
    return child.value if child is not None and isinstance(child.value, dict) else None
